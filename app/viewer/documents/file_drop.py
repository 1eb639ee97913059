"""Files dropped onto the window: a script, pose or recording, a sound, a head, a light map."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path

from risorius import assets
from risorius.assets.fitting.landmark_file import MisfitError, UnfinishedError
from risorius.assets.meshes import MESH_FORMATS

from ...errors import UserError
from ...light_maps import LIGHT_SUFFIXES, check_light_map, open_light
from ...recordings.reading import is_recording
from ...scenes import Scene, build_scene, called_head, fit_users_head, head_in_words
from ..interface.gui import wake_up
from ..messages import Message, Task
from ..settings import Settings
from .file_dialogs import FileDialogs
from .scripts import SOUND_SUFFIXES, ScriptCommands

MESH_SUFFIXES = tuple(f".{name}" for name in MESH_FORMATS)
LANDMARKS_SUFFIX = ".json"
SUFFIXES_OF_KIND = {"mesh": MESH_SUFFIXES, "sound": SOUND_SUFFIXES, "light": LIGHT_SUFFIXES}


def files_by_kind(paths: Sequence[Path]) -> dict[str, Path]:
    """Return files by kind: mesh, landmarks, sound, light or script.

    A script may be a pose or a recording. The suffix decides the kind; a JSON file is read, because
    it may be a recording. UserError for two files of one kind.
    """
    found: dict[str, Path] = {}
    for path in paths:
        end = Path(path.name.lower().removesuffix(".gz")).suffix  # reading reports a wrong .gz
        kind = next((each for each, ends in SUFFIXES_OF_KIND.items() if end in ends), "script")
        if end == LANDMARKS_SUFFIX and not is_recording(path):
            kind = "landmarks"
        if kind in found:
            names = f"{found[kind].name}, {path.name}"
            raise UserError(f"{names}: one of them is enough; drop only that one")
        found[kind] = path
    return found


class Making:
    """A thread that makes a task for the window's thread.

    action: the thread's work, in words.
    """

    def __init__(self, action: str, make: Callable[[], Task]) -> None:
        self._action = action
        self._begun = time.monotonic()
        self._shown_seconds = -1
        thread = ThreadPoolExecutor(1)
        self._task: Future[Task] = thread.submit(make)
        self._task.add_done_callback(lambda _: wake_up())
        thread.shutdown(wait=False)

    @property
    def is_done(self) -> bool:
        """Whether the task is made."""
        return self._task.done()

    @property
    def has_news(self) -> bool:
        """Whether the task is made, or another second has passed."""
        return self.is_done or int(time.monotonic() - self._begun) > self._shown_seconds

    def report(self) -> Message:
        """Run the task if it is made; otherwise return a message with the elapsed time."""
        if self.is_done:
            return self._task.result()()
        self._shown_seconds = int(time.monotonic() - self._begun)
        return f"{self._action} ... {self._shown_seconds} s"


class FileDrop:
    """Opens dropped files; a head or a map takes seconds to read, so a thread reads it."""

    def __init__(
        self,
        files: FileDialogs,
        scripts: ScriptCommands,
        settings: Settings,
        show_scene: Callable[[Scene], None],
        read: Callable[[Path, Path | None], Task],
    ) -> None:
        """show_scene: replaces the current scene by a scene with another head.

        read: reads a mesh, and landmarks if a file has some, in a thread; returns a task that opens
        the marking of the missing landmarks.
        """
        self._files = files
        self._scripts = scripts
        self._settings = settings
        self._show_scene = show_scene
        self._read = read
        self._making: dict[str, Making] = {}  # by kind of file, at most one mesh and one light

    def open(self, paths: Sequence[str]) -> Message:
        """Open files, or begin to read a light map or to make a head."""
        gone = next((path for path in paths if not Path(path).exists()), None)
        if gone is not None:
            raise UserError(f"{gone}: no such file")
        found = files_by_kind([Path(path) for path in paths])
        light = found.pop("light", None)
        mesh = found.pop("mesh", None)
        landmarks = found.pop("landmarks", None)
        if mesh is None and landmarks is not None:
            raise UserError(
                f"{landmarks.name}: has only landmarks; drop it together with its mesh, "
                "such as an .obj"
            )
        if light is not None:
            check_light_map(light)
            make = partial(self._read_light, light)
            self._making["light"] = Making(f"Reading {light.name}", make)
        if mesh is None:
            return self._play(found)
        action = "Reading" if landmarks is None else "Fitting muscles to"
        make = partial(self._make, mesh, landmarks, found)
        self._making["mesh"] = Making(f"{action} {mesh.name}", make)
        return None

    def show_person(self, who: int | str | None) -> None:
        """Begin to make the head with this number or name; None for the built-in head.

        The result of an earlier thread that makes a head is dropped.
        """

        def make() -> Task:
            head = None if who is None else called_head(who)
            return partial(self._show_scene, build_scene("face", head))

        name = "the built-in head" if who is None else head_in_words(who)
        self._making["mesh"] = Making(f"Making {name}", make)

    @property
    def is_making(self) -> bool:
        """Whether a thread makes a head or reads a light map."""
        return bool(self._making)

    @property
    def has_news(self) -> bool:
        """Whether a head or a light is ready, or another second has passed."""
        return any(each.has_news for each in self._making.values())

    def poll(self) -> Message:
        """Show a head or a light that is ready; otherwise return a message with the time."""
        kind, making = next(each for each in self._making.items() if each[1].has_news)
        if making.is_done:
            del self._making[kind]
        return making.report()

    def _read_light(self, path: Path) -> Task:
        """Return a task that lights the scene by a map."""
        name = open_light(path)

        def show() -> Message:
            """Light the scene."""
            self._settings.display.light = name
            self._scripts.note_recent(path)
            return f"{path.name}: lights the scene"

        return show

    def _make(self, mesh: Path, landmarks: Path | None, others: Mapping[str, Path]) -> Task:
        """Return a task that shows a head or opens its marking, and then opens the other files."""
        show = None
        remark = ""
        complaint = ""
        try:
            scene = build_scene("face", fit_users_head(mesh, landmarks))
            show = partial(self._show_scene, scene)
            remark = f" with {mesh.name}"
        except UnfinishedError as error:  # its marking opens instead
            complaint = str(error) if isinstance(error, MisfitError) else ""
        except assets.AssetError as error:
            raise UserError(str(error)) from None
        show_first = show or self._read(mesh, landmarks)

        def show_all() -> Message:
            """Show the head first, then play the script, pose or recording on it."""
            line = show_first() or (f"{mesh.name}: opened" if remark else complaint)
            self._scripts.note_recent(*filter(None, (mesh, landmarks)))
            return self._play(others, remark) or line

        return show_all

    def _play(self, found: Mapping[str, Path], remark: str = "") -> Message:
        line = self._scripts.open(found["script"], remark) if "script" in found else None
        return self._scripts.set_sound(found["sound"]) if "sound" in found else line

    def ask_light(self) -> None:
        """Ask for a light map, and light the scene by it."""

        def open_map(path: Path) -> Message:
            """Open the map."""
            return self.open([str(path)])

        self._files.open("Open light map", open_map, saving=False, suffixes=LIGHT_SUFFIXES)

    def ask_head(self) -> None:
        """Ask for a mesh; show it with the landmark file beside it, or else open its marking."""

        def open_mesh(mesh: Path) -> Message:
            """Open the mesh, with a landmark file of the same name if there is one."""
            files = [mesh]
            for suffix in (LANDMARKS_SUFFIX, f".landmarks{LANDMARKS_SUFFIX}"):
                landmarks = mesh.with_suffix(suffix)
                if landmarks.is_file():
                    files.append(landmarks)
                    break
            return self.open([str(file) for file in files])

        self._files.open("Open head", open_mesh, saving=False, suffixes=MESH_SUFFIXES)
