r"""The smooth surface of a coarse mesh: one cubic patch over each triangle, and its rotations.

Patches are curved PN triangles (Vlachos, Peters, Boyd, Mitchell 2001, "Curved PN triangles") with
the border curves of the scheme `cubic` (beyond/cubic.py). Inside the mesh the curves' tangents are
normal to the vertex normals; on borders and creases they follow the border curve. Neighbouring
patches share the curve between them.

           a_c
          /   \          corners        a, b, c
       ca      bc        near a on ab   a + tangent / 3
      /    m     \       m              mean of the corners, and 3/2 of how far the other six
    a ---ab---ba--- b                   stand out of the flat triangle, on average

At rest the tangent is d = b - a without its part along the normal at a. In a frame the surrounding
triangles carry the tangents along with the plane at a. So a point keeps its place on a surface that
is stretched unevenly, and every affine map of the plane is reproduced exactly. A carried tangent
may differ from the tangent of the current mesh by at most half of that tangent's length; otherwise
a fold would give curves with loops.

Differs from the refined mesh: there are no flat triangles to compensate for, so curves have exactly
the displacement of the cubic, and vertex normals are used without steepening.
"""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats64, Integers64, Unsigned32
from ...geometry.vectors import Vector, cross, difference, dot, less, plus, row_of, times, write_row
from ...jit import njit
from ..mesh.borders import follow_borders
from ..mesh.connectivity import Connectivity
from ..mesh.threads import parallel_for
from .frames import (
    AXES_NUMBERS,
    FRAME_NUMBERS,
    fans_of_sectors,
    find_axes,
    find_frames,
    sound_sectors,
)

CONTROL_POINT_COUNT = 10
"""Control points of a patch: corners a, b, c; near a towards b and c; near b towards c and a; near
c towards a and b; and the middle.
"""
FRAME_COLUMN = 3 * CONTROL_POINT_COUNT
"""First column of the frames of a patch's corners; a frame is a quaternion and a stretch."""
FRAME_COLUMN_COUNT = FRAME_COLUMN + 3 * FRAME_NUMBERS
"""Count of the numbers of a patch."""
MOST_CARRIED = 0.5
"""Largest difference between a carried tangent and the tangent of the current mesh, relative to the
length of the latter. Chosen: at 1 or more a curve may turn back.
"""
NO_VERTEX = np.uint32(2**32 - 1)
"""Number for no vertex: edges inside the mesh have no border vertices before and after."""


class Patches(NamedTuple):
    """The index arrays and data of patches, for compiled code.

    T patches, D directed edges and S sectors of vertices (frames.py).
    """

    corners: Unsigned32
    """Vertices of each patch, shape (T, 3)."""
    sectors: Unsigned32
    """Sectors of its corners, shape (T, 3)."""
    near: Unsigned32
    """Directed edges from each corner to the next one and to the one before, shape (T, 6)."""
    directed_edges: Unsigned32
    """For directed edges, shape (D, 5): vertices a and b; the vertices before a and after b on the
    border (at a corner, a or b itself; inside the mesh, NO_VERTEX); the sector at a.
    """
    slopes: Floats64
    """Coordinates of the tangent at rest in the two directions of the sector, shape (D, 2); on a
    border, the shares of this edge in the border lengths through a and through b.
    """
    rest: Floats64
    """Axes of sectors at rest, shape (S, 16), as `find_axes` writes them."""


