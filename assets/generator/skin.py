"""One half of the skin from rows, anchors and infill; then its mirror image.

Result: one manifold, consistently oriented piece with four boundary loops (rim, two eyes, mouth).
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from ..topology import Faces, halved, quads_between
from .anchors import (
    FOLD_ON_CREASE,
    MIDLINE_ABOVE_MOUTH,
    MIDLINE_BELOW_MOUTH,
    alar_crease,
    lateral_anchors,
    midline_anchors,
    nasolabial_fold,
    neck_rows,
)
from .ear_rows import COLUMNS as EAR_COLUMNS
from .ear_rows import ear_root, ear_rows, face_count, floor_faces, merged_columns
from .eye_rows import eye_rows
from .fields import Points
from .form import broadened
from .infill import Domain, throw_darts, triangulate, wanted_length
from .mouth_rows import mouth_rows
from .nostril_rows import nostril_cap, nostril_ring
from .outline import crown_curve, midline_curve, resampled, rim_curve
from .remesh import Freedom, InfillMesh, remesh

TARGET_HALF = 1015  # faces; the paper's face has 2030 triangles (Table 1)
SCALE = 1.4  # of the wanted edge lengths; chosen: the infill ends a little above what it is cut to
SEED = 62  # chosen among a few for the largest smallest angle
RIM_SCALE, CROWN_SCALE = 0.50, 0.62  # rim and crown are seen as an outline: finer


@dataclass
class SkinMesh:
    """A mesh with names.

    vertices: [mm], shape (V, 3).
    faces: shape (F, 3).
    names: single vertices of the left half and the mid-plane.
    rings: rows of vertices of the left half.
    mirror: number of each vertex' mirror image, shape (V,); set by `mirrored`.
    """

    vertices: Points
    faces: Faces
    names: dict[str, int]
    rings: dict[str, list[int]]
    mirror: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, dtype=np.int32))


class PointList:
    """Points that are numbered as they come."""

    def __init__(self) -> None:
        self.points: list[Points] = []
        self.freedom: list[Freedom] = []

    def add(self, points: Points, freedom: Freedom = Freedom.FIXED) -> list[int]:
        """Append points of one kind and return their numbers."""
        start = len(self.points)
        self.points.extend(np.asarray(points, dtype=np.float64))
        self.freedom.extend([freedom] * len(points))
        return list(range(start, start + len(points)))


def _midline(
    book: PointList, curve: Points, anchors: dict[str, Points], scale: float
) -> tuple[list[int], dict[str, int]]:
    """Vertices along a mid-plane curve without its ends; anchors are fixed, the rest may slide."""
    stops = {
        name: int(np.argmin(np.linalg.norm(curve - point, axis=1)))
        for name, point in anchors.items()
    }
    is_crown = (curve[:, 1] > 60.0) & (curve[:, 2] < 70.0)
    size = wanted_length(curve) * scale * np.where(is_crown, CROWN_SCALE, 1.0)
    numbers: list[int] = []
    named: dict[str, int] = {}
    ordered = [("", 0), *sorted(stops.items(), key=lambda item: item[1]), ("", len(curve) - 1)]
    for (_, start), (name, stop) in pairwise(ordered):
        between = resampled(curve[start : stop + 1], size[start : stop + 1])[1:-1]
        numbers += book.add(between, Freedom.MIDLINE)
        if name:
            named[name] = book.add(anchors[name][None])[0]
            numbers.append(named[name])
    return numbers, named


def _border(
    book: PointList, mouth: list[int], scale: float
) -> tuple[list[int], list[int], dict[str, int]]:
    """The outline of the infill and the rim: crown, front profile, mouth, throat, rim."""
    rim_dense = rim_curve()
    rim = book.add(resampled(rim_dense, wanted_length(rim_dense) * scale * RIM_SCALE))
    upper_end, lower_end = book.points[mouth[0]], book.points[mouth[-1]]

    profile = midline_curve(148.5, float(upper_end[1]))
    above = np.vstack([crown_curve(book.points[rim[0]])[::-1], profile, upper_end[None]])
    below = np.vstack([lower_end[None], midline_curve(float(lower_end[1]), -159.5)[1:]])
    below[-1] = book.points[rim[-1]]
    upper, upper_names = _midline(book, above, midline_anchors(MIDLINE_ABOVE_MOUTH), scale)
    lower, lower_names = _midline(book, below, midline_anchors(MIDLINE_BELOW_MOUTH), scale)
    outline = [rim[0], *upper, *mouth, *lower, *rim[:0:-1]]
    return outline, rim, upper_names | lower_names


def build_half(*, scale: float = SCALE, seed: int = SEED, target: int = TARGET_HALF) -> SkinMesh:
    """Build the left half: the infill first, then the rows that hang on it."""
    eye, mouth, ring = eye_rows(), mouth_rows(), nostril_ring()
    book = PointList()
    eye_outer, mouth_outer = book.add(eye[-1]), book.add(mouth[-1])
    nostril, ear = book.add(ring), book.add(ear_root())
    outline, rim, names = _border(book, mouth_outer, scale)
    crease = book.add(alar_crease())
    fold = [crease[FOLD_ON_CREASE], *book.add(nasolabial_fold())]
    neck = [book.add(row) for row in neck_rows()]
    anchors = lateral_anchors()
    names |= dict(zip(anchors, book.add(np.array(list(anchors.values()))), strict=True))
    names["alar_base"] = crease[-1]

    holes, chains = [eye_outer, nostril, ear], [crease, fold, *neck]
    domain = Domain(np.array(book.points), outline, holes, chains)
    points, faces = triangulate(domain, throw_darts(domain, scale=scale, seed=seed))
    freedom = np.full(len(points), Freedom.FREE, dtype=np.int8)
    freedom[: len(book.freedom)] = book.freedom
    mesh = InfillMesh(points, faces, freedom, domain.locked_edges())
    mesh.locked = {edge for edge in mesh.locked if not _on_midline(mesh, edge)}

    row_faces = 4 * 2 * len(eye_outer) + 7 * 2 * (len(mouth_outer) - 1) + 3 * len(nostril)
    row_faces += face_count()
    remesh(mesh, scale=scale, target_faces=target - row_faces)
    rings = {"rim": rim, "alar_crease": crease, "nasolabial_fold": fold}
    rings |= {f"neck_{n}": row for n, row in enumerate(neck)}
    half = SkinMesh(broadened(mesh.vertices), mesh.faces, names, rings)
    _hang_rows(half, "eye", eye, eye_outer, closed=True)
    _hang_rows(half, "mouth", mouth, mouth_outer, closed=False)
    _close_nostril(half, nostril)
    _hang_ear(half, ear)
    return _compressed(half)


def _on_midline(mesh: InfillMesh, edge: tuple[int, int]) -> bool:
    return not mesh.vertices[list(edge), 0].any() and bool(
        (mesh.freedom[list(edge)] == Freedom.MIDLINE).any()
    )


def _append(half: SkinMesh, points: Points) -> list[int]:
    start = len(half.vertices)
    half.vertices = np.vstack([half.vertices, points])
    return list(range(start, start + len(points)))


def _hang_rows(
    half: SkinMesh, title: str, rows: list[Points], outer: list[int], *, closed: bool
) -> None:
    """Add all rows but the outer one, which the infill has, and the quadrilaterals between them."""
    numbered = [_append(half, row) for row in rows[:-1]] + [outer]
    quads = quads_between(numbered, closed=closed)
    _join(half, halved(half.vertices, quads), (outer[0], outer[1]))
    half.rings |= {f"{title}_{i}": row for i, row in enumerate(numbered)}


def _join(half: SkinMesh, faces: Faces, outer_edge: tuple[int, int]) -> None:
    """Append faces, turned so that they run along the outer edge against the infill."""

    def runs_along(triangles: Faces) -> bool:
        """Whether one of them runs along the outer edge in its direction."""
        turned = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
        return bool((turned == outer_edge).all(axis=1).any())

    if runs_along(half.faces) == runs_along(faces):
        faces = faces[:, ::-1]
    half.faces = np.vstack([half.faces, faces]).astype(np.int32)


def _close_nostril(half: SkinMesh, ring: list[int]) -> None:
    inner, end = nostril_cap(half.vertices[ring])
    rows = [ring, _append(half, inner)]
    centre = _append(half, end[None])[0]
    quads = quads_between(rows, closed=True)
    last = rows[-1]
    fan = [[a, centre, b] for a, b in zip(last, last[1:] + last[:1], strict=True)]
    faces = np.vstack([halved(half.vertices, quads), np.array(fan, dtype=np.int32)])
    _join(half, faces, (ring[0], ring[1]))
    half.rings["nostril"] = ring
    half.names["nostril_roof"] = centre


def _hang_ear(half: SkinMesh, root: list[int]) -> None:
    """Add the ear to its root; where a row falls onto the one before, quads become triangles."""
    points, floor = ear_rows()
    rows = [root]
    for row, merged in zip(points, merged_columns(), strict=True):
        own = [column for column in range(EAR_COLUMNS) if column not in merged]
        numbers = list(rows[-1])
        for column, number in zip(own, _append(half, row[own]), strict=True):
            numbers[column] = number
        rows.append(numbers)
    quads = quads_between(rows, closed=True)
    upper, lower = _append(half, floor)
    whole = halved(half.vertices, [quad for quad in quads if len(set(quad)) == 4])
    corners = [list(dict.fromkeys(quad)) for quad in quads if len(set(quad)) == 3]
    closing = corners + floor_faces(rows[-1], upper, lower)
    faces = np.vstack([whole, np.array(closing, dtype=np.int32)])
    _join(half, faces, (root[3], root[4]))
    half.rings |= {f"ear_{i}": row for i, row in enumerate(rows)}
    half.rings["concha"] = [upper, lower]


def _compressed(half: SkinMesh) -> SkinMesh:
    """Drop vertices that no face uses any more."""
    used = np.unique(half.faces)
    number = np.full(len(half.vertices), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    names = {name: int(number[vertex]) for name, vertex in half.names.items()}
    rings = {name: number[row].tolist() for name, row in half.rings.items()}
    return SkinMesh(half.vertices[used], number[half.faces], names, rings)


def mirrored(half: SkinMesh) -> SkinMesh:
    """The whole skin: the left half, then the right one; vertices with x = 0 are shared."""
    count = len(half.vertices)
    beside = np.flatnonzero(half.vertices[:, 0] != 0.0)
    image = np.arange(count, dtype=np.int32)
    image[beside] = count + np.arange(len(beside))
    vertices = np.vstack([half.vertices, half.vertices[beside] * [-1.0, 1.0, 1.0]])
    faces = np.vstack([half.faces, image[half.faces][:, ::-1]]).astype(np.int32)
    mirror = np.concatenate([image, beside]).astype(np.int32)
    return SkinMesh(vertices, faces, half.names, half.rings, mirror)
