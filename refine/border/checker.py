"""A checker for refined meshes: it tests the promises of the paper's section 4.

It checks counts, then references, then geometry, and names the first broken relation. From the
refiner it uses only `origins`, the places of output vertices on the input mesh. It accepts any
number of levels, and points anywhere on edges or inside triangles. It is for tests and for authors
of refiners, and far too slow for every frame.

The relations (Kähler, Haber, Seidel 2003, sections 3 and 4.3, Fig. 7 for the cracks):
  - every input triangle is covered exactly, by subtriangles of its own orientation, in the plane of
    its barycentric coordinates: no fold, no sliver with three points on one edge;
  - output vertices at the same place have equal positions and normals, also across a texture seam;
  - a sub-edge inside an input triangle has two subtriangles, in opposite directions;
  - a sub-edge on an input edge has as many subtriangles on each side as this edge has triangles in
    the input: so there is no T-junction, and no new border;
  - an edge that was split s times has 2^s sub-edges;
  - no criterion measures NaN (only checked if the refiner has a `complaint`, see
    `Kahler.complaint`);
  - a vertex without a split edge has its input position, to the last bit of a float32.
An input triangle that names a vertex twice is exempt from these relations; the output contains it
once.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Flags, Integers32, Integers64
from ..mesh.validation import LARGEST_COORDINATE
from .plugin import Origins, RefinedMesh, Refiner

LATTICE_STEPS = 2**9 * 3**2 * 5 * 7
"""Steps along an edge of the lattice to which places are rounded, so equal places compare equal.

