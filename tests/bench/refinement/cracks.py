"""An oracle that shares nothing with `refine.check`: every input triangle is covered exactly.

Asked is only what a refiner hands out and its account of where rows come from (`origins`), in whole
numbers, so that nothing is a matter of tolerance:

    cover     within an input triangle every piece has the triangle's orientation, every line
              between two pieces has both of them, in opposite directions, and their areas add up
    edges     what remains are the pieces of its three edges; they follow one another from corner
              to corner, and all triangles at an edge have the same: no T-junction
    places    rows at one place of the input have one position and one normal, to the last bit
    numbers   positions are finite, normals have length one or zero
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from risorius import refine

Wide = npt.NDArray[np.int64]

WHOLE = 3 * 2**10
"""Of a barycentric coordinate: halves, quarters, sixteenths and thirds of it are whole numbers.

Points inside triangles are rounded to it; they have weights enough to stay inside."""
LENGTH_ERROR = 1e-4  # of a normal
MOST_VERTICES = 2**31  # so that the numbers of two fit into one


def cracks(
    faces: npt.NDArray[np.integer], mesh: refine.RefinedMesh, origins: refine.Origins
) -> str | None:
    """Say in a few words what is broken in a refined mesh; None if nothing is.

    faces: triangles of the input, shape (F, 3). One that names a vertex twice has no area: it must
    come out once, and nothing else is asked of it.
    """
    given = faces.astype(np.int64)
    triangles, source = mesh.triangles.astype(np.int64), mesh.source.astype(np.int64)
    wrong = _wrong_numbers(mesh, triangles, source, len(given))
    if wrong is not None:
        return wrong
    flat = (given == np.roll(given, 1, axis=1)).any(axis=1)
    if (np.bincount(source, minlength=len(given))[flat] != 1).any():
        return "a triangle that names a vertex twice does not come out once"
    parts = np.rint(origins.weights.astype(np.float64) * WHOLE).astype(np.int64)
    is_inside = (parts > WHOLE // 16).all(axis=1)
    is_fraction = abs(parts - origins.weights * float(WHOLE)).max(axis=1) < 0.01
    if not (is_inside | is_fraction).all():
        return "weights of origins are no simple fractions"
    off = WHOLE - parts.sum(axis=1)
    if abs(off).max(initial=0) > 1:
        return "weights of origins do not add up to one"
    parts[is_inside, 0] += off[is_inside]
    wrong = _different_rows(mesh, _places(origins.vertices.astype(np.int64), parts, triangles))
    if wrong is not None:
        return wrong
    has_area = ~flat[source]
    triangles, source = triangles[has_area], source[has_area]
    is_corner = origins.vertices[triangles][:, :, None, :] == given[source][:, None, :, None]
    corners = (parts[triangles][:, :, None, :] * is_corner).sum(axis=3)
    if (corners.sum(axis=2) != WHOLE).any():
        return "a piece reaches out of its input triangle"
    return _wrong_cover(corners, source, flat) or _wrong_edges(corners, source, given)


def _wrong_numbers(
    mesh: refine.RefinedMesh, triangles: Wide, source: Wide, count: int
) -> str | None:
    if not (np.isfinite(mesh.positions).all() and np.isfinite(mesh.normals).all()):
        return "a position or normal is not finite"
    length = np.linalg.norm(mesh.normals.astype(np.float64), axis=1)
    if ((abs(length - 1.0) > LENGTH_ERROR) & (length != 0.0)).any():
        return "a normal has neither length one nor zero"
    if triangles.max(initial=-1) >= len(mesh.positions):
        return "a triangle names a row that is not there"
    if len(source) != len(triangles) or not ((source >= 0) & (source < count)).all():
        return "source names an input triangle that is not there"
    return None


def _places(vertices: Wide, parts: Wide, triangles: Wide) -> Wide:
    """Number rows by the place on the input that they come from, shape (N,).

    A place is up to two vertices and their parts; within a triangle, every row is its own.
    """
    named = np.where(parts > 0, vertices, -1)
    order = np.argsort(named, axis=1)
    keys = np.hstack(
        [np.take_along_axis(named, order, axis=1), np.take_along_axis(parts, order, axis=1)]
    )
    inside = (keys[:, 0] >= 0) & (keys[:, 1] != keys[:, 0]) & (keys[:, 2] != keys[:, 1])
    alone = np.where(inside, np.arange(len(keys)), -1)
    numbers: Wide = np.unique(np.column_stack([keys, alone]), axis=0, return_inverse=True)[1]
    return numbers.reshape(-1)


def _different_rows(mesh: refine.RefinedMesh, places: Wide) -> str | None:
    first = np.unique(places, return_index=True)[1][places]
    for name, rows in (("positions", mesh.positions), ("normals", mesh.normals)):
        if not np.array_equal(rows, rows[first]):
            return f"one place of the input has two {name}"
    return None


def _wrong_cover(corners: Wide, source: Wide, flat: npt.NDArray[np.bool_]) -> str | None:
    """Pieces are turned as their input triangle, and as large together."""
    areas = (np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]).sum(axis=1)
    if (areas <= 0).any():
        return "a piece is turned over, or has no area"
    total = np.zeros(len(flat), dtype=np.int64)
    np.add.at(total, source, areas)
    return None if (total[~flat] == WHOLE**3).all() else "an input triangle is not covered once"


def _wrong_edges(corners: Wide, source: Wide, faces: Wide) -> str | None:
    """Lines within a triangle have two sides; those on its edges are the same for all triangles."""
    # Two of the three coordinates tell a place; a line has the triangle and two places.
    numbers = corners[..., 0] * (WHOLE + 1) + corners[..., 1]
    start, end = numbers.ravel(), np.roll(numbers, -1, axis=1).ravel()
    owner = np.repeat(source, 3)
    line = np.column_stack([owner, np.minimum(start, end), np.maximum(start, end)])
    unique, inverse = np.unique(line, axis=0, return_inverse=True)
    inverse = inverse.reshape(-1)
    along = np.bincount(inverse, weights=start < end, minlength=len(unique)).astype(np.int64)
    against = np.bincount(inverse, weights=start > end, minlength=len(unique)).astype(np.int64)
    if (along > 1).any() or (against > 1).any():
        return "two pieces lie on the same side of a line"
    outer = (along + against == 1)[inverse]
    begin = corners.reshape(-1, 3)[outer]
    finish = np.roll(corners, -1, axis=1).reshape(-1, 3)[outer]
    on_edge = (begin == 0) & (finish == 0)
    if not on_edge.any(axis=1).all():
        return "a line within an input triangle has a piece on one side only (T-junction)"
    # Coordinate k + 2 is zero on the edge from corner k to corner k + 1.
    edge = (on_edge.argmax(axis=1) + 1) % 3
    row = np.arange(len(edge))
    pieces = np.column_stack(
        [owner[outer], edge, begin[row, (edge + 1) % 3], finish[row, (edge + 1) % 3]]
    )
    pieces = pieces[np.lexsort(pieces.T[::-1])]
    is_next = (pieces[1:, :2] == pieces[:-1, :2]).all(axis=1)
    starts_well = np.where(np.r_[False, is_next], np.r_[0, pieces[:-1, 3]], 0) == pieces[:, 2]
    ends_well = np.r_[is_next, True] | (pieces[:, 3] == WHOLE)
    ends_well[:-1] &= is_next | (pieces[:-1, 3] == WHOLE)
    if len(pieces) and not (starts_well.all() and ends_well.all() and pieces[-1, 3] == WHOLE):
        return "the pieces of an edge do not follow one another from corner to corner"
    return _wrong_sides(pieces, faces)


def _wrong_sides(pieces: Wide, faces: Wide) -> str | None:
    """All triangles at an edge have the same pieces of it."""
    a = faces[pieces[:, 0], pieces[:, 1]]
    b = faces[pieces[:, 0], (pieces[:, 1] + 1) % 3]
    is_forward = (a < b)[:, None]
    span = np.where(is_forward, pieces[:, 2:], WHOLE - pieces[:, :1:-1])
    seen = np.column_stack([_edge_numbers(a, b), span])
    unique, counts = np.unique(seen, axis=0, return_counts=True)
    proper = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    edges, sides = np.unique(_edge_numbers(proper, np.roll(proper, -1, axis=1)), return_counts=True)
    is_different = counts != sides[np.searchsorted(edges, unique[:, 0])]
    if is_different.any():
        low, high = divmod(int(unique[is_different.argmax(), 0]), MOST_VERTICES)
        return f"the triangles at edge {low}-{high} split it differently (crack)"
    return None


def _edge_numbers(a: Wide, b: Wide) -> Wide:
    """The same number for an edge from both sides."""
    numbers: Wide = np.minimum(a, b) * MOST_VERTICES + np.maximum(a, b)
    return numbers
