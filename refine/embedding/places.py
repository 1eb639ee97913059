"""The points of a smooth surface at rest to which the vertices of a fine mesh are bound.

The search begins with the nearest place on the flat triangles. From there the place p moves over
the surface until the fine point x lies on the interpolated normal: x = p + h n, with p on the cubic
patch and n the mean of the vertex normals at p. Newton's method finds p; a step that leaves a patch
continues in the patch beyond the edge. Interpolated normals are continuous across edges, so
neighbouring points of the fine mesh have neighbouring places (Panozzo, Baran, Diamanti,
Sorkine-Hornung 2013, "Weighted averages on surfaces", who call it Phong projection). Some points,
such as points beyond a border, lie on the normal of no place. They keep the best place that was
found, and the vector from there.
"""

import numpy as np

from ...geometry.arrays import Flags, Floats64, Integers64, Unsigned32
from ...geometry.closest import closest_points
from ...geometry.normals import cross_products
from ...geometry.vectors import Vector, dot, less, plus, row_of, times
from ...jit import njit
from ..mesh.connectivity import Connectivity
from ..mesh.threads import parallel_for
from .frames import unit_of
from .patches import SmoothSurface, place_on

WRONG_SIDE = 10.0
"""Distance, in mean edge lengths, that is added for a triangle that faces the other way."""
MOST_NEWTON_STEPS = 16
"""Most steps of Newton's method; four are enough on most surfaces."""
FARTHEST_RATIO = 1.25
"""Largest distance of a place, relative to the distance of the nearest place. Chosen: the place
with the point on its normal is rarely the nearest place, but a place much farther away belongs to
another part of the surface.
"""
ROUNDING_LIMIT = 1e-14
"""Steps in barycentric coordinates, and squared sines of angles, below this count as zero."""
INSIDE_RESULT = 3
STUCK_RESULT = 4
"""Results of a step that does not cross the edge opposite of corner 0, 1 or 2."""
UPRIGHT_SINE = 1e-12
"""Largest part of the vector to the point across the normal, relative to its length."""


def nearest_places(
    points: Floats64,
    normals: Floats64 | None,
    rest: Floats64,
    faces: Integers64,
    groups: list[tuple[Integers64, Integers64]],
) -> tuple[Integers64, Floats64]:
    """Return the nearest places on flat triangles: triangle indices (N,), barycentric (N, 3).

    `groups`: pairs of point indices and the triangles that are allowed for them.
    """
    triangles = np.zeros(len(points), dtype=np.int64)
    weights = np.zeros((len(points), 3))
    edges = rest[faces[:, [1, 2, 0]]] - rest[faces]
    away = WRONG_SIDE * float(np.linalg.norm(edges, axis=2).mean())
    for members, allowed in groups:
        directions = None if normals is None else normals[members]
        found = closest_points(points[members], rest, faces[allowed], directions, away)
        triangles[members] = allowed[found.triangles]
        weights[members] = found.weights
    return triangles, weights


def has_area(rest: Floats64, faces: Integers64, sliver: float) -> Flags:
    """Flag triangles that have a normal, shape (F,)."""
    areas = np.linalg.norm(cross_products(rest, faces), axis=1)
    edges = rest[faces[:, [1, 2, 0]]] - rest[faces]
    longest = np.linalg.norm(edges, axis=2).max(axis=1, initial=0.0)
    return np.asarray(areas > sliver * longest**2)


def across_edges(mesh: Connectivity, label: Integers64) -> Integers64:
    """Return for each side of a triangle the side of its neighbour, (F, 3); -1 for no neighbour.

    Side i of triangle t has the number 4 t + i.

    Only edges inside the mesh count, between triangles with the same `label`, shape (F,); -1: no
    label.
    """
    across = np.full(mesh.faces.shape, -1, dtype=np.int64)
    edges = np.flatnonzero(mesh.around.is_interior)
    first, second = mesh.edge_sides[edges].astype(np.int64).T
    is_one = (label[first >> 2] == label[second >> 2]) & (label[first >> 2] >= 0)
    first = first[is_one]
    second = second[is_one]
    across[first >> 2, first & 3] = second
    across[second >> 2, second & 3] = first
    return across


def settle(
    points: Floats64,
    surface: SmoothSurface,
    across: Integers64,
    triangles: Integers64,
    weights: Floats64,
) -> None:
    """Move places, (N,) and (N, 3), until points, shape (N, 3), lie on their normals."""
    given = surface.rows, surface.normals, surface.sectors, across
    parallel_for(slide, len(points), points, *given, triangles, weights)


@njit
def slide(
    first: int,
    last: int,
    points: Floats64,
    rows: Floats64,
    normals: Floats64,
    sectors: Unsigned32,
    across: Integers64,
    triangles: Integers64,
    weights: Floats64,
) -> None:
    """Slide the places of some points (see `settle`)."""
    place = np.zeros(3)
    best = np.zeros(3)
    columns = np.zeros((3, 3))
    for k in range(first, last):
        point = row_of(points, k)
        t = triangles[k]
        best_t = t
        place[:] = weights[k]
        best[:] = place
        least = farthest = np.inf
        for _ in range(MOST_NEWTON_STEPS):
            apart, aside = linearise(point, rows, normals, sectors, t, place, columns)
            size = dot(aside, aside)
            if farthest == np.inf:
                farthest = FARTHEST_RATIO * apart
            if size < least and apart <= farthest:
                least = size
                best_t = t
                best[:] = place
            if size <= (UPRIGHT_SINE * apart) ** 2:
                break
            hit = advance(aside, columns, across, t, place)
            if hit == STUCK_RESULT:
                break
            if hit != INSIDE_RESULT:
                t = cross_edge(across, t, hit, place)
        triangles[k] = best_t
        weights[k] = best


