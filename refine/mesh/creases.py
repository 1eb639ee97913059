r"""Creases: edges that stay sharp because the surface turns sharply there at rest.

    crease      an interior edge between two triangles whose normals at rest form an angle above the
                crease angle; this angle is 90 degrees along a cube's edges, and 0 in a plane

It is treated as a border on both sides (connectivity.py): its rules read only its two ends, or its
curve. So no crack can open, and no rule rounds it.

A vertex on a crease has several *sectors*, the triangles around it between one crease and the next:

           \  1 /         three creases that meet, and three sectors; curves of edges within a
            \  /          sector depend on the normal of that sector only
         0   \/   2
             |            The end of a crease has one sector, all around.
             |
"""

from numbers import Real
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Flags, Floats64, Integers32, Unsigned32
from ...geometry.directions import unit_vectors
from ...geometry.normals import cross_products
from ...geometry.read_only import read_only
from ...jit import njit
from .connectivity import Connectivity


class Sectors(NamedTuple):
    """A mesh whose vertices are divided into sectors; one per vertex without creases."""

    corners: Unsigned32
    """Sector of each corner, shape (F, 3). The first sector of vertex v is v; its other sectors
    have numbers from V on.
    """
    edges: Unsigned32
    """Sectors at both ends of every edge on its first side, then, for creases, on their second
    side, shape (E', 2).
    """
    edge_of: Unsigned32
    """The edge of each of these rows, shape (E',)."""
    sector_count: int
    """S, the number of all sectors."""


def with_creases(
    mesh: Connectivity, rest_positions: Floats64, crease_angle: object
) -> Connectivity:
    """Make the edges that are sharper at rest than `crease_angle` [degrees] creases.

    None keeps the mesh as it is; `rest_positions`: shape (V, 3). Raises ValueError for an angle
    that is not from 0 to 180.
    """
    if crease_angle is None:
        return mesh
    is_number = isinstance(crease_angle, Real) and not isinstance(crease_angle, bool)
    if not is_number or not 0.0 <= float(crease_angle) <= 180.0:  # type: ignore[arg-type]
        raise ValueError(
            f"crease_angle must be None or an angle from 0 to 180 degrees, got {crease_angle!r}"
        )
    angles = dihedral_angles(mesh, rest_positions)
    return sharpened(mesh, angles > np.radians(float(crease_angle)))  # type: ignore[arg-type]


def sharpened(mesh: Connectivity, is_sharp: Flags) -> Connectivity:
    """Turn the flagged interior edges, shape (E,), into creases; other creases stay."""
    is_sharp = is_sharp & mesh.around.is_interior
    edges = np.flatnonzero(is_sharp)
    points = mesh.around.points.copy()
    points[edges, 2:] = points[edges, :1]
    wings = mesh.around.wings.copy()
    wings[edges] = edges[:, None]
    is_interior = mesh.around.is_interior & ~is_sharp
    around = mesh.around._replace(points=points, wings=wings, is_interior=is_interior)
    return mesh._replace(around=around, is_sharp=is_sharp | mesh.is_sharp)


def dihedral_angles(mesh: Connectivity, positions: Floats64) -> Floats64:
    """Angle between the normals of the two triangles at each interior edge [rad], shape (E,).

    It is 0 for all other edges, and beside triangles without an area.
    """
    normals = unit_vectors(cross_products(positions, mesh.faces), 1e-300)
    angles = np.zeros(len(mesh.edges))
    edges = np.flatnonzero(mesh.around.is_interior)
    first, second = normals[mesh.edge_sides[edges] >> 2].swapaxes(0, 1)
    apart = np.linalg.norm(np.cross(first, second), axis=1)
    along = np.einsum("ei,ei->e", first, second)
    angles[edges] = np.arctan2(apart, along)
    return angles


def sectors_of(mesh: Connectivity) -> Sectors:
    """Find the sectors of all vertices."""
    edge_count = len(mesh.edges)
    if not mesh.is_sharp.any():
        every_edge = np.arange(edge_count, dtype=np.uint32)
        return Sectors(mesh.faces, mesh.edges.view(np.uint32), every_edge, mesh.vertex_count)
    corners, sector_count = corner_sectors(mesh, mesh.is_sharp)
    sharp = np.flatnonzero(mesh.is_sharp)
    first = _ends_on_side(mesh, corners, mesh.edge_sides[:, 0], np.arange(edge_count))
    second = _ends_on_side(mesh, corners, mesh.edge_sides[sharp, 1], sharp)
    return Sectors(
        corners,
        np.concatenate([first, second]).astype(np.uint32),
        np.concatenate([np.arange(edge_count), sharp]).astype(np.uint32),
        sector_count,
    )