The points of nine levels of halving lie on the lattice, and so do thirds, fifths, sevenths and
ninths of most of them; all may have rounding errors of single precision. Any other place must have
the same weights in all triangles that share it, because places that are a part or more apart count
as different.
"""


class _Places(NamedTuple):
    """Places of output vertices on the input mesh; equal places have equal numbers."""

    vertices: Integers64
    """Input vertices in rising order, shape (N, 3); -1 for a vertex with no part in the place."""
    parts: Integers64
    """Weights of these vertices in parts, which add up to `LATTICE_STEPS`, shape (N, 3)."""


class BrokenMeshError(ValueError):
    """A refined mesh violates a relation that the refiner promises."""


def check(refiner: Refiner, mesh: RefinedMesh, positions: npt.NDArray[np.floating]) -> None:
    """Raise BrokenMeshError, naming the relation, unless `mesh` is a proper refinement.

    `mesh`: the result of `refiner.refine(positions)`, which must be its last frame; `positions`:
    the deformed vertex positions, shape (V, 3). Returns nothing and changes nothing.
    """
    complain = getattr(refiner, "complaint", None)
    complaint = complain() if callable(complain) else None
    _require(complaint is None, f"a criterion measures numbers ({complaint})")
    mesh = RefinedMesh._make(getattr(mesh, name) for name in RefinedMesh._fields)  # fetched once
    origins = refiner.origins()
    _check_arrays(mesh, origins, len(positions), len(refiner.triangle_edges))
    places = _whole_parts(origins)
    points = _number_places(places, mesh)
    _check_same_places(mesh, points)

    faces = _input_faces(refiner)
    proper = faces[:, 0] >= 0
    _check_sources(mesh, proper)
    rows = np.flatnonzero(proper[mesh.source])
    triangles = mesh.triangles[rows].astype(np.int64)
    source = mesh.source[rows]
    corners = _places_in_source(places, triangles, faces[source])
    _check_cover(corners, source, np.flatnonzero(proper), rows)
    _check_sub_edges(points[triangles], corners, source, refiner)
    _check_unmoved(refiner, mesh, places, positions)


def _check_arrays(mesh: RefinedMesh, origins: Origins, vertex_count: int, face_count: int) -> None:
    rows = len(mesh.positions)
    triangle_rows = len(mesh.triangles)
    _require(
        mesh.positions.dtype == mesh.normals.dtype == np.float32
        and mesh.triangles.dtype == np.uint32
        and mesh.source.dtype == np.int32,
        "positions and normals are float32, triangles uint32, source int32",
    )
    _require(
        mesh.positions.shape == mesh.normals.shape == (rows, 3)
        and origins.vertices.shape == origins.weights.shape == (rows, 3)
        and mesh.triangles.shape == (triangle_rows, 3)
        and mesh.source.shape == (triangle_rows,)
        and (mesh.uv is None or mesh.uv.shape == (rows, 2)),
        "one row of normals, texture coordinates and origins per vertex, one source per triangle",
    )
    for name, array, limit in (
        ("triangles name vertices of the mesh", mesh.triangles, rows),
        ("sources name triangles of the input", mesh.source, face_count),
        ("origins name vertices of the input", origins.vertices, vertex_count),
    ):
        row = array.reshape(len(array), array[:1].size)
        _require_all(np.asarray(((row >= 0) & (row < limit)).all(axis=1)), name)
    is_finite = np.asarray(np.isfinite(mesh.positions).all(axis=1))
    _require_all(is_finite, "positions are finite")
    length = np.linalg.norm(mesh.normals.astype(np.float64), axis=1)
    is_unit = np.isclose(length, 1.0, rtol=0.0, atol=1e-5)
    _require_all(is_unit | (length == 0.0), "normals have length one or zero")


def _input_faces(refiner: Refiner) -> Integers64:
    """Vertices of the input triangles, from their edges: corner i is on edges i - 1 and i.

    -1 for triangles without edges.
    """
    faces = np.full(refiner.triangle_edges.shape, -1, dtype=np.int64)
    proper = refiner.triangle_edges[:, 0] >= 0
    ends = refiner.edges[refiner.triangle_edges[proper]]
    before = np.roll(ends, 1, axis=1)
    is_shared = (ends[..., 0, None] == before).any(axis=2)
    faces[proper] = np.where(is_shared, ends[..., 0], ends[..., 1])
    return faces


def _whole_parts(origins: Origins) -> _Places:
    """Round weights to whole parts; raises BrokenMeshError if they are not weights."""
    _require_all(
        abs(origins.weights.sum(axis=1, dtype=np.float64) - 1.0) < 1e-5,
        "origins have weights that add up to one",
    )
    parts = np.rint(origins.weights * float(LATTICE_STEPS)).astype(np.int64)
    _require_all((parts >= 0).all(axis=1), "origins have no weights below zero")
    vertices = np.where(parts > 0, origins.vertices, -1).astype(np.int64)
    order = np.argsort(vertices, axis=1)
    vertices = np.take_along_axis(vertices, order, axis=1)
    parts = np.take_along_axis(parts, order, axis=1)
    parts[np.arange(len(parts)), parts.argmax(axis=1)] += LATTICE_STEPS - parts.sum(axis=1)
    return _Places(vertices, parts)


def _number_places(places: _Places, mesh: RefinedMesh) -> Integers64:
    """Give equal places on the input mesh the same number, shape (N,)."""
    # A point inside a triangle belongs only to it, even if another triangle has the same corners.
    is_inside = (places.parts > 0).all(axis=1)
    source = np.full(len(mesh.positions), -1, dtype=np.int64)
    source[mesh.triangles] = mesh.source[:, None]
    rows = np.column_stack([*places, np.where(is_inside, source, -1)])
    return np.unique(rows, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _check_same_places(mesh: RefinedMesh, points: Integers64) -> None:
    _, first, inverse = np.unique(points, return_index=True, return_inverse=True)
    original = first[inverse.reshape(-1)]
    _require_all(
        (mesh.positions == mesh.positions[original]).all(axis=1),
        "vertices at one place of the input have one position (no crack along a seam)",
    )
    _require_all(
        (mesh.normals == mesh.normals[original]).all(axis=1),
        "vertices at one place of the input have one normal",
    )


def _check_sources(mesh: RefinedMesh, proper: Flags) -> None:
    counts = np.bincount(mesh.source, minlength=len(proper))
    _require_all(counts > 0, "every input triangle is part of the output")
    _require_all(proper | (counts == 1), "an input triangle that names a vertex twice is passed on")


def _places_in_source(
    places: _Places, triangles: Integers64, source_faces: Integers64
) -> Integers64:
    """Corners of subtriangles in parts of their source's coordinates, shape (M, 3, 3)."""
    is_corner = places.vertices[triangles][..., None] == source_faces[:, None, None, :]
    corners = (places.parts[triangles][..., None] * is_corner).sum(axis=2)
    _require_all(
        (corners.sum(axis=2) == LATTICE_STEPS).all(axis=1),
        "the vertices of a subtriangle lie in the input triangle it is part of",
    )
    return np.asarray(corners, dtype=np.int64)


def _check_cover(
    corners: Integers64, source: Integers32, proper: Integers64, rows: Integers64
) -> None:
    u = corners[:, 1] - corners[:, 0]
    v = corners[:, 2] - corners[:, 0]
    areas = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]  # LATTICE_STEPS^2 for the whole triangle
    _require_all(
        areas > 0,
        "a subtriangle has the orientation of its input triangle and an area "
        "(it is not flipped, no sliver, not degenerate)",
        rows,
    )
    covered = np.bincount(source, weights=areas, minlength=int(proper.max(initial=-1)) + 1)
    _require_all(
        covered[proper] == LATTICE_STEPS**2,
        "the areas of its subtriangles add up to that of the input triangle",
        proper,
    )


