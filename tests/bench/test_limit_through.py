"""Limit surfaces through the vertices."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.bench.limit_through import (
    LimitThrough,
    MendedLimit,
    MendedLimitScheme,
    border_corners,
    edge_points,
)
from risorius.bench.subjects import vertex_normals
from tests import meshes

Points = npt.NDArray[np.float64]


def uneven_sheet(height: float = 0.0) -> tuple[npt.NDArray[np.int32], Points]:
    """A sheet of triangles of many sizes, flat or on a paraboloid: triangles and vertices."""
    mesh = meshes.open_grid(7, 7)
    points = mesh.vertices.astype(np.float64)
    points[:, :2] += np.random.default_rng(5).uniform(-0.25, 0.25, (len(points), 2))
    x, y = points[:, 0] - 3.5, points[:, 1] - 3.5
    points[:, 2] = height * (x * x + 0.5 * x * y + 0.7 * y * y)
    return mesh.faces, points


def test_through_the_vertices() -> None:
    """Both surfaces pass through the vertices; corners of the border stay in every level."""
    faces, points = uneven_sheet(0.05)
    corners = border_corners(faces, points)
    assert set(corners) >= {0, 7, 56, 63}
    for surface in (LimitThrough(faces, points, 2), MendedLimit(faces, points, 2)):
        found, normals, triangles = surface.mesh(points)
        assert len(triangles) == 16 * len(faces)
        np.testing.assert_allclose(found[: len(points)], points, atol=1e-9)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    through = LimitThrough(faces, points, 2)
    own, found = through.mesh(points)[1], through.mesh_with_normals(points)[1]
    assert np.degrees(np.arccos(np.einsum("ni,ni->n", own, found).clip(-1.0, 1.0))).mean() < 8.0


def test_mended_finds_quadratics() -> None:
    """Of a flat uneven sheet that bends, heights inside are near those of the paraboloid."""
    faces, flat = uneven_sheet()
    bent = uneven_sheet(0.01)[1]
    inside = (np.abs(flat[:, :2] - 3.5) < 2.0).all(axis=1)
    mended = MendedLimit(faces, flat, 1)
    rows = np.flatnonzero((mended.spread[:, ~inside].getnnz(axis=1) == 0)[len(flat) :]) + len(flat)
    assert len(rows) > 20
    places = (mended.spread @ flat)[rows] - [3.5, 3.5, 0.0]
    x, y = places[:, 0], places[:, 1]
    wanted = 0.01 * (x * x + 0.5 * x * y + 0.7 * y * y)
    straight = (mended.spread @ bent)[rows, 2]
    # Along the upright, whatever the normals.
    found = straight + (mended.offsets @ bent)[rows, 2]
    assert np.abs(found - wanted).max() < 0.2 * np.abs(straight - wanted).max()


def test_scheme_places_the_same_points() -> None:
    """Split twice everywhere, the scheme's points on edges are those of two levels."""
    faces, points = uneven_sheet(0.05)
    mesh = refine.connect(faces, len(points))
    whole = MendedLimit(faces, points, 2)
    rows = edge_points(mesh)
    places = whole.spread @ points
    start, end = points[mesh.edges[:, 0]], points[mesh.edges[:, 1]]
    np.testing.assert_allclose(places[rows[:, 0]], 0.75 * start + 0.25 * end, atol=1e-12)
    np.testing.assert_allclose(places[rows[:, 1]], 0.5 * (start + end), atol=1e-12)
    np.testing.assert_allclose(places[rows[:, 2]], 0.25 * start + 0.75 * end, atol=1e-12)

    refiner = refine.create(
        "kahler", faces, points, scheme=MendedLimitScheme(), criterion=Everywhere(), blend=False
    )
    found = refiner.refine(points)
    refine.check(refiner, found, points)
    expected = whole.mesh(points)[0][rows.ravel()]
    got = found.positions[len(points) :].reshape(-1, 3)
    np.testing.assert_allclose(got, expected, atol=1e-5)
    assert (
        np.einsum("ni,ni->n", found.normals[: len(points)], vertex_normals(points, faces)).min()
        > 0.8
    )


class Everywhere:
    """Splits every edge twice."""

    def bind(self, connectivity: object, rest: object, rest_normals: object) -> None:
        """Need nothing of the mesh."""

    def mark(self, positions: object, normals: object, splits: npt.NDArray[np.uint8]) -> None:
        """Write 2 for every edge."""
        splits[:] = 2
