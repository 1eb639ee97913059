"""Files let go over the window: what to play, a sound, a head."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from risorius import assets
from risorius.assets.fitting.landmark_file import UnfinishedError
from risorius.assets.identities import person_called, person_in_words
from risorius.assets.meshes import FORMATS

from ...errors import UserError
from ...recordings import is_recording
from ...scenes import Scene, build_scene, own_head
from ..messages import Message
from .file_dialogs import FileDialogs
from .scripts import SOUNDS, ScriptCommands

FITTING, READING = "Fitting the muscles to this head", "Reading this mesh"  # as is announced
MESHES = tuple(f".{name}" for name in FORMATS)
LANDMARKS = ".json"


@dataclass(frozen=True)
class DroppedFiles:
    """What the files are taken for."""

    script: Path | None = None  # or a pose or recording; anything else is tried, and told wrong
    mesh: Path | None = None
    landmarks: Path | None = None
    sound: Path | None = None

    @classmethod
    def of(cls, paths: Sequence[Path]) -> DroppedFiles:
        """Sort out files by the ends of their names; JSON may be a recording, too.

        UserError for several of a kind.
        """
        meshes = [path for path in paths if path.suffix.lower() in MESHES]
        landmarks = [
            path for path in paths if path.suffix.lower() == LANDMARKS and not is_recording(path)
        ]
        sounds = [path for path in paths if path.suffix.lower() in SOUNDS]
        scripts = [path for path in paths if path not in (*meshes, *landmarks, *sounds)]
        kinds = (scripts, meshes, landmarks, sounds)
        for several in (kind for kind in kinds if len(kind) > 1):
            names = ", ".join(path.name for path in several)
            raise UserError(f"{names}: one of them is enough; drop it alone")
        return cls(*(next(iter(kind), None) for kind in kinds))

    @property
    def has_head(self) -> bool:
        """Whether there is any part of a head."""
        return self.mesh is not None or self.landmarks is not None

    def scene(self) -> Scene:
        """A face with the head, fitted; UserError for one that cannot be."""
        mesh, landmarks = self.mesh, self.landmarks
        if mesh is None or landmarks is None:
            name = landmarks.name if landmarks else ""
            raise UserError(
                f"{name}: is half of a head; drop it together with its mesh, an .obj say"
            )
        try:
            return build_scene("face", own_head(mesh, landmarks))
        except UnfinishedError:
            raise
        except assets.AssetError as error:
            raise UserError(str(error)) from None


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
        self._announced: Callable[[], Message] | None = None
        self.has_other_head = False  # than the built-in one

    @property
    def has_announced(self) -> bool:
        """Whether a head waits to be fitted."""
        return self._announced is not None

    def open(self, paths: Sequence[str]) -> Message:
        """Open files, or announce that a head will be fitted."""
        gone = next((path for path in paths if not Path(path).exists()), None)
        if gone is not None:
            raise UserError(f"{gone}: no such file")
        dropped = DroppedFiles.of([Path(path) for path in paths])
        if not dropped.has_head:
            return self._open(dropped)
        self._announced = partial(self._open, dropped)
        return f"{FITTING if dropped.landmarks else READING} ..."

    def do_announced(self) -> Message:
        """Fit the head that was announced; all that was done stays."""
        task, self._announced = self._announced, None
        return None if task is None else task()

    def show_person(self, who: int | str | None) -> Message:
        """Announce a person by number or name, in place of the head; None: the built-in head."""
        self._announced = lambda: self._show_scene(
            build_scene("face", None if who is None else person_called(who))
        )
        self.has_other_head = who is not None
        return f"Making {'the built-in head' if who is None else person_in_words(who)} ..."

    def _open(self, dropped: DroppedFiles) -> Message:
        """Show the head first, then what shall be played on it."""
        line, remark = None, ""
        if dropped.mesh is not None and dropped.landmarks is None:
            line = self._mark(dropped.mesh, None)
            self._scripts.note_recent(dropped.mesh)
        elif dropped.has_head:
            try:
                scene = dropped.scene()
            except UnfinishedError:
                assert dropped.mesh is not None
                return self._mark(dropped.mesh, dropped.landmarks)
            self._show_scene(scene)
            self.has_other_head = True
            assert dropped.mesh is not None and dropped.landmarks is not None
            self._scripts.note_recent(dropped.mesh, dropped.landmarks)
            line, remark = f"{dropped.mesh.name}: opened", f" with {dropped.mesh.name}"
        if dropped.script is not None:
            line = self._scripts.open(dropped.script, remark) or line
        if dropped.sound is not None:
            line = self._scripts.set_sound(dropped.sound)
        return line

    def ask_head(self) -> None:
        """Ask for a mesh; show it with the landmarks beside it, or have them marked."""

        def go_on(mesh: Path) -> Message:
            """Take the landmarks that bear the mesh's name."""
            own = (mesh.with_suffix(end) for end in (LANDMARKS, f".landmarks{LANDMARKS}"))
            landmarks = next((path for path in own if path.is_file()), None)
            return self.open([str(path) for path in (mesh, landmarks) if path is not None])

        self._files.ask("Open head", go_on, saving=False, suffixes=MESHES)
