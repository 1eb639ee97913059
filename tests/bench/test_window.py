"""Output of `risorius bench window`."""

import os

import pytest

from risorius.assets.coarse import coarse_head
from risorius.bench import window
from tests.app.command_line import refusal, risorius

pytestmark = [
    pytest.mark.window,
    pytest.mark.slow,
    pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="needs a display"),
]


def test_the_window_is_timed(monkeypatch):
    """`risorius bench window` plays each case, and reports the load of an idle window."""
    monkeypatch.setattr(window, "IDLE_SECONDS", 0.1)
    monkeypatch.setattr(window, "WARM_UP", 0.02)
    table, targets = window.measure(0.1, (640, 400))
    assert ", 2030 triangles," in table
    rates = [float(line[30:39]) for line in table.splitlines() if line.startswith("smile")]
    assert len(rates) == 5
    assert min(rates) > 0.0
    assert len(targets) in (0, 4)  # 4 where drawing is by software
    assert "Nothing moves:" in table
    assert "% of a core" in table


def test_a_head_of_the_users_is_timed(monkeypatch):
    """The report names the triangles of a user's head, without a target.

    Landmarks alone are refused.
    """
    monkeypatch.setattr(window, "IDLE_SECONDS", 0.1)
    monkeypatch.setattr(window, "WARM_UP", 0.02)
    head = coarse_head()
    table, targets = window.measure(0.1, (640, 400), head)
    assert f", {len(head.faces)} triangles," in table
    assert not targets
    line = refusal(risorius("bench", "window", "--landmarks", __file__))
    assert line.startswith("risorius: --landmarks needs --head")
