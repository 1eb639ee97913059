"""Several files let go over the window at once: a script or pose, a head, and what is too much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from risorius import assets
from risorius.assets.meshes import FORMATS

from ..errors import UserError
from ..scenes import build_scene, head_for
from . import commands

if TYPE_CHECKING:
    from .window import Viewer

MESHES = tuple(f".{name}" for name in FORMATS)
LANDMARKS = ".json"


@dataclass(frozen=True)
class Dropped:
    """What the files are taken for."""

    script: Path | None = None  # or a pose; anything else is tried as one, and told what is wrong
    mesh: Path | None = None
    landmarks: Path | None = None
    left_over: tuple[Path, ...] = ()  # of each kind the first one counts

    @classmethod
    def of(cls, paths: Sequence[Path]) -> Dropped:
        """Sort out files by the ends of their names."""
        meshes = [path for path in paths if path.suffix.lower() in MESHES]
        landmarks = [path for path in paths if path.suffix.lower() == LANDMARKS]
        scripts = [path for path in paths if path not in (*meshes, *landmarks)]
        firsts = [next(iter(kind), None) for kind in (scripts, meshes, landmarks)]
        left_over = (*scripts[1:], *meshes[1:], *landmarks[1:])
        return cls(firsts[0], firsts[1], firsts[2], left_over)

    @property
    def brings_head(self) -> bool:
        """Whether there is any part of a head."""
        return self.mesh is not None or self.landmarks is not None

    def names_left(self) -> str:
        """The end of a message: which files were not opened."""
        names = [path.name for path in self.left_over]
        return f"; not opened, as one is enough: {', '.join(names)}" if names else ""


def open_dropped(viewer: Viewer, dropped: Dropped) -> None:
    """Show the head first, then what shall be played on it."""
    remark = dropped.names_left()
    if dropped.brings_head:
        name = show_head(viewer, dropped)
        viewer.messages.say(f"{name}: opened{remark}")
        remark = f" with {name}{remark}"
    if dropped.script is not None:
        commands.load(viewer, dropped.script, remark)


def ask_head(viewer: Viewer) -> None:
    """Ask for a mesh, then for its landmarks, and show them as if they had been dropped."""

    def go_on(mesh: Path) -> None:
        viewer.files.ask(
            f"The landmarks of {mesh.name}",
            lambda landmarks: viewer.drop([str(mesh), str(landmarks)]),
            saving=False,
            kind="Landmarks",
            suffixes=(LANDMARKS,),
        )

    viewer.files.ask("Open head", go_on, saving=False, kind="Meshes", suffixes=MESHES)


def show_head(viewer: Viewer, dropped: Dropped) -> str:
    """Fit the head and show it in place of the present one, and return its name.

    All that was done stays. Raises UserError for a head that cannot be fitted.
    """
    mesh, landmarks = dropped.mesh, dropped.landmarks
    if mesh is None or landmarks is None:
        given, missing = (mesh, "landmarks, a .json") if mesh else (landmarks, "mesh, an .obj say")
        name = given.name if given else ""
        raise UserError(f"{name}: is half of a head; drop it together with its {missing}")
    try:
        head = head_for(mesh, landmarks)
    except assets.AssetError as error:
        raise UserError(str(error)) from None
    viewer.move_to(build_scene("face", head))
    return mesh.name
