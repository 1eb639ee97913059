"""`risorius bench refine --matrix` multiplies correctly, and times both methods of each pair."""

import numpy as np
import pytest

from risorius.bench import matrices


def test_a_plain_loop_is_the_product():
    """The compared numba kernel computes the same product."""
    starts = np.array([0, 2, 3])
    columns = np.array([0, 2, 1])
    weights = np.array([0.25, 0.75, 2.0])
    positions = np.arange(9.0).reshape(3, 3)
    out = np.zeros((2, 3))
    matrices.multiply_plainly(starts, columns, weights, positions, out)
    assert out.tolist() == [[4.5, 5.5, 6.5], [6.0, 8.0, 10.0]]


def test_pairs():
    """Each compared method has a row, and its gain fits its times."""
    pytest.importorskip("igl")
    rows = matrices.measure(["2k"], 0.1)
    assert [row.method for row in rows] == ["libigl, loop_matrix", "numba, a plain loop"]
    for row in rows:
        assert abs(row.triangles - 2000) < 100
        assert 0.05 < row.gain < 20.0
    assert "a kept Loop matrix without normals" in matrices.report(rows)
