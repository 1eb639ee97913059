r"""Rotations of a coarse surface at its vertices.

The *axes* of a vertex are its normal and two directions in its tangent plane at rest. The
surrounding triangles carry these two directions along. A *frame* is the rotation of the axes since
rest: the rotation nearest to the deformation of the tangent plane (its polar decomposition), so no
edge is preferred. Rotations are unit quaternions, because quaternions can be averaged.

If a vertex has several sectors (mesh/creases.py), each sector has axes and a frame.
"""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats64, Integers64, Unsigned32
from ...geometry.directions import unit_vectors
from ...geometry.normals import cross_products
from ...geometry.vectors import Vector, cross, difference, dot, less, plus, times, write_row
from ...jit import njit
from ..mesh.connectivity import Connectivity
from ..mesh.creases import corner_sectors
from ..mesh.normals import SLIVER_SINE, weigh_corners

FRAME_NUMBERS = 5
"""Count of the numbers of a frame: a quaternion and the stretch of the surface."""
AXES_NUMBERS = 16
"""Count of the numbers of a sector's axes."""
LEAST_SIDE_RATIO = 0.1
"""Least length of a sector's summed cross products, relative to the sum of their lengths: below it
the sector has no direction.
"""


class SectorFans(NamedTuple):
    """The triangles around S sectors, with K corners in all, for compiled code."""

    starts: Unsigned32
    """Sector s has the corners `starts[s]` up to `starts[s + 1]` in the arrays below, (S + 1,)."""
    corners: Unsigned32
    """Vertices of each corner's triangle, the sector's own vertex first, shape (K, 3)."""
    contributions: Floats64
    """Contributions of a triangle to the axes, shape (K, 5): the weight of its cross product; then,
    for each of two directions in the surface, the factors of the first and the second edge.
    """


def sound_sectors(mesh: Connectivity, rest: Floats64) -> Integers64:
    """Return the sector of each corner, shape (F, 3); borders and creases separate sectors.

    If the normals of a sector cancel each other, such as on a sheet folded onto itself, each of its
    corners becomes a sector.
    """
    joined, count = corner_sectors(mesh, ~mesh.around.is_interior)
    sectors = joined.astype(np.int64)
    weights_of_normals = np.zeros(mesh.faces.shape)
    weigh_corners(rest, mesh.faces, weights_of_normals)
    equal_weights = np.ones_like(weights_of_normals)
    crosses = cross_products(rest, mesh.faces)
    areas = np.linalg.norm(crosses, axis=1)
    is_unsound = np.zeros(count, dtype=np.bool_)
    for weight in (weights_of_normals, equal_weights):  # normals must not cancel in either sum
        vectors = (weight[:, :, None] * crosses[:, None]).reshape(-1, 3)
        sums = np.linalg.norm(_sums(sectors.ravel(), vectors, count), axis=1)
        weighted_areas = (weight * areas[:, None]).reshape(-1, 1)
        sizes = _sums(sectors.ravel(), weighted_areas, count)[:, 0]
        is_unsound |= sums < LEAST_SIDE_RATIO * sizes
    corners = np.flatnonzero(is_unsound[sectors])
    sectors.ravel()[corners] = count + np.arange(len(corners))
    return sectors


def fans_of_sectors(
    mesh: Connectivity, rest: Floats64, corner_sector: Integers64, used: Integers64
) -> SectorFans:
    """Return the fans of the sectors `used`; `corner_sector`: sector of each corner, (F, 3)."""
    around = np.flatnonzero(np.isin(corner_sector, used))  # corners, 3 x triangle + i
    number = np.searchsorted(used, corner_sector.ravel()[around])
    order = np.argsort(number, kind="stable")
    around = around[order]
    number = number[order]
    counts = np.bincount(number, minlength=len(used))
    triangle = around // 3
    fans = np.stack([mesh.faces[triangle, (around + step) % 3] for step in range(3)], axis=1)
    weights = np.zeros(mesh.faces.shape)
    weigh_corners(rest, mesh.faces, weights)
    contributions = _contributions(rest, fans, number, weights.ravel()[around])
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.uint32)
    return SectorFans(starts, np.ascontiguousarray(fans), contributions)


def _contributions(
    rest: Floats64, fans: Unsigned32, sector: Integers64, weights: Floats64
) -> Floats64:
    """Return `SectorFans.contributions`.

    `sector`: sector of each corner, (K,). `weights`: weights of cross products, (K,).
    """
    first = rest[fans[:, 1]] - rest[fans[:, 0]]
    second = rest[fans[:, 2]] - rest[fans[:, 0]]
    crosses = np.cross(first, second)
    areas = np.linalg.norm(crosses, axis=1)
    count = int(sector.max(initial=-1)) + 1
    normals = _sums(sector, weights[:, None] * crosses, count)
    normals = unit_vectors(normals, 1e-300)
    across = np.cross(normals, np.eye(3)[np.abs(normals).argmin(axis=1)])
    across = unit_vectors(across, 1e-300)
    longest = np.maximum(np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1))
    is_proper = areas > SLIVER_SINE * longest**2
    totals = _sums(sector, np.where(is_proper, areas, 0.0)[:, None], count)[:, 0]
    area_fraction = np.where(is_proper, areas / np.maximum(totals[sector], 1e-300), 0.0)
    squared = np.where(is_proper, areas, 1.0) ** 2
    # A direction d in the triangle is x first + y second; the dual basis of its edges gives x and
    # y.
    dual_of_first = np.cross(second, crosses) / squared[:, None]
    dual_of_second = np.cross(crosses, first) / squared[:, None]
    contributions = [weights]
    for direction in (across, np.cross(normals, across)):
        for dual in (dual_of_first, dual_of_second):
            contributions.append(area_fraction * np.einsum("ki,ki->k", dual, direction[sector]))
    return np.stack(contributions, axis=1)


