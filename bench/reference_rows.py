"""Where the rows of the head's mesh belong on ICT-FaceKit's mean person.

Curves are taken from its mesh once: rings of vertices around the holes of eyes and mouth, and
points at nostril and wing of the nose. Numbers here are of that mesh, and were found by looking.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from risorius.assets.fitting.warp import ThinPlateSpline
from risorius.assets.model import FloatArray, Head, IndexArray
from risorius.assets.topology import boundary_loops

from .identity_space import IdentitySpace
from .registration import MIRROR, Target, Targets, neighbours

# Ring of the reference on which each row of the mouth lies: in the middle of the upper lip, of the
# lower one, and at the corner.
RINGS = (
    (1.5, 4.5, 6.8, 8.9, 11, 13, 15, 18.4),
    (1.5, 4.3, 6.4, 7.8, 9.5, 10.8, 12, 14.2),
    (5, 8.2, 11, 13, 14.15, 15.3, 16.5, 18),
)
CORNER_COLUMN, LAST_COLUMN = 19.4, 37.0  # of the reference's 38
SEAM = ((0, 1, 4, 7, 10, 13, 14), (0, 3.2, 8.8, CORNER_COLUMN, 29.5, 34.4, LAST_COLUMN))
BORDER = ((0, 1, 4, 7, 10, 12, 14), (0, 4, 10, CORNER_COLUMN, 28, 32, LAST_COLUMN))
# In our frame [mm], about: the edge of the left nostril, and the furrow around the wing.
NOSTRIL = (
    (12.2, -38.4, 107.4), (9.8, -38.3, 110.8), (6.9, -39.2, 112.2), (4.4, -41.3, 111.2),
    (3.6, -43.2, 108.0), (5.0, -43.6, 105.6), (8.0, -44.0, 104.2), (10.9, -43.5, 103.0),
    (12.8, -40.3, 105.0),
)  # fmt: skip
FURROW = (
    (18.6, -34.5, 93.0), (19.2, -37.5, 92.6), (18.9, -41.0, 92.8), (17.2, -44.0, 94.2),
    (13.5, -46.0, 97.6),
)  # fmt: skip
# [mm]; larger, and the lobe cuts into the neck of some persons.
EAR_SHIFT, EAR_SCALE = np.array([4.5, -5.0, 0.0]), np.array([0.95, 1.0, 0.92])
BRIDGE, BROWS = (27, 28, 29, 30, 33, 34, 35), (8, 22, 23, 24, 25, 26)  # landmarks
HIGHER = {27: 3.5, 28: 1.5}  # [mm]: anatomists have the nasion above where ICT-FaceKit marks it
NECK, BEHIND = -116.0, (0.0, -52.0)  # y; z, y [mm] beyond which the neck is left as it is


@dataclass(frozen=True)
class Reference(Target):
    """The symmetric mean in the head's frame [mm], and its modes, each at one deviation."""

    landmarks: IndexArray
    modes: FloatArray
    """Shape (k, V, 3)."""
    beside: dict[int, set[int]]
    """The vertices that share an edge with each."""

    @classmethod
    def of(cls, space: IdentitySpace, head: Head) -> Reference:
        """Moved so that its eyes lie where the head's do."""
        even = space.symmetric()
        eyes = slice(36, 48)
        shift = head.vertices[head.landmarks[eyes]] - even.mean[even.landmarks[eyes]]
        vertices = even.mean + shift.mean(axis=0) * [0.0, 1.0, 1.0]
        beside = neighbours(even.triangles)
        return cls(vertices, even.triangles, even.landmarks, even.modes, beside)

    def person(self, weights: FloatArray) -> Reference:
        """One person of its modes, in the same frame."""
        return replace(self, vertices=self.vertices + np.tensordot(weights, self.modes, 1))

    def around(self, marks: slice, count: int) -> list[IndexArray]:
        """Vertices by how many edges they are away from the hole that some landmarks surround."""
        middle = self.vertices[self.landmarks[marks]].mean(axis=0)
        loops = [np.array(loop) for loop in boundary_loops(self.triangles)]
        hole = min(loops, key=lambda x: float(np.linalg.norm(self.vertices[x].mean(0) - middle)))
        ring = set(hole.tolist())
        seen, found = set(ring), [np.array(sorted(ring), dtype=np.int32)]
        for _ in range(count):
            ring = {near for vertex in ring for near in self.beside[vertex]} - seen
            seen |= ring
            found.append(np.array(sorted(ring), dtype=np.int32))
        return found

    def nearest(self, point: FloatArray) -> FloatArray:
        """Its nearest vertex [mm]."""
        nearest: FloatArray = self.vertices[((self.vertices - point) ** 2).sum(axis=1).argmin()]
        return nearest


