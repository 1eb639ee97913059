"""What `risorius bench window` prints."""

import os

import pytest

from risorius.bench import window

pytestmark = [
    pytest.mark.window,
    pytest.mark.slow,
    pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="needs a display"),
]


def test_the_window_is_timed(monkeypatch):
    """`risorius bench window` plays each case, and reports the load of the idle window."""
    monkeypatch.setattr(window, "IDLE_SECONDS", 0.1)
    monkeypatch.setattr(window, "WARM_UP", 0.02)
    table, targets = window.measure(0.1, (640, 400))
    rates = [float(line[30:39]) for line in table.splitlines() if line.startswith("smile")]
    assert len(rates) == 5
    assert min(rates) > 0.0
    assert len(targets) in (0, 4)  # where software draws
    assert "Nothing moves:" in table
    assert "% of a core" in table
