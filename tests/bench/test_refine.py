"""The benchmark of the refiners measures what its documentation states."""

import gc

import pytest

from risorius.bench import refine
from tests.refine_gl.agreement import why_no_card


@pytest.mark.slow
def test_rows():
    """The requested fraction of edges is split, and the times of a row fit together."""
    rows = {row.method: row for row in refine.measure(["2k"], 0.05)}
    count = rows["kahler 10 %"].triangles_in
    assert abs(count - 2_000) < 100
    by_share = [rows[f"kahler {share} %"].triangles_out / count for share in (10, 50, 100)]
    assert 1.2 < by_share[0] < 2.0 < by_share[1] < 4.0 < by_share[2] < 7.0
    for row in rows.values():
        assert 0.0 < row.best_milliseconds <= row.milliseconds
    assert gc.isenabled()


def test_rows_of_the_card():
    """Both methods are timed on the processor and on the card, and the report names the card."""
    if reason := why_no_card():
        pytest.skip(reason)
    rows = refine.measure(["2k"], 0.05, on_card=True)
    titles = "paper's rule", "window's look"
    assert [row.method for row in rows] == [
        f"{refiner}, {title}" for title in titles for refiner in ("kahler", "kahler-gl")
    ]
    assert all(0.0 < row.best_milliseconds <= row.milliseconds for row in rows)
    assert "\nkahler-gl: on " in refine.report(rows)


def test_calls_are_timed_in_turn():
    """Calls are timed forwards, then backwards, and no garbage is collected in between."""
    order = []
    calls = [lambda name=name: order.append(f"{name}{gc.isenabled():d}") for name in "ab"]
    assert refine.interleaved(calls, 2).shape == (2, 2)
    assert order == ["a0", "b0", "b0", "a0"]
    assert gc.isenabled()