@njit
def linearise(
    point: Vector,
    rows: Floats64,
    normals: Floats64,
    sectors: Unsigned32,
    t: int,
    place: Floats64,
    columns: Floats64,
) -> tuple[float, Vector]:
    """Return the distance of a point from a place on patch t, and its part across the normal.

    `columns`: decrease of this part with each barycentric coordinate, rows of (3, 3), written.
    """
    u = place[0]
    v = place[1]
    w = place[2]
    away = less(point, 1.0, place_on(rows, t, u, v, w))
    mean = 0.0, 0.0, 0.0
    for i in range(3):
        mean = plus(mean, times(place[i], row_of(normals, sectors[t, i])))
    length = np.sqrt(dot(mean, mean))
    normal = unit_of(mean)
    height = dot(away, normal)
    for i in range(3):
        along = slope(rows, t, u, v, w, i)
        if length > 0.0:
            along = plus(along, times(height / length, row_of(normals, sectors[t, i])))
        along = less(along, dot(along, normal), normal)
        for j in range(3):
            columns[i, j] = along[j]
    return np.sqrt(dot(away, away)), less(away, height, normal)


@njit
def slope(rows: Floats64, t: int, u: float, v: float, w: float, i: int) -> Vector:
    """Return the derivative of a place on patch t by its coordinate i, with the others fixed."""
    place = (u, v, w)
    j = (i + 1) % 3
    k = (i + 2) % 3
    own = place[i]
    second = place[j]
    third = place[k]
    # Control points of the patch, in the order of patches.CONTROL_POINT_COUNT.
    corner = row_of(rows, t, 3 * i)
    toward_j = row_of(rows, t, 9 + 6 * i)
    toward_k = row_of(rows, t, 12 + 6 * i)
    from_j = row_of(rows, t, 12 + 6 * j)
    from_k = row_of(rows, t, 9 + 6 * k)
    middle = row_of(rows, t, 27)
    total = times(3.0 * own * own, corner)
    total = plus(total, times(6.0 * own * second, toward_j))
    total = plus(total, times(6.0 * own * third, toward_k))
    total = plus(total, times(3.0 * second * second, from_j))
    total = plus(total, times(3.0 * third * third, from_k))
    return plus(total, times(6.0 * second * third, middle))


@njit
def advance(aside: Vector, columns: Floats64, across: Integers64, t: int, place: Floats64) -> int:
    """Move a place on patch t by one step of Newton's method, up to the patch's edge.

    Returns INSIDE_RESULT, STUCK_RESULT, or the corner opposite of the edge that must be crossed.
    """
    step = newton_step(aside, columns)
    for m in range(3):
        if place[m] <= 0.0 and step[m] < 0.0 and across[t, (m + 1) % 3] < 0:
            step = step_along(aside, columns, (m + 1) % 3, (m + 2) % 3)
    fraction = 1.0
    hit = INSIDE_RESULT
    for m in range(3):
        if step[m] < 0.0 and place[m] + fraction * step[m] < 0.0:
            fraction = max(place[m], 0.0) / -step[m]
            hit = m
    moved = 0.0
    for m in range(3):
        place[m] += fraction * step[m]
        moved += fraction * abs(step[m])
    if hit == INSIDE_RESULT:
        return INSIDE_RESULT if moved > ROUNDING_LIMIT else STUCK_RESULT
    place[hit] = 0.0
    if across[t, (hit + 1) % 3] >= 0:
        return hit
    return INSIDE_RESULT if moved > ROUNDING_LIMIT else STUCK_RESULT


@njit
def newton_step(aside: Vector, columns: Floats64) -> Vector:
    """Return the barycentric step that minimises the remaining vector `aside` (least squares)."""
    first = less(row_of(columns, 1), 1.0, row_of(columns, 0))
    second = less(row_of(columns, 2), 1.0, row_of(columns, 0))
    a = dot(first, first)
    b = dot(first, second)
    c = dot(second, second)
    whole = a * c - b * b
    if whole <= ROUNDING_LIMIT * a * c:
        return 0.0, 0.0, 0.0
    along_first = dot(first, aside)
    along_second = dot(second, aside)
    v = (c * along_first - b * along_second) / whole
    w = (a * along_second - b * along_first) / whole
    longest = max(abs(v), abs(w), abs(v + w), 1.0)
    return -(v + w) / longest, v / longest, w / longest


@njit
def step_along(aside: Vector, columns: Floats64, i: int, j: int) -> Vector:
    """Return the step along the edge from corner i to j that minimises the remainder of `aside`."""
    edge = less(row_of(columns, j), 1.0, row_of(columns, i))
    squared = dot(edge, edge)
    size = dot(edge, aside) / squared if squared > 0.0 else 0.0
    size = min(max(size, -1.0), 1.0)
    u = -size if i == 0 else (size if j == 0 else 0.0)
    v = -size if i == 1 else (size if j == 1 else 0.0)
    w = -size if i == 2 else (size if j == 2 else 0.0)
    return u, v, w


@njit
def cross_edge(across: Integers64, t: int, hit: int, place: Floats64) -> int:
    """Carry a place across the edge opposite of corner `hit` of patch t to the next patch."""
    side = (hit + 1) % 3
    beyond = across[t, side]
    j = beyond & 3
    start = place[side]
    end = place[(side + 1) % 3]
    place[j] = end
    place[(j + 1) % 3] = start
    place[(j + 2) % 3] = 0.0
    return int(beyond >> 2)
