"""What `risorius bench script` prints."""

from __future__ import annotations

import os

import numpy as np
import pytest

from risorius.app.script import TOLERANCE
from risorius.bench import script

WITHOUT = ("thin all samples", "read the file", "values of a frame")
WITH = ("a frame while scrubbing", "the panels of a frame", "select a fifth of all keys", "undo")


def times_in(text: str, whats: tuple[str, ...]) -> list[float]:
    """The medians of some rows [ms]."""
    lines = text.splitlines()
    found = [line for what in whats for line in lines if line.startswith(f"{what}  ")]
    assert len(found) == len(whats), text
    return [float(line[44:55]) for line in found]


def test_a_take_is_timed_without_a_screen() -> None:
    """From samples to the values of a frame; that there is no window is said."""
    text = script.report((640, 400), 0.05, has_screen=False)
    assert min(times_in(text, WITHOUT)) > 0.0
    assert "A take of 0.05 minutes, 60 channels at 60 Hz" in text and "no screen" in text


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


def test_the_take_is_like_a_recorded_one() -> None:
    """Values of controls, with so much noise that many samples become keys, and not all."""
    times, channels = script.recorded(["one", "other"], 0.5)
    take = script.take_script(times, channels)
    assert not np.array_equal(channels["one"], channels["other"])
    for name, values in channels.items():
        assert 0.0 <= values.min() < 0.05 and 0.5 < values.max() <= 1.0
        played = [take.tracks[name].value(time) for time in times.tolist()]
        assert np.abs(np.array(played) - values).max() < 1.1 * TOLERANCE
        assert 0.1 < len(take.tracks[name]) / len(times) < 0.5