def row_targets(head: Head, reference: Reference) -> Targets:
    """Where vertices of rows and landmarks of both sides belong."""
    targets = _eye_targets(head, reference) | _mouth_targets(head, reference)
    rings = head.rings
    for row, points, weight in (("nostril", NOSTRIL, 1.0), ("alar_crease", FURROW, 0.6)):
        for number, point in zip(rings[f"{row}_left"].tolist(), points, strict=True):
            targets[number] = (reference.nearest(np.array(point)), weight)
    for group, weight in ((BRIDGE, 0.4), (BROWS, 0.15)):
        for k in group:
            place = reference.vertices[reference.landmarks[k]]
            if k in HIGHER:
                place = reference.nearest(place + np.array([0.0, HIGHER[k], 0.0])) * [0.0, 1.0, 1.0]
            targets[int(head.landmarks[k])] = (place, weight)
    targets |= {int(head.mirror[v]): (p * MIRROR, w) for v, (p, w) in targets.items()}
    rim = [*rings["rim_left"].tolist(), *rings["rim_right"].tolist()]
    return targets | {v: (head.vertices[v], 2.0) for v in rim}


def warped(head: Head, reference: Reference) -> FloatArray:
    """The head's vertices, warped by landmarks; the ears move as a whole."""
    use = [k for k in (8, *range(17, 60)) if k not in (31, 32, 34, 35)]
    source = [head.vertices[head.landmarks[use]]]
    target = [reference.vertices[reference.landmarks[use]]]
    rows = [head.rings[f"ear_{row}_left"] for row in range(5)]
    ear = head.vertices[np.unique(np.concatenate([*rows, head.rings["concha_left"]]))]
    middle = head.vertices[rows[0]].mean(axis=0)
    source.append(ear)
    target.append(middle + EAR_SHIFT + EAR_SCALE * (ear - middle))
    places = [head.anatomy[f"{n}_left"] for n in ("zygion", "gonion", "temple")]
    side = head.vertices[[*places, head.anatomy["frontotemporale_left"]]]
    source.append(side)
    target.append(np.array([reference.nearest(point) for point in side]))
    far = head.vertices
    far = far[(far[:, 1] < -135.0) | (far[:, 2] < -55.0) | (far[:, 1] > 100.0)]
    source, target = ([*x, *(y * MIRROR for y in x[1:])] for x in (source, target))
    moved = ThinPlateSpline(np.vstack([*source, far]), np.vstack([*target, far]), 1.0).points(
        head.vertices
    )
    return np.asarray(0.5 * (moved + moved[head.mirror] * MIRROR))


def free_vertices(head: Head, start: FloatArray) -> IndexArray:
    """Vertices that are drawn to the surface: no inner rows, no ears, no neck."""
    beside = neighbours(head.faces)
    names = [*(f"eye_{k}" for k in range(2)), *(f"mouth_{k}" for k in range(3))]
    names += [*(f"ear_{k}" for k in range(5)), "concha"]
    left = {int(v) for name in names for v in head.rings[f"{name}_left"]}
    root = {v for v in head.rings["ear_0_left"].tolist()}
    near = {near for v in root for near in beside[v]}
    left |= near | {v for u in near for v in beside[u]}
    roof = head.anatomy["nostril_roof_left"]
    left |= {roof} | beside[roof]
    out = np.zeros(len(start), dtype=bool)
    out[sorted(left)] = True
    out |= out[head.mirror]
    out |= (start[:, 1] < NECK) | ((start[:, 2] < BEHIND[0]) & (start[:, 1] < BEHIND[1]))
    return np.flatnonzero(~out).astype(np.int32)


def shares(curve: FloatArray) -> FloatArray:
    """How far along a curve its points lie, 0 to 1."""
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))]
    return np.asarray(length / length[-1])


def along(curve: FloatArray, places: FloatArray) -> FloatArray:
    """Points of a curve at such shares of it."""
    at = shares(curve)
    return np.stack([np.interp(places, at, curve[:, k]) for k in range(3)], axis=1)


