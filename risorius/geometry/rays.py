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
    dx = end[0] - start[0]
    dy = end[1] - start[1]
    dz = end[2] - start[2]
    ax, ay, az = triangle[0]
    bx = triangle[1, 0] - ax
    by = triangle[1, 1] - ay
    bz = triangle[1, 2] - az
    cx = triangle[2, 0] - ax
    cy = triangle[2, 1] - ay
    cz = triangle[2, 2] - az
    across_x = dy * cz - dz * cy
    across_y = dz * cx - dx * cz
    across_z = dx * cy - dy * cx
    volume = bx * across_x + by * across_y + bz * across_z
    if not abs(volume) > PARALLEL_VOLUME:
        return False
    inverse = 1.0 / volume
    x = start[0] - ax
    y = start[1] - ay
    z = start[2] - az
    u = (x * across_x + y * across_y + z * across_z) * inverse
    if not margin < u < 1.0 - margin:
        return False
    turned_x = y * bz - z * by
    turned_y = z * bx - x * bz
    turned_z = x * by - y * bx
    v = (turned_x * dx + turned_y * dy + turned_z * dz) * inverse
    along = (cx * turned_x + cy * turned_y + cz * turned_z) * inverse
    return bool(v > margin and u + v < 1.0 - margin and margin < along < 1.0 - margin)


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
    across = np.empty(3)
    turned = np.empty(3)
    for ray in range(len(directions)):
        dx, dy, dz = directions[ray]
        for face in range(len(corners)):
            way = middle[face]
            if dx * way[0] + dy * way[1] + dz * way[2] < cone[face]:
                continue
            a = corners[face, 0]
            ab = corners[face, 1] - a
            ac = corners[face, 2] - a
            across[0] = dy * ac[2] - dz * ac[1]
            across[1] = dz * ac[0] - dx * ac[2]
            across[2] = dx * ac[1] - dy * ac[0]
            volume = ab[0] * across[0] + ab[1] * across[1] + ab[2] * across[2]
            if abs(volume) <= PARALLEL_VOLUME:
                continue
            inverse = 1.0 / volume
            u = -(a[0] * across[0] + a[1] * across[1] + a[2] * across[2]) * inverse
            turned[0] = a[2] * ab[1] - a[1] * ab[2]
            turned[1] = a[0] * ab[2] - a[2] * ab[0]
            turned[2] = a[1] * ab[0] - a[0] * ab[1]
            v = (turned[0] * dx + turned[1] * dy + turned[2] * dz) * inverse
            distance = (ac[0] * turned[0] + ac[1] * turned[1] + ac[2] * turned[2]) * inverse
            if u < 0.0 or v < 0.0 or u + v > 1.0 or distance <= 0.0:
                continue
            if found < len(met):
                met[found, 0] = ray
                met[found, 1] = face
                distances[found] = distance
            found += 1
    return found
