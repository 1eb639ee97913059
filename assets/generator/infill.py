"""The irregular mesh between the rows of vertices: darts on the surface and their triangulation.

The infill is laid out flat as seen from inside the head, stereographically from the opening of the
neck: so every point is seen exactly once, the underside of the nose and the back of the head
included, and no angle is distorted. The triangulation is only a start: `remesh` works on it in
space.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import scipy

from risorius.geometry.normals import cross_products

from ..topology import Edge, Faces, edge_faces, edge_key
from .fields import Points, Values, smooth_step, unit
from .form import from_axis, from_below, from_front

VIEWPOINT = np.array([0.0, 10.0, 15.0])  # [mm]; sees the underside of nose and chin
NECK_DEG = 5.0  # from straight down backward: the middle of the neck's opening as seen from there
DART_RADIUS = 0.80  # of the wanted edge length; chosen: leaves few gaps and few crowds
ROW_RADIUS = 0.70  # distance of darts from rows, likewise

# Wanted edge length [mm]: centre (x, y, z), radius within which it holds, length, growth per mm.
SIZES = (
    ((31, 1, 78), 18.5, 5.4, 0.12),
    ((10, -67, 100), 22.0, 5.2, 0.14),
    ((30, -46, 90), 12.0, 5.8, 0.12),
    ((40, -28, 84), 12.0, 7.0, 0.12),
    ((0, -36, 110), 9.0, 2.7, 0.24),
    ((12.5, -38, 103), 7.5, 2.4, 0.28),
    ((6.7, -45, 105), 5.0, 3.2, 0.30),
    ((4.0, -47.2, 102), 4.5, 3.0, 0.30),
    ((12.5, -46.5, 100), 3.5, 3.0, 0.30),
    ((0, -8, 98), 10.0, 5.6, 0.16),
    ((30, 17, 88), 18.0, 4.4, 0.16),
    ((41, 15.5, 84), 7.0, 3.0, 0.24),
    ((10, 14, 92), 8.0, 4.2, 0.20),
    ((0, -100, 92), 18.0, 4.8, 0.16),
    ((69, -10, -12), 20.0, 8.0, 0.32),
    ((69, -38, -4), 9.0, 6.6, 0.32),
    ((33, -112, 46), 14.0, 12.0, 0.30),
    ((20, -140, 42), 14.0, 12.0, 0.35),
)
LARGEST_IN_FACE, LARGEST_BEHIND, LARGEST_FAR_BEHIND = 13.0, 25.0, 32.0  # [mm]
LARGEST_ON_CROWN = 12.9  # [mm] the crown is an outline from every side


def wanted_length(points: Points) -> Values:
    """Edge length that the mesh should have near the points [mm], before scaling, shape (n,)."""
    half = np.column_stack([np.abs(points[:, 0]), points[:, 1], points[:, 2]])
    back = np.clip((60.0 - points[:, 2]) / 70.0, 0.0, 1.0)
    high = smooth_step(10.0, 52.0, points[:, 1])
    far = np.clip((5.0 - points[:, 2]) / 50.0, 0.0, 1.0)
    low = np.clip((-112.0 - points[:, 1]) / 25.0, 0.0, 1.0)
    beyond = np.maximum(back, low)
    result = LARGEST_IN_FACE + (LARGEST_BEHIND - LARGEST_IN_FACE) * beyond
    result = result + (LARGEST_FAR_BEHIND - LARGEST_BEHIND) * far
    result = result + (LARGEST_ON_CROWN - result) * high
    for centre, radius, length, growth in SIZES:
        away = np.linalg.norm(half - np.array(centre), axis=1) - radius
        result = np.minimum(result, length + growth * np.maximum(away, 0.0))
    return result


def layout(points: Points) -> npt.NDArray[np.float64]:
    """Flat coordinates of surface points, shape (n, 2)."""
    direction = unit(points - VIEWPOINT)
    cosine, sine = np.cos(np.radians(NECK_DEG)), np.sin(np.radians(NECK_DEG))
    up = direction @ [0.0, cosine, sine]
    back = direction @ [0.0, sine, -cosine]
    flat = np.stack([direction[:, 0], back], axis=1) * (100.0 / (1.0 + up))[:, None]
    return np.asarray(flat, dtype=np.float64)


def inside_polygon(
    points: npt.NDArray[np.float64], polygon: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Even-odd test of flat points against a closed polygon, shape (n,), bool."""
    inside = np.zeros(len(points), dtype=bool)
    for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if ay != by:
            crosses = (ay > points[:, 1]) != (by > points[:, 1])
            inside ^= crosses & (points[:, 0] < (bx - ax) * (points[:, 1] - ay) / (by - ay) + ax)
    return inside


