"""`risorius bench refine --threads` times both methods of each pair, for some thread counts."""

import pytest

from risorius.app.errors import UserError
from risorius.bench import threads
from tests.app.command_line import refusal, risorius


def test_pairs(monkeypatch):
    """Each rule has a row whose gain fits its times.

    Afterwards the number of threads is restored.
    """
    monkeypatch.setattr(threads.threads, "THREAD_COUNT", 2)
    rows = threads.measure(["2k"], 0.1)
    assert [row.method for row in rows] == ["paper's rule", "window's look"]
    for row in rows:
        assert abs(row.triangles - 2000) < 100
        assert 0.0 < row.first < 1000.0
        assert 0.1 < row.gain < 10.0
    assert threads.threads.THREAD_COUNT == 2
    assert "by 2, in pairs" in threads.report(rows)


def test_one_thread_has_no_pair(monkeypatch):
    """With one thread, one line says how to get more."""
    monkeypatch.setattr(threads.threads, "THREAD_COUNT", 1)
    with pytest.raises(UserError, match="NUMBA_NUM_THREADS=2"):
        threads.measure(["2k"], 0.1)


@pytest.mark.parametrize("pairs", ["--threads", "--matrix"])
def test_a_card_has_no_pairs(pairs):
    """For a graphics card the error is one line with the options that exclude each other."""
    line = refusal(risorius("bench", "refine", pairs, "--refiner", "kahler-gl"))
    assert line.startswith(f"risorius: {pairs} needs --refiner kahler")
