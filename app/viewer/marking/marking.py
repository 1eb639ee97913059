"""A mesh whose landmarks are being marked: what is done to the marks, undo, its file.

Knows nothing of windows. Places are those of the mesh's own coordinates; `placing` takes them to
the space that is seen, in which the head is about as large as a head in millimetres, and upright
as soon as the first points tell how.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from risorius.assets.errors import AssetError
from risorius.assets.fitting.guess import guess, placing, skin_around
from risorius.assets.fitting.landmark_file import landmarks_text, read_marks
from risorius.assets.fitting.soundness import check_manifold
from risorius.assets.fitting.warp import Similarity, nearest_on
from risorius.assets.meshes import read_mesh
from risorius.assets.topology import vertex_normals
from risorius.sim.landmarks import MIRRORED

from ...errors import UserError
from ...files import save_text
from ..files import Files
from ..history import History
from ..messages import Message, Task
from .marks import GROUP_OF, ORDER, Marks, name_of

SEEN_RADIUS = 140.0  # [mm] of the mesh, as long as nobody knows how large a head is in it
SUFFIX = ".json"
INNER_LIPS = range(60, 68)
FORWARD = np.array([0.0, 0.0, 1.0])  # out of a face that is upright

FloatArray = npt.NDArray[np.float64]


class Marking:
    """Marks on one mesh. `current` is the landmark that is asked for, or was chosen."""

    def __init__(self, path: Path, files: Files) -> None:
        """Read a mesh; UserError where no head can be made of it, whatever is marked."""
        self.path, self._files = path, files
        with _for_users():
            self.mesh = mesh = read_mesh(path)
        with _for_users(f"{path.name}: "):
            check_manifold(mesh.faces)
        middle = 0.5 * (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0))
        radius = max(float(np.linalg.norm(mesh.vertices - middle, axis=1).max()), 1e-12)
        self.file: Path | None = None  # in which the marks are kept
        self._saved = Marks({})
        self.marks = self._saved
        self._history = History(self.marks, lambda _, after: len(after.places))
        self.current = ORDER[0]
        self.is_upright = False
        scale = SEEN_RADIUS / radius
        self._place(Similarity(scale, np.eye(3), -scale * middle))
        self._ask()

    # Where the mesh is seen

    def _place(self, placing: Similarity) -> None:
        self.placing = placing
        self.positions = placing.points(self.mesh.vertices)
        faces = self.mesh.faces
        normals = vertex_normals(self.positions, faces)
        off = self.positions - self.positions.mean(axis=0)
        if float((normals * off).sum()) < 0.0:  # it faces inward throughout
            faces, normals = np.ascontiguousarray(faces[:, ::-1]), -normals
        self.faces, self._normals = faces, normals
        self._nearest = cKDTree(self.positions)

    def _stand_up(self) -> None:
        """The first time that all marks are there: upright, looking ahead, as large as a head.

        Those of a file may be no face's; then the mesh stays as it is, and they can be mended.
        """
        if not self.is_upright:
            with contextlib.suppress(AssetError):
                self._place(placing(self.marks.by_hand))
                self.current, self.is_upright = ORDER[0], True

    def turn(self, axis: FloatArray) -> None:
        """Turn the mesh by a quarter about one of the axes of what is seen."""
        turn = np.cross(np.eye(3), -axis) + np.outer(axis, axis)
        old = self.placing
        self._place(Similarity(old.scale, turn @ old.rotation, turn @ old.shift))

    def seen(self, numbers: Iterable[int]) -> tuple[FloatArray, FloatArray]:
        """Where marks are seen, and the normals of the skin there, shape (n, 3) each."""
        chosen = list(numbers)
        places = [self.marks.places[number] for number in chosen]
        points = self.placing.points(np.reshape(places, (-1, 3)))
        normals = self._normals[self._nearest.query(points)[1]]
        if self.is_upright:  # skin between lips that touch looks up or down, and is seen from ahead
            normals[[number in INNER_LIPS for number in chosen]] = FORWARD
        return points, normals

    # What is marked

    @property
    def asked(self) -> int | None:
        """The first point that is not marked yet, before the others can be guessed."""
        return self.marks.asked

    def put(self, number: int, point: FloatArray) -> None:
        """Place a landmark at a point of what is seen; `note` says when that is done."""
        self.marks = self.marks.placed(number, self.placing.inverse.points(point))

    def note(self) -> Message:
        """A change is complete: it can be undone, and what comes next is asked for, or guessed."""
        self._history.note(self.marks)
        self._ask()
        return self.guess() if self.can_guess and not self.marks.is_complete else None

    def _ask(self) -> None:
        asked = self.asked
        self.current = self.current if asked is None else asked

    @property
    def can_guess(self) -> bool:
        """Whether the first points are there."""
        return self.asked is None

    def guess(self) -> Message:
        """Place all that were not placed by hand; UserError where the marks are no face's."""
        with _for_users(cure="; drag points, or undo"):
            self.marks = self.marks.with_guessed(guess(self.mesh, self.marks.by_hand))
        self._stand_up()
        self.note()
        return "all points are guessed; drag those that are not where they belong"

    def go(self, step: int) -> None:
        """To the next landmark in the order of marking, or with -1 to the one before."""
        if self.can_guess:
            self.current = ORDER[(ORDER.index(self.current) + step) % len(ORDER)]

    def mirror(self, *, whole: bool = False) -> Message:
        """Take the other side from that of the current point: its group, or `whole` sides."""
        on_side = {n for n in GROUP_OF if name_of(n).split("right")[1:]}
        is_right = self.current in on_side
        if int(MIRRORED[self.current]) == self.current:
            return "choose a point of the side that is right: this one is in the middle"
        group = set(ORDER if whole else GROUP_OF[self.current].numbers)
        numbers = [n for n in group if MIRRORED[n] != n and (n in on_side) == is_right]
        points, normals = self.seen(numbers)
        all_seen, _ = self.seen(range(len(MIRRORED)))
        across = (all_seen[MIRRORED] - all_seen)[sorted(on_side)].sum(axis=0)
        across /= max(float(np.linalg.norm(across)), 1e-12)
        middle = all_seen.mean(axis=0)
        wanted = points - 2.0 * np.outer((points - middle) @ across, across)
        facing = normals - 2.0 * np.outer(normals @ across, across)
        skin = skin_around(self.positions, self.faces, all_seen)
        found = nearest_on(wanted, facing, self.positions, skin).interpolate(self.positions)
        for number, point in zip(numbers, found, strict=True):
            self.put(int(MIRRORED[number]), point)
        self.note()
        return None

    # Undo

    @property
    def can_undo(self) -> bool:
        """Whether there is something to undo."""
        return self._history.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether there is something to redo."""
        return self._history.can_redo

    def undo(self) -> None:
        """Back to before the last change."""
        self.marks = self._history.undo()
        self._ask()

    def redo(self) -> None:
        """Forward again."""
        self.marks = self._history.redo()
        self._ask()

    # Files

    @property
    def unsaved(self) -> str:
        """What would be lost, in words; "" for nothing."""
        return "" if self.marks == self._saved else f"the landmarks of {self.path.name}"

    def open(self, path: Path) -> Message:
        """Go on with the marks of a file; UserError where it has none of this mesh."""
        with _for_users():
            places, guessed = read_marks(path, self.mesh)
        marks = Marks({})
        for number, place in places.items():
            marks = marks.placed(number, place)
        self.marks = self._saved = Marks(marks.places, guessed)
        self.file = path
        if self.marks.is_complete:
            self._stand_up()
        return self.note() or f"{path.name}: {len(places)} landmarks"

    def ask_open(self) -> None:
        """Ask for a landmark file, and go on with it."""
        self._files.ask(
            "Open landmarks", self.open, saving=False, kind="Landmarks", suffixes=(SUFFIX,)
        )

    def save(self, then: Task = lambda: None) -> Message:
        """Write the marks to their file, all or as many as there are, or ask for one first."""
        if self.file is not None:
            return self._write(self.file, then)
        self.save_as(then)
        return None

    def save_as(self, then: Task = lambda: None) -> None:
        """Ask for a name, and write the marks."""
        write: Callable[[Path], Message] = lambda path: self._write(path, then)  # noqa: E731
        name = self.file or self.path.with_suffix(SUFFIX)
        self._files.ask(
            "Save landmarks",
            write,
            saving=True,
            proposed=str(name.absolute()),
            kind="Landmarks",
            suffixes=(SUFFIX,),
        )

    def _write(self, path: Path, then: Task) -> Message:
        save_text(path, landmarks_text(self.marks.places, self.marks.guessed))
        self.file, self._saved = path, self.marks
        count = len(self.marks.places)
        rest = "" if self.marks.is_complete else "; the others can be marked another time"
        return then() or f"{path}: {count} landmarks written{rest}"


@contextlib.contextmanager
def _for_users(what: str = "", cure: str = "") -> Iterator[None]:
    """What is wrong with a mesh or with marks is for users to mend."""
    try:
        yield
    except AssetError as error:
        raise UserError(f"{what}{error}{cure}") from None