def _lid(
    reference: Reference, ring: IndexArray, inner: FloatArray, outer: FloatArray
) -> list[FloatArray]:
    """The upper and the lower half of a ring around the left eye, from corner to corner."""
    way = outer - inner
    points = reference.vertices[ring]
    place = (points - inner) @ way / (way @ way)
    points, place = (x[(place > 0.2) & (place < 0.97)] for x in (points, place))
    is_upper = points[:, 1] > inner[1] + way[1] * place
    halves = [points[half][np.argsort(place[half])] for half in (is_upper, ~is_upper)]
    return [np.vstack([inner, half, outer]) for half in halves]


def _eye_targets(head: Head, reference: Reference) -> dict[int, tuple[FloatArray, float]]:
    """Where the vertices around the left eye belong, and how strongly they are drawn there."""
    found: dict[int, tuple[FloatArray, float]] = {}
    rings = reference.around(slice(42, 48), 8)
    en, ex = reference.vertices[reference.landmarks[[42, 45]]]

    def outermost(k: int) -> FloatArray:
        points = reference.vertices[rings[k]]
        return np.asarray(points[points[:, 0].argmax()])

    rows = (
        (1, 2, en + np.array([0.2, 0.0, -0.3]), outermost(2), 1.0),
        (2, 5, en + np.array([-1.1, 0.0, 0.3]), outermost(5), 1.0),
        (3, 6, en + np.array([-1.5, 0.0, 0.3]), ex + np.array([3.0, 0.0, -2.5]), 0.5),
        (4, 8, en + np.array([-1.5, 0.0, 0.3]), ex + np.array([3.0, 0.0, -2.5]), 0.5),
    )
    for row, k, inner, outer, weight in rows:
        ring = head.rings[f"eye_{row}_left"]
        upper, lower = np.r_[ring[:11]], np.r_[ring[10:], ring[:1]][::-1]
        for half, curve in zip(
            (upper, lower), _lid(reference, rings[k], inner, outer), strict=True
        ):
            for number, point in zip(half, along(curve, shares(head.vertices[half])), strict=True):
                column = ring.tolist().index(number) % 10
                if row < 3 or column in (4, 5, 6):
                    found[int(number)] = (point, weight)
    first, second = head.rings["eye_0_left"], head.rings["eye_1_left"]
    for inside, edge in zip(first.tolist(), second.tolist(), strict=True):
        found[inside] = (found[edge][0] + head.vertices[inside] - head.vertices[edge], 1.0)
    return found


def _lip_grid(reference: Reference) -> FloatArray:
    """Places on the left half of the lips: ring by ring outward, (20, 38, 3)."""
    grid: list[FloatArray] = []
    for ring in reference.around(slice(60, 68), 19):
        left = set(ring[reference.vertices[ring, 0] > -0.01].tolist())
        x = reference.vertices
        line = [max((v for v in left if abs(x[v, 0]) < 0.01), key=lambda v: x[v, 1])]
        while len(line) == 1 or abs(x[line[-1], 0]) > 0.01:
            ahead = [v for v in reference.beside[line[-1]] if v in left and v not in line]
            straight = 2 * x[line[-1]] - x[line[-2 if len(line) > 1 else -1]]
            line.append(min(ahead, key=lambda v: float(np.linalg.norm(x[v] - straight))))
        points = x[line]
        grid.append(points if len(grid) < 16 else along(points, shares(grid[15])))
    return np.array(grid)


def _mouth_targets(head: Head, reference: Reference) -> dict[int, tuple[FloatArray, float]]:
    """Where the vertices of the left half of the lips belong."""
    found: dict[int, tuple[FloatArray, float]] = {}
    grid = _lip_grid(reference)
    pchip = scipy.interpolate.PchipInterpolator
    seam, border = pchip(*SEAM), pchip(*BORDER)
    for row in range(8):
        for column, number in enumerate(head.rings[f"mouth_{row}_left"].tolist()):
            corner = max(0.0, 1.0 - abs(column - 7) / 3.2) ** 1.3
            ring = RINGS[0 if column < 7 else 1][row] * (1.0 - corner) + RINGS[2][row] * corner
            share = float(np.clip((row - 2) / 4.0, 0.0, 1.0))
            place = float(seam(column) * (1.0 - share) + border(column) * share)
            i, j = int(min(ring, 18)), int(min(place, 36))
            u, v = ring - i, place - j
            near, far = ((1 - v) * grid[k, j] + v * grid[k, j + 1] for k in (i, i + 1))
            point = (1 - u) * near + u * far
            if column in (0, 14):
                point[0] = 0.0
            if row < 7 or corner <= 0.15:
                found[number] = (point, 1.0 if row < 7 else 0.3)
    return found