class SmoothSurface:
    """The patches over some triangles of a mesh, in the positions of a frame."""

    def __init__(self, mesh: Connectivity, rest: Floats64, triangles: Integers64) -> None:
        """Bind to `rest`, positions (V, 3), and the patches of `triangles`, shape (T,)."""
        corner_sector = sound_sectors(mesh, rest)
        used, numbers = np.unique(corner_sector[triangles], return_inverse=True)
        self.sectors = numbers.reshape(-1, 3).astype(np.uint32)
        near, directed_edges = _directed_edges(mesh, rest, triangles, self.sectors)
        self._fans = fans_of_sectors(mesh, rest, corner_sector, used)
        self._patches = Patches(
            corners=np.ascontiguousarray(mesh.faces[triangles]),
            sectors=self.sectors,
            near=near,
            directed_edges=directed_edges,
            slopes=np.zeros((len(directed_edges), 2)),
            rest=np.zeros((len(used), AXES_NUMBERS)),
        )
        axes = self._patches.rest
        parallel_for(find_axes, len(used), rest, self._fans, axes)
        parallel_for(find_slopes, len(directed_edges), rest, self._patches)
        self._axes = axes.copy()
        self._frames = np.zeros((len(used), FRAME_NUMBERS))
        self._tangents = np.zeros((len(directed_edges), 3))
        self.rows = np.zeros((len(triangles), FRAME_COLUMN_COUNT))
        """Control points and frames of each patch, shape (T, 45)."""
        self.move(rest)

    @property
    def normals(self) -> Floats64:
        """Unit normals of sectors, shape (S, 3); zero where triangles have none."""
        return np.ascontiguousarray(self._axes[:, :3])

    def move(self, positions: Floats64) -> None:
        """Compute the patches over `positions`, shape (V, 3)."""
        patches = self._patches
        parallel_for(find_axes, len(self._axes), positions, self._fans, self._axes)
        parallel_for(find_frames, len(self._axes), patches.rest, self._axes, self._frames)
        parallel_for(
            find_tangents, len(self._tangents), positions, patches, self._axes, self._tangents
        )
        given = patches, self._tangents, self._frames
        parallel_for(write_patches, len(self.rows), positions, *given, self.rows)


def _directed_edges(
    mesh: Connectivity, rest: Floats64, triangles: Integers64, sectors: Unsigned32
) -> tuple[Unsigned32, Unsigned32]:
    """Fields `near` and `directed_edges` of the patches over `triangles`; `sectors`: (T, 3)."""
    borders = follow_borders(mesh, rest)
    faces = mesh.faces[triangles]
    names = np.zeros((len(triangles), 6), dtype=np.int64)
    for i in range(3):
        for k, side in enumerate((i, (i + 2) % 3)):
            edges = mesh.triangle_edges[triangles, side]
            names[:, 2 * i + k] = 2 * edges + (mesh.edges[edges, 0] != faces[:, i])
    # A triangle that names a vertex twice has no edges, and no point is ever bound to it.
    used, first, near = np.unique(np.maximum(names, 0), return_index=True, return_inverse=True)
    edge = used >> 1
    end = used & 1
    is_interior = mesh.around.is_interior[edge]
    before = np.where(is_interior, NO_VERTEX, borders[edge, end])
    after = np.where(is_interior, NO_VERTEX, borders[edge, 1 - end])
    there = mesh.edges[edge, 1 - end]
    sector = np.repeat(sectors, 2, axis=1).ravel()[first]
    directed_edges = np.stack([mesh.edges[edge, end], there, before, after, sector], axis=1)
    return near.reshape(-1, 6).astype(np.uint32), directed_edges.astype(np.uint32)


@njit
def find_slopes(first: int, last: int, rest: Floats64, patches: Patches) -> None:
    """Write `patches.slopes` from the axes at rest."""
    for k in range(first, last):
        a, b, before, after, s = patches.directed_edges[k]
        if before != NO_VERTEX:
            patches.slopes[k, 0] = chord_ratio(rest, before, a, b)
            patches.slopes[k, 1] = chord_ratio(rest, after, b, a)
            continue
        d = difference(rest, a, b)
        normal = row_of(patches.rest, s)
        across = row_of(patches.rest, s, 10)
        beside = row_of(patches.rest, s, 13)
        whole = dot(normal, cross(across, beside))
        if whole > 0.0:
            patches.slopes[k, 0] = dot(normal, cross(d, beside)) / whole
            patches.slopes[k, 1] = dot(normal, cross(across, d)) / whole


@njit
def chord_ratio(positions: Floats64, before: np.uint32, a: np.uint32, b: np.uint32) -> float:
    """Return the length of edge a-b, relative to the border from the vertex before a to b."""
    length = distance(positions, a, b)
    whole = length + distance(positions, before, a)
    return length / whole if whole > 0.0 else 0.0