def _check_sub_edges(
    triangles: Integers64, corners: Integers64, source: Integers32, refiner: Refiner
) -> None:
    starts = triangles.ravel()
    ends = np.roll(triangles, -1, axis=1).ravel()
    # A sub-edge lies on edge i of its source where coordinate i + 2 is zero at both ends.
    is_zero = (corners == 0) & (np.roll(corners, -1, axis=1) == 0)
    on_edge = np.roll(is_zero, 1, axis=2).reshape(-1, 3)
    is_inside = ~on_edge.any(axis=1)
    half_edge_source = np.repeat(source, 3)
    edge = refiner.triangle_edges[half_edge_source, on_edge.argmax(axis=1)].astype(np.int64)
    # Sub-edges on an input edge are identified by the edge, those inside by the triangle.
    owner = np.where(is_inside, len(refiner.edges) + half_edge_source, edge)

    low = np.minimum(starts, ends)
    high = np.maximum(starts, ends)
    keys = np.stack([owner, low, high], axis=1)
    found, first, inverse, sides = np.unique(
        keys, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    inverse = inverse.reshape(-1)
    backward = np.bincount(inverse, weights=starts > ends).astype(np.int64)
    inside = is_inside[first]
    _require_all(
        ~inside | ((sides == 2) & (backward == 1)),
        "a sub-edge inside an input triangle has two subtriangles in opposite directions",
    )
    on = np.flatnonzero(~inside)
    edge_of_sub = found[on, 0]
    along, against = _sides_of_edges(refiner)
    balance = np.stack([backward[on], sides[on] - backward[on]], axis=1)
    expected = np.stack([along[edge_of_sub], against[edge_of_sub]], axis=1)
    _require_all(
        (np.sort(balance, axis=1) == np.sort(expected, axis=1)).all(axis=1),
        "a sub-edge on an input edge has the same sides as this edge (no crack, no T-junction)",
        edge_of_sub,
    )
    pieces = np.bincount(edge_of_sub, minlength=len(refiner.edges))
    _require_all(
        pieces == 2 ** refiner.splits.astype(np.int64),
        "an edge that was split s times has 2 to the power of s sub-edges",
    )


def _sides_of_edges(refiner: Refiner) -> tuple[Integers64, Integers64]:
    """Return the numbers of input triangles that run along each edge, and against it."""
    faces = _input_faces(refiner)
    proper = faces[:, 0] >= 0
    triangle_edges = refiner.triangle_edges[proper]
    is_along = refiner.edges[triangle_edges][..., 0] == faces[proper]
    edge_count = len(refiner.edges)
    along = np.bincount(triangle_edges[is_along], minlength=edge_count)
    against = np.bincount(triangle_edges[~is_along], minlength=edge_count)
    return along.astype(np.int64), against.astype(np.int64)


def _check_unmoved(
    refiner: Refiner, mesh: RefinedMesh, places: _Places, positions: npt.NDArray[np.floating]
) -> None:
    is_near_split = np.zeros(len(positions), dtype=bool)
    is_near_split[refiner.edges[refiner.splits > 0]] = True
    rows, slots = np.nonzero(places.parts == LATTICE_STEPS)
    vertex = places.vertices[rows, slots]
    given = positions[vertex].astype(np.float64)
    is_number = np.asarray(
        (abs(given) < LARGEST_COORDINATE).all(axis=1)
    )  # unused vertices may be NaN
    wanted = np.where(is_number[:, None], given, 0.0).astype(np.float32)
    same = (mesh.positions[rows] == wanted).all(axis=1)
    _require_all(
        same | is_near_split[vertex] | ~is_number,
        "a vertex at which no edge was split keeps its position to the last bit",
        rows,
    )


def _require(holds: bool, relation: str) -> None:
    if not holds:
        raise BrokenMeshError(f"this rule is broken: {relation}")


def _require_all(
    holds: Flags, relation: str, numbers: npt.NDArray[np.integer] | None = None
) -> None:
    """Raise BrokenMeshError, which names the relation and the first row that violates it."""
    broken = np.flatnonzero(~holds)
    if len(broken):
        number = broken[0] if numbers is None else numbers[broken[0]]
        raise BrokenMeshError(
            f"this rule is broken at {number} ({len(broken)} of {len(holds)}): {relation}"
        )