@dataclass
class Domain:
    """What the infill must respect.

    points: all given points, shape (n, 3).
    outline: numbers of the points around the infill.
    holes: numbers of the points around each hole.
    chains: rows of points whose edges must be in the mesh.
    """

    points: Points
    outline: list[int]
    holes: list[list[int]]
    chains: list[list[int]]

    def locked_edges(self) -> set[Edge]:
        """Edges that must exist: around outline and holes, and along chains."""
        edges = set()
        for ring in (self.outline, *self.holes):
            edges |= {edge_key(a, b) for a, b in zip(ring, ring[1:] + ring[:1], strict=True)}
        for chain in self.chains:
            edges |= {edge_key(a, b) for a, b in pairwise(chain)}
        return edges

    def contains(self, flat: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Which flat points lie in the outline and in no hole."""
        corners = layout(self.points)
        inside = inside_polygon(flat, corners[self.outline])
        for hole in self.holes:
            inside &= ~inside_polygon(flat, corners[hole])
        return inside


def _candidates(random: np.random.Generator) -> Points:
    """Points all over the half face, from three sides so that no part is hidden."""
    angle = random.uniform(0.0, np.radians(180), 20000)
    height = random.uniform(-160.0, 149.0, 20000)
    nose_x, nose_y = random.uniform(0, 22, 4000), random.uniform(-48, 0, 4000)
    under_x, under_z = random.uniform(0, 17, 2500), random.uniform(98, 122, 2500)
    below = from_below(under_x, under_z)
    below = below[below[:, 1] < -30.5]
    return np.vstack([from_axis(angle, height), from_front(nose_x, nose_y), below])


def throw_darts(domain: Domain, *, scale: float, seed: int) -> Points:
    """Random points that keep the wanted distance from each other and from all given points."""
    random = np.random.default_rng(seed)
    points = _candidates(random)
    points = points[domain.contains(layout(points))]
    length = wanted_length(points) * scale
    clear = scipy.spatial.cKDTree(domain.points).query(points)[0] > ROW_RADIUS * length
    points, length = points[clear], length[clear]
    tree = scipy.spatial.cKDTree(points)
    alive = np.ones(len(points), dtype=bool)
    chosen = []
    for index in random.permutation(len(points)):
        if alive[index]:
            chosen.append(index)
            alive[tree.query_ball_point(points[index], DART_RADIUS * length[index])] = False
    darts: Points = points[chosen]
    return darts


def triangulate(domain: Domain, darts: Points) -> tuple[Points, Faces]:
    """Join the given points and the darts; every locked edge is in the result.

    Raises RuntimeError if a locked edge cannot be had: then rows cross each other in the layout.
    """
    points = np.vstack([domain.points, darts])
    flat = layout(points)
    faces = scipy.spatial.Delaunay(flat).simplices.astype(np.int32)
    faces = _counter_clockwise(flat, faces)
    faces = _recover_edges(flat, faces, domain.locked_edges())
    return points, faces[domain.contains(flat[faces].mean(axis=1))]


def _counter_clockwise(flat: npt.NDArray[np.float64], faces: Faces) -> Faces:
    area = cross_products(np.column_stack([flat, np.zeros(len(flat))]), faces)[:, 2]
    faces = np.where(area[:, None] > 0, faces, faces[:, ::-1])
    return faces[np.abs(area) > 1e-9]


def _side(flat: npt.NDArray[np.float64], a: int, b: int, c: int) -> float:
    ab, ac = flat[b] - flat[a], flat[c] - flat[a]
    return float(ab[0] * ac[1] - ab[1] * ac[0])


def _recover_edges(flat: npt.NDArray[np.float64], faces: Faces, wanted: set[Edge]) -> Faces:
    """Flip the edges that cross a missing one until it appears (Sloan 1993)."""
    triangles = faces.tolist()
    for a, b in sorted(wanted):
        for _ in range(60):
            beside = edge_faces(np.array(triangles, dtype=np.int32))
            if (a, b) in beside:
                break
            if not _flip_one_crossing(flat, triangles, beside, a, b):
                raise RuntimeError(f"edge {a}-{b} at {flat[a]} to {flat[b]} cannot be inserted")
        else:
            raise RuntimeError(f"edge {a}-{b} at {flat[a]} to {flat[b]} cannot be inserted")
    return np.array(triangles, dtype=np.int32)


def _flip_one_crossing(
    flat: npt.NDArray[np.float64],
    triangles: list[list[int]],
    beside: dict[Edge, list[int]],
    a: int,
    b: int,
) -> bool:
    crossing = []
    for (p, q), pair in beside.items():
        if len(pair) != 2 or {p, q} & {a, b}:
            continue
        if _side(flat, a, b, p) * _side(flat, a, b, q) >= 0:
            continue
        if _side(flat, p, q, a) * _side(flat, p, q, b) >= 0:
            continue
        r = next(v for v in triangles[pair[0]] if v not in (p, q))
        s = next(v for v in triangles[pair[1]] if v not in (p, q))
        if _side(flat, r, s, p) * _side(flat, r, s, q) < 0:
            still_crosses = not ({r, s} & {a, b}) and (
                _side(flat, a, b, r) * _side(flat, a, b, s) < 0
            )
            crossing.append((still_crosses, p, q, r, s, pair))
    if not crossing:
        return False
    _, p, q, r, s, pair = min(crossing)
    for index, corners in zip(pair, ([r, s, p], [r, s, q]), strict=True):
        if _side(flat, *corners) < 0:
            corners.reverse()
        triangles[index] = corners
    return True