@njit
def border_tangent(
    positions: Floats64, directed_edge: Unsigned32, ratio_at_a: float, ratio_at_b: float
) -> Vector:
    """Return the tangent of a border curve at a along the edge to b, from its shares at both ends.

    Beside a corner the curve is a parabola, as in `cubic`.
    """
    a = directed_edge[0]
    b = directed_edge[1]
    before = directed_edge[2]
    after = directed_edge[3]
    if before == a and after != b:
        at_b = times(ratio_at_b, difference(positions, a, after))
        return less(times(2.0, difference(positions, a, b)), 1.0, at_b)
    return times(ratio_at_a, difference(positions, before, b))


@njit
def distance(positions: Floats64, a: np.uint32, b: np.uint32) -> float:
    """Length of an edge."""
    d = difference(positions, a, b)
    return float(np.sqrt(dot(d, d)))


@njit
def find_tangents(
    first: int, last: int, positions: Floats64, patches: Patches, axes: Floats64, tangents: Floats64
) -> None:
    """Write a third of the tangents of directed edges, shape (D, 3)."""
    for k in range(first, last):
        a, b, before, after, s = patches.directed_edges[k]
        along = patches.slopes[k, 0]
        if before != NO_VERTEX:
            at_a = chord_ratio(positions, before, a, b)
            at_b = chord_ratio(positions, after, b, a)
            now = border_tangent(positions, patches.directed_edges[k], at_a, at_b)
            carried = border_tangent(
                positions, patches.directed_edges[k], along, patches.slopes[k, 1]
            )
        else:
            d = difference(positions, a, b)
            normal = row_of(axes, s)
            now = less(d, dot(d, normal), normal)
            carried = times(along, row_of(axes, s, 10))
            carried = plus(carried, times(patches.slopes[k, 1], row_of(axes, s, 13)))
        if axes[s, 9] > 0.0 and patches.rest[s, 9] > 0.0:
            change = less(carried, 1.0, now)
            squared = dot(change, change)
            most = MOST_CARRIED**2 * dot(now, now)
            now = plus(now, times(np.sqrt(most / squared) if squared > most else 1.0, change))
        write_row(tangents, k, times(1.0 / 3.0, now))


@njit
def write_patches(
    first: int,
    last: int,
    positions: Floats64,
    patches: Patches,
    tangents: Floats64,
    frames: Floats64,
    rows: Floats64,
) -> None:
    """Write the control points and frames of patches, shape (T, 45)."""
    for t in range(first, last):
        middle = outs = 0.0, 0.0, 0.0
        for i in range(3):
            here = row_of(positions, patches.corners[t, i])
            write_row(rows, t, here, 3 * i)
            middle = plus(middle, here)
            for k in range(2 * i, 2 * i + 2):
                near = row_of(tangents, patches.near[t, k])
                outs = plus(outs, near)
                write_row(rows, t, plus(here, near), 9 + 3 * k)
        centre = plus(times(1.0 / 3.0, middle), times(0.25, outs))
        write_row(rows, t, centre, 27)
        for i in range(3):
            s = patches.sectors[t, i]
            along = 0.0
            for j in range(4):
                along += frames[s, j] * frames[patches.sectors[t, 0], j]
            sign = -1.0 if along < 0.0 else 1.0  # a quaternion of either sign is the same rotation
            column = FRAME_COLUMN + FRAME_NUMBERS * i
            for j in range(4):
                rows[t, column + j] = sign * frames[s, j]
            rows[t, column + 4] = frames[s, 4]


@njit
def place_on(rows: Floats64, t: int, u: float, v: float, w: float) -> Vector:
    """Return the point of patch t with barycentric coordinates u, v, w."""
    row = rows[t]
    uu = u * u
    vv = v * v
    ww = w * w
    x = y = z = 0.0
    basis = (
        uu * u,
        vv * v,
        ww * w,
        3.0 * uu * v,
        3.0 * uu * w,
        3.0 * vv * w,
        3.0 * vv * u,
        3.0 * ww * u,
        3.0 * ww * v,
        6.0 * u * v * w,
    )
    for k in range(CONTROL_POINT_COUNT):
        x += basis[k] * row[3 * k]
        y += basis[k] * row[3 * k + 1]
        z += basis[k] * row[3 * k + 2]
    return x, y, z