def corner_sectors(mesh: Connectivity, is_parting: Flags) -> tuple[Unsigned32, int]:
    """The sector of each corner, shape (F, 3), and the number of sectors.

    `is_parting`: edges at which sectors end, shape (E,). The first sector of vertex v is v; its
    other sectors have numbers from V on.
    """
    on_crease = np.zeros(mesh.vertex_count, dtype=np.bool_)
    on_crease[mesh.edges[is_parting]] = True
    mesh = mesh.read_only()  # one type of arrays, so that the kernel is compiled once
    groups = _joined_corners(
        mesh.faces, mesh.edges, mesh.edge_sides, mesh.more_sides, read_only(is_parting), on_crease
    )
    # The first group of corners at a vertex is its sector v; others are numbered after all of them.
    vertices = mesh.faces.ravel().astype(np.int64)
    roots, first_corner = np.unique(groups, return_index=True)
    owners = vertices[first_corner]
    order = np.lexsort((first_corner, owners))
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = owners[order][1:] != owners[order][:-1]
    number_of_root = np.zeros(len(roots), dtype=np.int64)
    number_of_root[order[is_first]] = owners[order[is_first]]
    more = order[~is_first]
    number_of_root[more] = mesh.vertex_count + np.arange(len(more))
    corners = number_of_root[np.searchsorted(roots, groups)].astype(np.uint32).reshape(-1, 3)
    return corners, mesh.vertex_count + len(more)


def _ends_on_side(
    mesh: Connectivity, corners: Unsigned32, sides: Unsigned32, edges: np.ndarray
) -> Unsigned32:
    """Sectors at the ends a, b of some edges, (N, 2), on given sides, 4 x triangle + i, (N,)."""
    triangles = (sides >> 2).astype(np.int64)
    corner = (sides & 3).astype(np.int64)
    start = corners[triangles, corner]
    end = corners[triangles, (corner + 1) % 3]
    runs_along = mesh.faces[triangles, corner] == mesh.edges[edges, 0]
    first = np.where(runs_along, start, end)
    last = np.where(runs_along, end, start)
    return np.stack([first, last], axis=1)


@njit
def _joined_corners(
    faces: Unsigned32,
    edges: Integers32,
    edge_sides: Unsigned32,
    more_sides: Unsigned32,
    is_sharp: Flags,
    on_crease: Flags,
) -> Integers32:
    """Return, for every corner, the corner that represents its sector, shape (3 F,).

    Corners at a vertex without creases are one sector, even if no edge joins them.
    """
    corner_count = faces.size
    above = np.empty(corner_count, np.int32)
    first_at = np.full(on_crease.shape[0], np.int32(-1))
    for c in range(corner_count):
        v = faces[c // 3, c % 3]
        above[c] = np.int32(c)
        if not on_crease[v]:
            if first_at[v] < 0:
                first_at[v] = np.int32(c)
            above[c] = first_at[v]
    for k in range(edges.shape[0] + more_sides.shape[0]):
        is_more = k >= edges.shape[0]
        e = more_sides[k - edges.shape[0], 0] if is_more else np.uint32(k)
        other = more_sides[k - edges.shape[0], 1] if is_more else edge_sides[e, 1]
        t = edge_sides[e, 0] >> 2
        u = other >> 2
        if is_sharp[e] or u >= faces.shape[0]:
            continue
        for i in range(2):
            v = np.uint32(edges[e, i])
            if not on_crease[v]:
                continue
            here = _root_of(above, _corner_at(faces, t, v))
            there = _root_of(above, _corner_at(faces, u, v))
            above[max(here, there)] = np.int32(min(here, there))
    for c in range(corner_count):
        above[c] = np.int32(_root_of(above, c))
    return above


@njit
def _corner_at(faces: Unsigned32, triangle: int, vertex: np.uint32) -> int:
    """Return the number, 3 x triangle + 0, 1 or 2, of a triangle's last corner at a vertex."""
    found = 0
    for k in range(3):
        if faces[triangle, k] == vertex:
            found = 3 * int(triangle) + k
    return found


@njit
def _root_of(above: Integers32, corner: int) -> int:
    """Follow `above` from a corner to the one that represents its sector so far."""
    while above[corner] != corner:
        corner = above[corner]
    return corner
