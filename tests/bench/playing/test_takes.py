"""The measurement of long recordings measures what a phone could have written."""

from __future__ import annotations

from pathlib import Path

import pytest

from risorius.app.performances import read_performance
from risorius.app.recordings import read_take
from risorius.app.recordings.names import ARKIT, EYE_ANGLES, HEAD_ANGLES
from risorius.bench.playing import takes


def test_the_made_up_recording_is_read_whole(tmp_path: Path) -> None:
    """Every shape and angle moves, sixty times a second, beyond a minute."""
    path = tmp_path / "take.csv"
    path.write_text(takes.made_up(1.05), encoding="utf-8")
    take = read_take(path)
    assert take.kind == "Live Link Face" and not take.unknown
    assert len(take.times) == 3780 and take.duration == pytest.approx(3779 / 60, abs=1e-3)
    assert set(take.channels) == {*ARKIT, *HEAD_ANGLES, *EYE_ANGLES}
    assert all(values.std() > 0.001 for values in take.channels.values())


def test_it_trembles_as_a_phones_does(tmp_path: Path) -> None:
    """Many samples become keys of the script, and not all."""
    path = tmp_path / "take.csv"
    path.write_text(takes.made_up(0.5), encoding="utf-8")
    script, _ = read_performance(path)
    assert len(script.tracks) > 50
    keys = sum(map(len, script.tracks.values()))
    assert 0.1 < keys / (1800 * len(script.tracks)) < 0.4


def test_every_stage_is_told() -> None:
    """A line for each, under what was measured."""
    lines = takes.report(0.1).splitlines()
    assert lines[0].startswith("0.1 minutes: 360 frames")
    assert [line.split("  ")[1] for line in lines[2:]] == [
        "read the file", "calibrate, map, thin", "both", "values of one frame"
    ]  # fmt: skip
    assert all(float(line.split()[-1]) >= 0.0 for line in lines[2:])
