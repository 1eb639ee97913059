"""Large meshes in a careless order: the same mesh, with neighbours beside each other."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import refine
from tests import meshes


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_same_mesh_in_another_order(seed: int) -> None:
    """Every triangle is there once, with its corners in their turn, and every vertex once."""
    random = np.random.default_rng(seed)
    count = int(random.integers(1, 40))
    positions = random.normal(size=(count, 3))
    faces = random.integers(0, count, (int(random.integers(0, 60)), 3))
    order = refine.reorder(faces, positions)
    assert sorted(order.vertices) == list(range(count))
    assert sorted(order.triangles) == list(range(len(faces)))
    assert (order.vertices[order.faces] == faces[order.triangles]).all()


def test_refined_alike() -> None:
    """A refiner makes the same triangles of the reordered mesh, and `source` leads back."""
    mesh = meshes.irregular(4)
    deformed = meshes.wrinkled(mesh, 2)
    plain = refine.create("kahler", mesh.faces, mesh.vertices).refine(deformed)
    order = refine.reorder(mesh.faces, mesh.vertices)
    refiner = refine.create("kahler", order.faces, mesh.vertices[order.vertices])
    other = refiner.refine(deformed[order.vertices])

    def corners(refined: refine.RefinedMesh, source: np.ndarray) -> list[tuple[float, ...]]:
        """Input triangle and places of each subtriangle, in an order of their own."""
        places = refined.positions[refined.triangles].round(5) + 0.0
        return sorted(
            (int(t), *(x for point in sorted(map(tuple, corner.tolist())) for x in point))
            for t, corner in zip(source, places, strict=True)
        )

    np.testing.assert_allclose(
        corners(other, order.triangles[other.source]), corners(plain, plain.source), atol=3e-5
    )


def test_neighbours_come_to_lie_together() -> None:
    """In a shuffled grid the vertices of a triangle are near each other afterwards."""
    grid = meshes.open_grid(60, 60)
    random = np.random.default_rng(1)
    places = random.permutation(len(grid.vertices))
    vertices = np.empty_like(grid.vertices)
    vertices[places] = grid.vertices
    faces = places[grid.faces][random.permutation(len(grid.faces))]
    order = refine.reorder(faces, vertices)
    before, after = (np.ptp(each, axis=1).mean() for each in (faces, order.faces))
    assert after * 20 < before