def _sums(numbers: Integers64, values: Floats64, count: int) -> Floats64:
    """Return the sums of rows with the same number, shape (count, k)."""
    columns = [np.bincount(numbers, column, minlength=count) for column in values.T]
    return np.stack(columns, axis=1)


@njit
def unit_of(v: Vector) -> Vector:
    """Normalise a vector of doubles; zero stays zero."""
    length = np.sqrt(dot(v, v))
    if length == 0.0:
        return 0.0, 0.0, 0.0
    return v[0] / length, v[1] / length, v[2] / length


@njit
def find_axes(first: int, last: int, positions: Floats64, fans: SectorFans, axes: Floats64) -> None:
    """Write the axes of sectors, shape (S, 16).

    A row has three unit vectors (normal, first and second direction), the stretch, and the current
    vectors, of any length, of the two directions that lie in the surface at rest. All are zero
    where triangles have no normal or direction.
    """
    for s in range(first, last):
        normal = across = beside = 0.0, 0.0, 0.0
        for k in range(fans.starts[s], fans.starts[s + 1]):
            v = fans.corners[k, 0]
            u = difference(positions, v, fans.corners[k, 1])
            w = difference(positions, v, fans.corners[k, 2])
            normal = plus(normal, times(fans.contributions[k, 0], cross(u, w)))
            across = plus(across, times(fans.contributions[k, 1], u))
            across = plus(across, times(fans.contributions[k, 2], w))
            beside = plus(beside, times(fans.contributions[k, 3], u))
            beside = plus(beside, times(fans.contributions[k, 4], w))
        normal = unit_of(normal)
        across = less(across, dot(across, normal), normal)
        beside = less(beside, dot(beside, normal), normal)
        along = plus(across, cross(beside, normal))
        axes[s, 9] = 0.5 * np.sqrt(dot(along, along)) if dot(normal, normal) > 0.0 else 0.0
        along = unit_of(along)
        write_row(axes, s, normal, 0)
        write_row(axes, s, along, 3)
        write_row(axes, s, cross(normal, along), 6)
        write_row(axes, s, across, 10)
        write_row(axes, s, beside, 13)


@njit
def find_frames(first: int, last: int, rest: Floats64, axes: Floats64, frames: Floats64) -> None:
    """Write frames of sectors, (S, 5): the turn of `axes`, (S, 16), since `rest`.

    A quaternion is zero where axes are missing, now or at rest; a zero quaternion has no effect on
    means.
    """
    turn = np.zeros((3, 3))
    for s in range(first, last):
        for i in range(3):
            for j in range(3):
                turn[i, j] = 0.0
                for k in range(3):
                    turn[i, j] += axes[s, 3 * k + i] * rest[s, 3 * k + j]
        frames[s, :] = 0.0
        frames[s, 4] = 1.0
        if axes[s, 9] > 0.0 and rest[s, 9] > 0.0:
            write_quaternion(turn, frames[s])
            frames[s, 4] = axes[s, 9] / rest[s, 9]


@njit
def write_quaternion(turn: Floats64, quaternion: Floats64) -> None:
    """Write the quaternion w, x, y, z of a rotation, a matrix (3, 3).

    It computes the largest component first, as in Shepperd 1978, "Quaternion from rotation matrix".
    """
    trace = turn[0, 0] + turn[1, 1] + turn[2, 2]
    largest = 3
    most = trace
    for i in range(3):
        if turn[i, i] > most:
            most = turn[i, i]
            largest = i
    if largest == 3:
        root = np.sqrt(1.0 + trace)
        quaternion[0] = 0.5 * root
        quaternion[1] = 0.5 * (turn[2, 1] - turn[1, 2]) / root
        quaternion[2] = 0.5 * (turn[0, 2] - turn[2, 0]) / root
        quaternion[3] = 0.5 * (turn[1, 0] - turn[0, 1]) / root
        return
    i = largest
    j = (i + 1) % 3
    k = (i + 2) % 3
    root = np.sqrt(1.0 + turn[i, i] - turn[j, j] - turn[k, k])
    quaternion[1 + i] = 0.5 * root
    quaternion[0] = 0.5 * (turn[k, j] - turn[j, k]) / root
    quaternion[1 + j] = 0.5 * (turn[j, i] + turn[i, j]) / root
    quaternion[1 + k] = 0.5 * (turn[k, i] + turn[i, k]) / root
