"""Files let go over the window: what to play, a sound, a head."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from risorius import assets
from risorius.assets.fitting.landmark_file import UnfinishedError
from risorius.assets.identities import person_called, person_in_words
from risorius.assets.meshes import FORMATS

from ...errors import UserError
from ...recordings import is_recording
from ...scenes import Scene, build_scene, own_head
from ..messages import Message, Task
from .file_dialogs import FileDialogs
from .scripts import SOUNDS, ScriptCommands

FITTING, READING = "Fitting the muscles to this head", "Reading this mesh"  # as is announced
MESHES = tuple(f".{name}" for name in FORMATS)
LANDMARKS = ".json"


def sorted_out(paths: Sequence[Path]) -> dict[str, Path]:
    """Files by what they are: mesh, landmarks, sound, or else script, a pose or recording, too.

    Names tell, but of JSON, which may be a recording. UserError for several of a kind.
    """
    found: dict[str, Path] = {}
    for path in paths:
        end = path.suffix.lower()
        kind = "mesh" if end in MESHES else "sound" if end in SOUNDS else "script"
        if end == LANDMARKS and not is_recording(path):
            kind = "landmarks"
        if kind in found:
            names = f"{found[kind].name}, {path.name}"
            raise UserError(f"{names}: one of them is enough; drop it alone")
        found[kind] = path
    return found


class FileDrop:
    """Opens dropped files; a head, which takes a while, in a frame after it was announced."""

    def __init__(
        self,
        files: FileDialogs,
        scripts: ScriptCommands,
        show_scene: Callable[[Scene], None],
        mark: Callable[[Path, Path | None], Message],
    ) -> None:
        """show_scene: puts a scene with another head in place of the present one.

        mark: has the landmarks of a mesh marked, or those of a file that are missing.
        """
        self._files, self._scripts, self._show_scene = files, scripts, show_scene
        self._mark = mark
        self.announced: Task | None = None  # what fits a head, once it was said that it will
        self.has_other_head = False  # than the built-in one

    def open(self, paths: Sequence[str]) -> Message:
        """Open files, or announce that a head will be fitted."""
        gone = next((path for path in paths if not Path(path).exists()), None)
        if gone is not None:
            raise UserError(f"{gone}: no such file")
        found = sorted_out([Path(path) for path in paths])
        if not found.keys() & {"mesh", "landmarks"}:
            return self._open(**found)
        self.announced = partial(self._open, **found)
        return f"{FITTING if 'landmarks' in found else READING} ..."

    def show_person(self, who: int | str | None) -> Message:
        """Announce a person by number or name, in place of the head; None: the built-in head."""
        self.announced = lambda: self._show_scene(
            build_scene("face", None if who is None else person_called(who))
        )
        self.has_other_head = who is not None
        return f"Making {'the built-in head' if who is None else person_in_words(who)} ..."

    def _open(
        self,
        mesh: Path | None = None,
        landmarks: Path | None = None,
        script: Path | None = None,
        sound: Path | None = None,
    ) -> Message:
        """Show the head first, then what shall be played on it."""
        line, remark = None, ""
        if mesh is not None and landmarks is None:
            line = self._mark(mesh, None)
            self._scripts.note_recent(mesh)
        elif landmarks is not None:
            if mesh is None:
                raise UserError(
                    f"{landmarks.name}: is half of a head; drop it together with its mesh, an .obj "
                    "say"
                )
            try:
                self._show_scene(build_scene("face", own_head(mesh, landmarks)))
            except UnfinishedError:
                return self._mark(mesh, landmarks)
            except assets.AssetError as error:
                raise UserError(str(error)) from None
            self.has_other_head = True
            self._scripts.note_recent(mesh, landmarks)
            line, remark = f"{mesh.name}: opened", f" with {mesh.name}"
        if script is not None:
            line = self._scripts.open(script, remark) or line
        if sound is not None:
            line = self._scripts.set_sound(sound)
        return line

    def ask_head(self) -> None:
        """Ask for a mesh; show it with the landmarks beside it, or have them marked."""

        def go_on(mesh: Path) -> Message:
            """Take the landmarks that bear the mesh's name."""
            own = (mesh.with_suffix(end) for end in (LANDMARKS, f".landmarks{LANDMARKS}"))
            landmarks = next((path for path in own if path.is_file()), None)
            return self.open([str(path) for path in (mesh, landmarks) if path is not None])

        self._files.ask("Open head", go_on, saving=False, suffixes=MESHES)
