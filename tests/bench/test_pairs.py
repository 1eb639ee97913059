"""`risorius bench refine --threads` and `--matrix` time both methods of each pair."""

import numpy as np
import pytest

from risorius.app.errors import UserError
from risorius.bench import pairs
from tests.app.command_line import refusal, risorius


def test_pairs_by_threads(monkeypatch):
    """Each rule has a row whose gain fits its times.

    Afterwards the number of threads is restored.
    """
    monkeypatch.setattr(pairs.threads, "THREAD_COUNT", 2)
    rows = pairs.by_threads(["2k"], 0.1)
    assert [row.method for row in rows] == ["paper's rule", "window's look"]
    for row in rows:
        assert abs(row.triangles - 2000) < 100
        assert 0.0 < row.first < 1000.0
        assert 0.1 < row.gain < 10.0
    assert pairs.threads.THREAD_COUNT == 2
    assert "by 2, in pairs" in pairs.report_of_threads(rows)


def test_one_thread_has_no_pair(monkeypatch):
    """With one thread, one line explains how to get more."""
    monkeypatch.setattr(pairs.threads, "THREAD_COUNT", 1)
    with pytest.raises(UserError, match="NUMBA_NUM_THREADS=2"):
        pairs.by_threads(["2k"], 0.1)


@pytest.mark.parametrize("option", ["--threads", "--matrix"])
def test_a_card_has_no_pairs(option):
    """For a graphics card the error is one line with the options that exclude each other."""
    line = refusal(risorius("bench", "refine", option, "--refiner", "kahler-gl"))
    assert line.startswith(f"risorius: {option} needs --refiner kahler")


def test_a_plain_loop_is_the_product():
    """The compared numba kernel computes the same product."""
    starts = np.array([0, 2, 3])
    columns = np.array([0, 2, 1])
    weights = np.array([0.25, 0.75, 2.0])
    positions = np.arange(9.0).reshape(3, 3)
    out = np.zeros((2, 3))
    pairs.multiply_plainly(starts, columns, weights, positions, out)
    assert out.tolist() == [[4.5, 5.5, 6.5], [6.0, 8.0, 10.0]]


def test_pairs_by_matrix():
    """Each compared method has a row, and its gain fits its times."""
    pytest.importorskip("igl")
    rows = pairs.by_matrix(["2k"], 0.1)
    assert [row.method for row in rows] == ["libigl, loop_matrix", "numba, a plain loop"]
    for row in rows:
        assert abs(row.triangles - 2000) < 100
        assert 0.05 < row.gain < 20.0
    assert "a kept Loop matrix without normals" in pairs.report_of_matrix(rows)
