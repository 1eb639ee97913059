"""Files dropped onto the window: a script, pose or recording, a sound, a head."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path

from risorius import assets
from risorius.assets.fitting.landmark_file import MisfitError, UnfinishedError
from risorius.assets.meshes import FORMATS

from ...errors import UserError
from ...light_maps import LIGHT_SUFFIXES
from ...recordings.reading import is_recording
from ...scenes import Scene, build_scene, called_head, head_in_words, own_head
from ..interface.gui import wake_up
from ..messages import Message, Task
from .file_dialogs import FileDialogs
from .scripts import SOUND_SUFFIXES, ScriptCommands

MESH_SUFFIXES = tuple(f".{name}" for name in FORMATS)
LANDMARKS_SUFFIX = ".json"


def files_by_kind(paths: Sequence[Path]) -> dict[str, Path]:
    """Return files by kind: mesh, landmarks, sound or script; a script may be a pose or recording.

    The suffix decides the kind; a JSON file is read, because it may be a recording. UserError for
    two files of one kind, and for a map of light.
    """
    found: dict[str, Path] = {}
    for path in paths:
        end = Path(path.name.lower().removesuffix(".gz")).suffix  # reading reports a wrong .gz
        if end in LIGHT_SUFFIXES:
            raise UserError(
                f"{path.name}: is a map of light, which `risorius capture --light` reads; the "
                "window has the lights of its panel Scene"
            )
        kind = "mesh" if end in MESH_SUFFIXES else "sound" if end in SOUND_SUFFIXES else "script"
        if end == LANDMARKS_SUFFIX and not is_recording(path):
            kind = "landmarks"
        if kind in found:
            names = f"{found[kind].name}, {path.name}"
            raise UserError(f"{names}: one of them is enough; drop it alone")
        found[kind] = path
    return found


class FileDrop:
    """Opens dropped files; a head takes seconds to make, so a thread makes it."""

    def __init__(
        self,
        files: FileDialogs,
        scripts: ScriptCommands,
        show_scene: Callable[[Scene], None],
        read: Callable[[Path, Path | None], Task],
    ) -> None:
        """show_scene: replaces the current scene by a scene with another head.

        read: reads a mesh, and landmarks if a file has some, in a thread; returns a task that opens
        the marking of the missing landmarks.
        """
        self._files = files
        self._scripts = scripts
        self._show_scene = show_scene
        self._read = read
        self.making: Future[Task] | None = None  # the task that shows a head
        self._action = ""  # the thread's work, in words
        self._begun = 0.0  # start time [s]
        self._shown_seconds = 0

    def open(self, paths: Sequence[str]) -> Message:
        """Open files, or begin to make a head."""
        gone = next((path for path in paths if not Path(path).exists()), None)
        if gone is not None:
            raise UserError(f"{gone}: no such file")
        found = files_by_kind([Path(path) for path in paths])
        mesh = found.pop("mesh", None)
        landmarks = found.pop("landmarks", None)
        if mesh is None and landmarks is not None:
            raise UserError(
                f"{landmarks.name}: has landmarks alone; drop it together with its mesh, "
                "such as an .obj"
            )
        if mesh is None:
            return self._play(found)
        action = "Reading" if landmarks is None else "Fitting muscles to"
        self._begin(f"{action} {mesh.name}", partial(self._make, mesh, landmarks, found))
        return None

    def show_person(self, who: int | str | None) -> None:
        """Begin to make the head with this number or name; None for the built-in head."""

        def make() -> Task:
            head = None if who is None else called_head(who)
            return partial(self._show_scene, build_scene("face", head))

        self._begin(f"Making {'the built-in head' if who is None else head_in_words(who)}", make)

    def _begin(self, action: str, make: Callable[[], Task]) -> None:
        """Start a thread that makes the task to show a head; drop an earlier thread's result."""
        self._action = action
        self._begun = time.monotonic()
        self._shown_seconds = -1
        thread = ThreadPoolExecutor(1)
        self.making = thread.submit(make)
        self.making.add_done_callback(lambda _: wake_up())
        thread.shutdown(wait=False)

    @property
    def has_news(self) -> bool:
        """Whether the head is ready, or another second has passed."""
        making = self.making
        seconds = int(time.monotonic() - self._begun)
        return making is not None and (making.done() or seconds > self._shown_seconds)

    def poll(self) -> Message:
        """Show the head if it is ready; otherwise return a message with the elapsed time."""
        making = self.making
        if making is not None and making.done():
            self.making = None
            return making.result()()
        self._shown_seconds = int(time.monotonic() - self._begun)
        return f"{self._action} ... {self._shown_seconds} s"

    def _make(self, mesh: Path, landmarks: Path | None, others: Mapping[str, Path]) -> Task:
        """Return a task that shows a head or opens its marking, and then opens the other files."""
        show = None
        remark = ""
        complaint = ""
        try:
            scene = build_scene("face", own_head(mesh, landmarks))
            show = partial(self._show_scene, scene)
            remark = f" with {mesh.name}"
        except UnfinishedError as error:  # its marking opens instead
            complaint = str(error) if isinstance(error, MisfitError) else ""
        except assets.AssetError as error:
            raise UserError(str(error)) from None
        show_first = show or self._read(mesh, landmarks)

        def go_on() -> Message:
            """Show the head first, then play the script, pose or recording on it."""
            line = show_first() or (f"{mesh.name}: opened" if remark else complaint)
            self._scripts.note_recent(*filter(None, (mesh, landmarks)))
            return self._play(others, remark) or line

        return go_on

    def _play(self, found: Mapping[str, Path], remark: str = "") -> Message:
        line = self._scripts.open(found["script"], remark) if "script" in found else None
        return self._scripts.set_sound(found["sound"]) if "sound" in found else line

    def ask_head(self) -> None:
        """Ask for a mesh; show it with the landmark file beside it, or else open its marking."""

        def go_on(mesh: Path) -> Message:
            """Open the mesh, with a landmark file of the same name if there is one."""
            own = (
                mesh.with_suffix(end) for end in (LANDMARKS_SUFFIX, f".landmarks{LANDMARKS_SUFFIX}")
            )
            landmarks = next((path for path in own if path.is_file()), None)
            return self.open([str(path) for path in (mesh, landmarks) if path is not None])

        self._files.ask("Open head", go_on, saving=False, suffixes=MESH_SUFFIXES)
