"""Read and write the file with the 68 landmarks of a head, and check their order.

The file is JSON and holds vertex indices or coordinates.

    {"landmarks": [1225, 1888, ...]}              vertex indices, counted from 0
    {"landmarks": [[-73.6, 36.8, 36.6], ...]}     points on the mesh, in the mesh's unit

The key may have any name, other keys are ignored, and a list without a key suffices. In an
unfinished file, missing landmarks are null. The key "guessed" lists the numbers of guessed
landmarks that the user has not moved. The order of each group of landmarks is tested, because a
wrong order would tear the face.

The test compares the given order of a group with the order q that fits the built-in group best. For
points p and template points t, the sum of p_i (t_i - t_q(i)) is about 0 if the given order is
right. A shift of the whole group does not change this sum. If the group has the order q, the sum is
about -1 times its value for p = t.

Source: Sagonas et al. 2013, "300 Faces in-the-Wild Challenge" (the order of the points).
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import scipy

from ...geometry.arrays import Floats64, Integers32
from ...geometry.mesh_graph import path_lengths, pieces_of
from ...schema import Within, parsed_json, read
from ..errors import AssetError
from ..meshes import FARTHEST_COORDINATE, Mesh
from ..user_files import named, read_file
from .mesh_validation import SkinPiece, with_seams_joined
from .warp import nearest_on

LANDMARK_COUNT = 68
LIST_KEY = "landmarks"  # key of the landmarks, if the file has several lists
GUESSED_KEY = "guessed"
FilePoint = Annotated[tuple[float, float, float], Within(-FARTHEST_COORDINATE, FARTHEST_COORDINATE)]
INNER_LIP_LANDMARKS = ((61, 62, 63), (65, 66, 67))  # upper, lower
OUTER_LIP_LANDMARKS = ((50, 51, 52), (56, 57, 58))


def read_landmarks(path: Path, mesh: Mesh) -> tuple[Integers32, Floats64 | None]:
    """Read landmarks: vertex indices (68,), int32, and points (68, 3) [unit of the mesh] or None.

    If the file has points, the indices are those of the nearest vertices. If it has indices, the
    points are None.

    Raises AssetError for a file that is missing, too long or not JSON, for another number of
    landmarks, for a vertex index out of range, and for a point off the mesh.
    """
    try:
        found = _all_in(_document(path))
        if None in found:
            raise UnfinishedError(
                f"landmark {found.index(None)} is null: {found.count(None)} of {LANDMARK_COUNT} "
                "are not marked yet; mark them in the window: `risorius view --head MESH`"
            )
        if _are_indices(found):
            indices = _indices(found, len(mesh.vertices))
            # Triangles use only one of several coinciding vertices.
            return mesh.used_vertices[indices].astype(np.int32), None
        points = _points(found)
        return _nearest(points, mesh), points
    except AssetError as error:
        raise type(error)(f"{named(path)}: {error}") from None


def read_marks(path: Path, mesh: Mesh) -> tuple[dict[int, Floats64], frozenset[int]]:
    """Read a file that may lack landmarks.

    Returns the points of the marked landmarks: number -> point (3,) [unit of the mesh]; and the
    numbers of the guessed landmarks. Raises AssetError like `read_landmarks`, except for missing
    landmarks.
    """
    try:
        document = _document(path)
        found = _all_in(document)
        marked = [number for number, entry in enumerate(found) if entry is not None]
        if not marked:
            return {}, frozenset()
        any_entry = found[marked[0]]  # stands for missing ones
        found = [any_entry if entry is None else entry for entry in found]
        are_indices = _are_indices(found)
        count = len(mesh.vertices)
        points = mesh.vertices[_indices(found, count)] if are_indices else _points(found)
        guessed = document.get(GUESSED_KEY) if isinstance(document, dict) else None
        guesses = guessed if isinstance(guessed, list) else []
        is_guessed = frozenset(number for number in marked if number in guesses)
        return {number: points[number] for number in marked}, is_guessed
    except AssetError as error:
        raise AssetError(f"{named(path)}: {error}") from None


def landmarks_text(points: Mapping[int, Sequence[float]], guessed: Iterable[int] = ()) -> str:
    """Return the text of a landmark file, with null for missing landmarks.

    points: number of the landmark -> point. guessed: numbers of guessed landmarks.
    """
    entries = [json.dumps(points.get(number)) for number in range(LANDMARK_COUNT)]
    rows = ",\n    ".join(entries)
    return f'{{\n  "{LIST_KEY}": [\n    {rows}\n  ],\n  "{GUESSED_KEY}": {sorted(guessed)}\n}}\n'


class UnfinishedError(AssetError):
    """Landmarks are missing; the user can mark them in the window."""


class MisfitError(UnfinishedError):
    """Some landmarks do not fit the head; the user can mark them anew in the window."""


def _document(path: Path) -> Any:
    content = read_file(path, kind="landmark", most=1)
    try:
        return parsed_json(content)  # in UTF-8, 16 or 32, with a byte order mark or without
    except ValueError as error:
        raise AssetError(
            f'{error}; it must be {{"{LIST_KEY}": [...]}} with {LANDMARK_COUNT} entries'
        ) from None


def _all_in(document: Any) -> list[Any]:
    """Find the 68 entries: those of LIST_KEY, the first 68 in a list, or the document."""
    entries = [document]
    if isinstance(document, dict):
        entries = [document[LIST_KEY]] if LIST_KEY in document else list(document.values())
    lists = [list[Any](each) for each in entries if isinstance(each, list)]
    lists.sort(key=lambda each: len(each) != LANDMARK_COUNT)
    if not lists or len(lists[0]) != LANDMARK_COUNT:
        has = f"{len(lists[0])} landmarks" if lists else "holds no list"
        raise AssetError(
            f'{has}; it must be {{"{LIST_KEY}": [...]}} with the {LANDMARK_COUNT} iBug points in '
            "their order, vertex indices or points [x, y, z]"
        )
    return lists[0]


def _are_indices(found: list[Any]) -> bool:
    return all(isinstance(entry, int) and not isinstance(entry, bool) for entry in found)


def _indices(found: list[Any], count: int) -> Integers32:
    vertex: Any = Annotated[int, Within(0, count - 1)]
    try:
        return np.array(_read_each(vertex, found), dtype=np.int32)
    except ValueError as error:
        raise AssetError(f"{error}: count the vertices of this mesh from 0") from None


def _points(found: list[Any]) -> Floats64:
    try:
        return np.array(_read_each(FilePoint, found))
    except ValueError as error:
        raise AssetError(
            f"{error}; all landmarks must be vertex indices, or all must be points [x, y, z] on "
            "the mesh"
        ) from None


def _read_each(kind: Any, found: list[Any]) -> list[Any]:
    """Check that all entries have one type; a ValueError names the wrong landmark, from 0."""
    named_entries = {f"landmark {place}": entry for place, entry in enumerate(found)}
    return list(read(dict[str, kind], named_entries, "").values())


def _nearest(points: Floats64, mesh: Mesh) -> Integers32:
    """Find the vertices nearest to points, (68,); a point off the mesh raises AssetError."""
    triangles, distance = _triangles_at(points, mesh, mesh.faces)
    greatest_ratio = 0.05  # greatest distance from the mesh / distance of the outer eye corners
    right_eye_corner, left_eye_corner = points[[36, 45]]
    eye_distance = float(np.linalg.norm(left_eye_corner - right_eye_corner))
    allowed = greatest_ratio * eye_distance
    off = distance > allowed
    if off.any():
        place = int(distance.argmax())
        where = (
            f"landmark {place} lies {distance[place]:.3g} units off the mesh; allowed are "
            f"{allowed:.3g} (a twentieth of the eyes' distance): "
        )
        if 2 * np.count_nonzero(off) > LANDMARK_COUNT:
            raise AssetError(f"{where}give unit and axes of the mesh")
        numbers = ", ".join(str(number) for number in np.flatnonzero(off))
        raise MisfitError(
            f"{where}the mesh has no skin there; mark {numbers} anew in the window, `risorius view "
            "--head MESH --landmarks FILE`, or give a mesh with complete lips and lids"
        )
    # Points near an eye may lie on a lash or on the eyeball, but most points lie on the skin.
    piece = pieces_of(mesh.faces, len(mesh.vertices))[mesh.faces[:, 0]]
    skin_piece = np.bincount(piece[triangles]).argmax()
    skin = mesh.faces[piece == skin_piece]
    _, from_skin = _triangles_at(points, mesh, skin)
    if from_skin.max() > allowed:
        skin = mesh.faces
    indices = nearest_vertices(points, mesh.vertices, skin)
    joined, _ = with_seams_joined(mesh.vertices, skin, indices)
    if joined is skin:
        return indices
    return nearest_vertices(points, mesh.vertices, joined)  # paths can now cross the seams


def _triangles_at(points: Floats64, mesh: Mesh, faces: Integers32) -> tuple[Any, Floats64]:
    """Find the triangles nearest to points (n, 3), and the distances, both (n,)."""
    found = nearest_on(points, np.zeros_like(points), mesh.vertices, faces)
    return found.triangles, np.linalg.norm(found.interpolate(mesh.vertices) - points, axis=1)


def nearest_vertices(points: Floats64, vertices: Floats64, faces: Integers32) -> Integers32:
    """Find the vertices (68,) that are nearest to the points of landmarks (68, 3).

    Where lips touch, the nearest vertex may belong to the other lip. So a landmark of an inner lip
    takes the nearest vertex of the same lip. A vertex belongs to the lip whose outer landmarks have
    the shorter path along the skin.
    """
    used = np.unique(faces)
    _, nearest = scipy.spatial.cKDTree(vertices[used]).query(points)
    indices: Integers32 = used[nearest].astype(np.int32)
    outer_upper, outer_lower = (indices[list(lip)] for lip in OUTER_LIP_LANDMARKS)
    to_upper = path_lengths(vertices, faces, outer_upper).min(axis=0)
    to_lower = path_lengths(vertices, faces, outer_lower).min(axis=0)
    is_of_lip = (to_upper < to_lower, to_lower < to_upper)
    for lip, is_own in zip(INNER_LIP_LANDMARKS, is_of_lip, strict=True):
        own = np.flatnonzero(is_own)
        if len(own):
            _, nearest = scipy.spatial.cKDTree(vertices[own]).query(points[list(lip)])
            indices[list(lip)] = own[nearest]
    return indices


@dataclass(frozen=True)
class LandmarkGroup:
    """A group of consecutive landmarks."""

    name: str
    first: int
    count: int
    right_order: str

    @property
    def complaint(self) -> str:
        """The error message if this group is in a wrong order."""
        return (
            f"landmarks {self.first} to {self.first + self.count - 1}, the {self.name}, are not in "
            f"their order; right is: {self.right_order} (the subject's own right and left)"
        )


LANDMARK_GROUPS = (
    LandmarkGroup("jaw line", 0, 17, "from the subject's right ear over the chin to the left ear"),
    LandmarkGroup("right brow", 17, 5, "from outside in"),
    LandmarkGroup("left brow", 22, 5, "from inside out"),
    LandmarkGroup("bridge of the nose", 27, 4, "downward"),
    LandmarkGroup("base of the nose", 31, 5, "from right to left"),
    LandmarkGroup("right eye", 36, 6, "from its outer corner over the upper lid"),
    LandmarkGroup("left eye", 42, 6, "from its inner corner over the upper lid"),
    LandmarkGroup("outer border of the lips", 48, 12, "from the right corner over the upper lip"),
    LandmarkGroup("inner border of the lips", 60, 8, "from the right corner over the upper lip"),
    LandmarkGroup(
        "two brows", 17, 10, "the right brow from outside in, then the left from inside out"
    ),
    LandmarkGroup("two eyes", 36, 12, "first the subject's right eye, then the left"),
)


def groups_in_disorder(points: Floats64, template: Floats64) -> list[LandmarkGroup]:
    """Return the groups of landmarks in a wrong order; points, template: (68, 3) [mm].

    In a closed mouth this test cannot separate the inner lips; `check_lips` does.
    """
    return [group for group in LANDMARK_GROUPS if _is_disordered(group, points, template)]


def _is_disordered(group: LandmarkGroup, points: Floats64, template: Floats64) -> bool:
    own = slice(group.first, group.first + group.count)
    given = points[own] - points[own].mean(axis=0)
    known = template[own] - template[own].mean(axis=0)
    _, best = scipy.optimize.linear_sum_assignment(given @ known.T, maximize=True)
    moved = known - known[best]
    size = 0.5 * float((moved * moved).sum())
    least_difference = 3.0  # [mm] between points in both orders; less decides nothing
    is_clear = size > 0.5 * group.count * least_difference**2
    disordered_correlation = -0.3  # clearly below 0: noise in a right order is no proof
    return is_clear and float((given * moved).sum()) < disordered_correlation * size


def check_lips(skin: SkinPiece) -> None:
    """Raise AssetError if the landmarks of each inner lip lie on the skin of the other lip."""
    inner = skin.landmarks[np.ravel(INNER_LIP_LANDMARKS)]
    paths = path_lengths(skin.vertices, skin.faces, inner)
    to_upper, to_lower = (
        paths[:, skin.landmarks[list(lip)]].min(axis=1) for lip in OUTER_LIP_LANDMARKS
    )
    is_upper = to_upper < to_lower
    if not is_upper[:3].any() and is_upper[3:].all():
        raise AssetError(LANDMARK_GROUPS[-3].complaint)
