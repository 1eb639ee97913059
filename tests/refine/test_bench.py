"""The benchmark of the refiners measures what it says."""

from __future__ import annotations

import gc

import numpy as np
import pytest

import bench.refine
from tests import meshes


def test_rows() -> None:
    """One row per method with the triangles that this method gives, and times that fit."""
    mesh = meshes.irregular(1)
    frames = [meshes.wrinkled(mesh, seed) for seed in range(3)]
    rows = bench.refine.run(mesh.faces, mesh.vertices, frames, rounds=3)
    assert [row.refiner for row in rows] == ["none", "kahler", "loop", "loop"]
    count = len(mesh.faces)
    assert [row.triangles_out for row in rows[::2]] == [count, 4 * count]
    assert count < rows[1].triangles_out <= rows[1].triangles_most <= 10 * count
    assert rows[3].triangles_most == 16 * count
    for row in rows:
        assert 0.0 < row.best_milliseconds <= row.milliseconds
        assert np.isclose(row.nanoseconds_per_triangle * row.triangles_out, 1e6 * row.milliseconds)
    assert gc.isenabled()


@pytest.mark.parametrize(("frame_count", "rounds"), [(0, 3), (1, 0)])
def test_nothing_to_measure(frame_count: int, rounds: int) -> None:
    """Without frames or rounds there is an error and no division by zero."""
    mesh = meshes.octahedron()
    with pytest.raises(ValueError, match="at least one frame and one round are needed, got"):
        bench.refine.run(mesh.faces, mesh.vertices, [mesh.vertices] * frame_count, rounds=rounds)
