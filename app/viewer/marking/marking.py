"""A mesh whose landmarks are being marked: its marks, undo, its file.

This module is independent of windows. Places are in the mesh's own coordinates; `placing`
transforms them to the picture's space, which is upright and in millimetres once all marks exist.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
import scipy

from risorius.assets.errors import AssetError
from risorius.assets.fitting.guess import FIRST_LANDMARKS, centred, guess, placing
from risorius.assets.fitting.landmark_file import landmarks_text, read_marks
from risorius.assets.fitting.mesh_validation import check_pieces
from risorius.assets.fitting.warp import Similarity
from risorius.assets.meshes import read_mesh
from risorius.geometry.arrays import Floats64
from risorius.geometry.normals import vertex_normals
from risorius.sim.landmarks import LANDMARK_COUNT

from ...errors import UserError
from ...files import save_text
from ...scenes import Drawable
from ..documents.file_dialogs import FileDialogs
from ..messages import Message, Task
from ..session.document import History

INNER_LIP_LANDMARKS = range(60, 68)

MeshPoint = tuple[float, float, float]  # in the mesh's own coordinates
Colour = tuple[float, float, float]  # sRGB


@dataclass(frozen=True)
class MarkingGroup:
    """A group of landmarks that are marked one after another.

    lines: for each drawn line, the numbers of its landmarks.
    """

    title: str
    colour: Colour
    lines: tuple[tuple[int, ...], ...]

    @property
    def numbers(self) -> tuple[int, ...]:
        """The landmarks to mark, each once, in the order of marking."""
        return tuple(dict.fromkeys(number for line in self.lines for number in line))


def _row(first: int, last: int, *more: int) -> tuple[int, ...]:
    return (*range(first, last + 1), *more)


MARKING_GROUPS = (  # in the order of marking
    MarkingGroup("eyes", (0.96, 0.55, 0.08), (_row(36, 41, 36), _row(42, 47, 42))),
    MarkingGroup("outer lips", (0.86, 0.18, 0.26), (_row(48, 59, 48),)),
    MarkingGroup("inner lips", (0.93, 0.76, 0.20), (_row(60, 67, 60),)),
    MarkingGroup("nose", (0.10, 0.62, 0.42), (_row(27, 30), _row(31, 35))),
    MarkingGroup("brows", (0.58, 0.36, 0.84), (_row(17, 21), _row(22, 26))),
    MarkingGroup("jaw line", (0.16, 0.48, 0.88), (_row(0, 16),)),
)
GROUP_OF = {number: group for group in MARKING_GROUPS for number in group.numbers}
MARKING_ORDER = tuple(GROUP_OF)


@dataclass(frozen=True)
class Marks:
    """Points of the existing landmarks; `guessed`: numbers of landmarks that no user placed."""

    places: Mapping[int, MeshPoint]
    guessed: frozenset[int] = frozenset()

    def placed(self, number: int, place: npt.ArrayLike) -> Marks:
        """Return these marks with one more mark, placed by hand."""
        x, y, z = np.asarray(place, np.float64).tolist()
        return Marks({**self.places, number: (x, y, z)}, self.guessed - {number})

    def with_guessed(self, found: Floats64) -> Marks:
        """Return marks at guessed places, shape (68, 3), except for marks placed by hand."""
        guessed = {n: (x, y, z) for n, (x, y, z) in enumerate(found.tolist())}
        return Marks({**guessed, **self.by_hand}, frozenset(guessed.keys() - self.by_hand.keys()))

    @property
    def by_hand(self) -> dict[int, MeshPoint]:
        """The marks that were placed by hand."""
        return {n: place for n, place in self.places.items() if n not in self.guessed}

    @property
    def is_complete(self) -> bool:
        """Whether all 68 landmarks exist."""
        return len(self.places) == LANDMARK_COUNT

    @property
    def next_landmark(self) -> int | None:
        """The landmark that must be marked next; None if the rest can be guessed."""
        return next((number for number in FIRST_LANDMARKS if number not in self.places), None)


class Marking:
    """The marks on one mesh; `current`: the landmark to mark next, or the chosen one."""

    LANDMARKS_SUFFIX = ".json"

    def __init__(self, path: Path, files: FileDialogs) -> None:
        """Read a mesh; raises UserError if the file has no usable mesh."""
        self.path = path
        self._files = files
        with _for_users():
            self.mesh = mesh = read_mesh(path)
        with _for_users(f"{path.name}: "):
            check_pieces(mesh.faces, len(mesh.vertices))
        self.file: Path | None = None  # file of the marks
        self.marks = self._saved = Marks({})
        self.current = FIRST_LANDMARKS[0]
        self.seen_mesh = Drawable("face", mesh.faces, mesh.vertices)  # in the picture's space
        radius = 140.0  # [mm] of the displayed mesh, until marks show the head's size
        self._place(centred(mesh.vertices, radius))
        self._upright: Similarity | None = None
        self.history = History((self.marks, self.placing))

    # Place of the mesh

    def _place(self, placing: Similarity) -> None:
        self.placing = placing
        seen = self.seen_mesh
        seen.place(placing.points(self.mesh.vertices))
        self._normals = vertex_normals(seen.positions, seen.faces)
        off = seen.positions - seen.positions.mean(axis=0)
        if float((self._normals * off).sum()) < 0.0:  # the triangles face inward
            seen.faces = np.ascontiguousarray(seen.faces[:, ::-1])
            self._normals = -self._normals
        self._nearest = scipy.spatial.cKDTree(self.positions)

    @property
    def positions(self) -> Floats64:
        """Vertices in the picture's space, shape (V, 3)."""
        return self.seen_mesh.positions

    def turn(self, rotation: Floats64) -> None:
        """Turn the mesh by a matrix (3, 3), before the marks show the upward direction."""
        now = self.placing
        self._place(Similarity(now.scale, rotation @ now.rotation, rotation @ now.shift))
        self._note()

    @property
    def is_upright(self) -> bool:
        """Whether the marks have turned the mesh upright."""
        return self.placing is self._upright

    def _make_upright(self, known: Mapping[int, MeshPoint]) -> None:
        """Turn the mesh upright and scale it, once; raises AssetError if no face fits the marks."""
        upright = placing(known)
        if not self.is_upright:
            self._upright = upright
            self._place(upright)
            self.current = MARKING_ORDER[0]

    def seen(self, numbers: Iterable[int]) -> tuple[Floats64, Floats64]:
        """Return the marked points in the picture's space, (n, 3), and normals of the skin.

        The normals, (n, k, 3), are those of the k vertices nearest to each point.
        """
        chosen = list(numbers)
        places = [self.marks.places[number] for number in chosen]
        points = self.placing.points(np.reshape(places, (-1, 3)))
        # Take several vertices, because the nearest one may face sideways behind a lid's edge.
        neighbour_count = 4
        nearest = range(1, min(neighbour_count, len(self.positions)) + 1)
        normals = self._normals[self._nearest.query(points, nearest)[1]]
        if self.is_upright:  # inner lips face up or down, but are visible from ahead
            normals[[number in INNER_LIP_LANDMARKS for number in chosen]] = (0.0, 0.0, 1.0)
        return points, normals

    # Changes of the marks

    def place(self, number: int, point: Floats64) -> None:
        """Place a landmark at a visible point of the mesh; `note` completes the change."""
        self.marks = self.marks.placed(number, self.placing.inverse.points(point))

    def note(self) -> Message:
        """Note a complete change for undo; guess the other marks if possible."""
        can_guess = self.marks.next_landmark is None and not self.marks.is_complete
        try:
            return self.guess() if can_guess else None
        finally:  # wrong marks stay, so that users can correct them
            self._note()

    def _note(self) -> None:
        self.history.note((self.marks, self.placing))
        self.undo(0)

    def guess(self) -> Message:
        """Guess all marks that no user placed; raises UserError if the placed marks fit no face."""
        with _for_users(cure="; drag points, or undo"):
            found = guess(self.mesh, self.marks.by_hand)
        self._make_upright(self.marks.by_hand)
        self.marks = self.marks.with_guessed(found)
        self._note()
        return "All points are guessed; drag wrong points to their place"

    def step(self, step: int) -> None:
        """Go to the next landmark in the order of marking, or with -1 to the previous landmark."""
        self.current = MARKING_ORDER[
            (MARKING_ORDER.index(self.current) + step) % len(MARKING_ORDER)
        ]

    def undo(self, changes: int = 1) -> None:
        """Undo this many changes, including turns of the mesh; -1 redoes one change."""
        self.marks, placing = self.history.restore(self.history.place - changes)
        if placing is not self.placing:
            self._place(placing)
        asked = self.marks.next_landmark
        self.current = self.current if asked is None else asked

    # Files

    @property
    def unsaved(self) -> str:
        """The unsaved work in words; "" for none."""
        return "" if self.marks == self._saved else f"the landmarks of {self.path.name}"

    def open(self, path: Path) -> Message:
        """Continue with the marks of a file; raises UserError for marks of another mesh."""
        with _for_users():
            places, guessed = read_marks(path, self.mesh)
        marks = Marks({})
        for number, place in places.items():
            marks = marks.placed(number, place)
        if marks.is_complete:
            with _for_users(f"{path.name}: "):
                self._make_upright(marks.places)
        self.marks = self._saved = Marks(marks.places, guessed)
        self.file = path
        return self.note() or f"{path.name}: {len(places)} landmarks"

    def ask_open(self) -> None:
        """Ask for a landmark file, and continue with it."""
        self._files.open(
            "Open landmarks", self.open, saving=False, suffixes=(self.LANDMARKS_SUFFIX,)
        )

    def save(self, then: Task = lambda: None) -> Message:
        """Write the existing marks to their file, or ask for a file first."""
        if self.file is not None:
            return self._write(then, self.file)
        proposed = str(self.path.with_suffix(self.LANDMARKS_SUFFIX).absolute())
        write = partial(self._write, then)
        ask = partial(self._files.open, "Save landmarks", write, saving=True)
        ask(proposed=proposed, suffixes=(self.LANDMARKS_SUFFIX,))
        return None

    def _write(self, then: Task, path: Path) -> Message:
        save_text(path, landmarks_text(self.marks.places, self.marks.guessed))
        self.file = path
        self._saved = self.marks
        rest = "" if self.marks.is_complete else "; the others can be marked another time"
        return then() or f"{path}: {len(self.marks.places)} landmarks written{rest}"


@contextlib.contextmanager
def _for_users(subject: str = "", cure: str = "") -> Iterator[None]:
    """Turn an AssetError of the block into a UserError, because users can correct its cause."""
    try:
        yield
    except AssetError as error:
        raise UserError(f"{subject}{error}{cure}") from None
