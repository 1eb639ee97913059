"""What `risorius bench script` prints."""

from __future__ import annotations

import os

import pytest

from risorius.bench import script

WITHOUT = ("read the file", "values of the first frame", "values of a frame")
WITH = ("a frame while scrubbing", "the panels of a frame", "select a fifth of all keys", "undo")


def times_in(text: str, whats: tuple[str, ...]) -> list[float]:
    """The medians of some rows [ms]."""
    lines = text.splitlines()
    found = [line for what in whats for line in lines if line.startswith(f"{what}  ")]
    assert len(found) == len(whats), text
    return [float(line[44:55]) for line in found]


def test_a_take_is_timed_without_a_screen() -> None:
    """From the file to the values of a frame; that there is no window is said."""
    text = script.report((640, 400), 0.05, has_screen=False)
    assert min(times_in(text, WITHOUT)) > 0.0
    assert "A take of 0.05 minutes, " in text and "no screen" in text


@pytest.mark.window
@pytest.mark.slow
@pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="needs a display")
def test_a_take_is_timed_in_the_window(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames and edits, too; nothing that is promised is missing."""
    monkeypatch.setattr(script, "FRAMES", 2)
    text = script.report((640, 400), 0.2, has_screen=True)
    assert min(times_in(text, (*WITHOUT, *WITH))) > 0.0
    promised = [line for line in text.splitlines() if line.endswith(("3000.0", " 0.2", " 50.0"))]
    assert len(promised) == 8
