"""Intersections of lines and triangles.

Source: Möller, Trumbore 1997, "Fast, minimum storage ray/triangle intersection", Journal of
Graphics Tools 2:21-28.
"""

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Flags, Floats64, Integers32, Integers64
from .directions import unit_vectors
from .normals import cross_products
from .vectors import Vector, cross, dot, less, row_of, times, vector_of

PARALLEL_VOLUME = 1e-12  # below this a triangle counts as parallel to the line


def crossings(origins: Floats64, directions: Floats64, corners: Floats64) -> tuple[Floats64, ...]:
    """Intersect each line `origin + t direction` with its triangle: volume, weights u and v, and t.

    origins, directions: (n, 3) or (3,). corners: (n, 3, 3). volume: six times the volume of the
    tetrahedron of direction and triangle, above 0 if the line comes from outside; if its size is
    below PARALLEL_VOLUME, the other results are 0. The triangle is met if u, v and 1 - u - v are
    not negative. Returns four arrays (n,).
    """
    a = corners[:, 0]
    ab = corners[:, 1] - corners[:, 0]
    ac = corners[:, 2] - corners[:, 0]
    across = np.cross(directions, ac)
    from_a = origins - a
    turned = np.cross(from_a, ab)
    volume = (ab * across).sum(axis=1)
    is_met = np.abs(volume) > PARALLEL_VOLUME
    inverse = np.divide(1.0, volume, out=np.zeros_like(volume), where=is_met)
    u = (from_a * across).sum(axis=1)
    v = (turned * directions).sum(axis=1)
    return volume, u * inverse, v * inverse, (ac * turned).sum(axis=1) * inverse


@njit
def cutting(corners: Floats64, faces: Integers32, pairs: Integers64) -> Flags:
    """Flag pairs of triangles that intersect and have no common vertex, shape (k,).

    corners: shape (F, 3, 3). faces: vertex indices, shape (F, 3). pairs: shape (k, 2).
    """
    cuts = np.zeros(len(pairs), np.bool_)
    for number in range(len(pairs)):
        one, other = pairs[number]
        if _have_common_vertex(faces[one], faces[other]):
            continue
        for k in range(3):
            after = (k + 1) % 3
            if _segment_cuts(corners[one, k], corners[one, after], corners[other]):
                cuts[number] = True
                break
            if _segment_cuts(corners[other, k], corners[other, after], corners[one]):
                cuts[number] = True
                break
    return cuts


@njit
def _have_common_vertex(one: Integers32, other: Integers32) -> bool:
    """Whether two triangles have a common vertex."""
    for vertex in one:
        for twin in other:
            if vertex == twin:
                return True
    return False


@njit
def _segment_cuts(start: Floats64, end: Floats64, triangle: Floats64) -> bool:
    """Whether a segment cuts a triangle (3, 3), as `crossings` finds it."""
    margin = 1e-6  # relative; contact at a corner or an edge is not a cut
    first = vector_of(start)
    u, v, along = _crossing(first, less(vector_of(end), 1.0, first), triangle)
    is_in_triangle = u > margin and v > margin and u + v < 1.0 - margin
    return bool(is_in_triangle and margin < along < 1.0 - margin)


@njit
def _crossing(origin: Vector, direction: Vector, triangle: Floats64) -> Vector:
    """Return u, v and t of `crossings` for a line and a triangle (3, 3); -1, 0, 0 if parallel."""
    a = row_of(triangle, 0)
    ab = less(row_of(triangle, 1), 1.0, a)
    ac = less(row_of(triangle, 2), 1.0, a)
    across = cross(direction, ac)
    volume = dot(ab, across)
    if not abs(volume) > PARALLEL_VOLUME:
        return -1.0, 0.0, 0.0
    inverse = 1.0 / volume
    from_a = less(origin, 1.0, a)
    turned = cross(from_a, ab)
    return times(inverse, (dot(from_a, across), dot(turned, direction), dot(ac, turned)))


def exits(
    origin: Floats64, directions: Floats64, vertices: Floats64, faces: npt.NDArray[np.integer]
) -> tuple[npt.NDArray[np.intp], Floats64, Floats64]:
    """Find where rays from one point within a surface leave it.

    directions: unit vectors, shape (n, 3). vertices: shape (V, 3). faces: counter-clockwise seen
    from outside, shape (F, 3). Returns for each exit the index of its ray, the distance, and the
    cosine between ray and normal; a ray may leave several layers of the surface.
    """
    normals = cross_products(vertices, faces)
    corners = vertices[faces] - origin
    is_seen = (normals * corners[:, 0]).sum(axis=1) > 0.0  # the triangle's inner side
    normals = normals[is_seen]
    corners = corners[is_seen]
    axes_of_cones = unit_vectors(corners, PARALLEL_VOLUME)
    middle = axes_of_cones.sum(axis=1)
    middle = unit_vectors(middle, PARALLEL_VOLUME)
    # A triangle lies in the cone around its middle through its corners, unless the cone is blunt.
    cone = np.einsum("fik,fk->fi", axes_of_cones, middle).min(axis=1)
    cone_slack = 1e-6  # of a cosine, for rounding
    cone = np.where(cone > 0.0, cone - cone_slack, -2.0)
    met = np.empty((4 * len(directions), 2), np.int64)
    distances = np.empty(len(met))
    count = _meetings(directions, corners, middle, cone, met, distances)
    if count > len(met):  # more layers than usual
        met = np.empty((count, 2), np.int64)
        distances = np.empty(count)
        _meetings(directions, corners, middle, cone, met, distances)
    ray, face = met[:count].T
    length = np.linalg.norm(normals[face], axis=1)
    cosine = (directions[ray] * normals[face]).sum(axis=1) / length
    return ray, distances[:count], cosine


@njit
def _meetings(
    directions: Floats64,
    corners: Floats64,
    middle: Floats64,
    cone: Floats64,
    met: Integers64,
    distances: Floats64,
) -> int:
    """Count intersections of rays from the origin with triangles, as `crossings` finds them.

    middle, cone: for each triangle the axis of its cone (F, 3), and the cosine of its half angle.
    met, distances: filled up to their size with ray and triangle (k, 2), and distance (k,).
    """
    found = 0
    origin = (0.0, 0.0, 0.0)
    for ray in range(len(directions)):
        direction = row_of(directions, ray)
        for face in range(len(corners)):
            if dot(direction, row_of(middle, face)) < cone[face]:
                continue
            u, v, distance = _crossing(origin, direction, corners[face])
            if u < 0.0 or v < 0.0 or u + v > 1.0 or distance <= 0.0:
                continue
            if found < len(met):
                met[found, 0] = ray
                met[found, 1] = face
                distances[found] = distance
            found += 1
    return found
