"""The report on a played take: its kind, and the channels that move the face.

The first line has the kind. A few short, aligned lines follow, one screen at most.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..text import counted, in_one_line
from .calibration import Calibration
from .mapping import chosen
from .names import ANGLE_NAMES, ARKIT_SHAPES
from .take import Take


@dataclass(frozen=True)
class Report:
    """A report. recognised: first line without the file name. rows: headings and texts."""

    source: str
    recognised: str
    rows: tuple[tuple[str, str], ...]

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on values that were guessed, skipped or left out."""
        return tuple(text for heading, text in self.rows if heading == "note")

    @property
    def lines(self) -> tuple[str, ...]:
        """The whole report in lines for a terminal."""
        wide = max((len(heading) for heading, _ in self.rows), default=0)
        shown = [f"{in_one_line(self.source)}: {self.recognised}"]
        width = 100  # [characters] of a line
        most_lines = 3  # below one heading
        for heading, text in self.rows:
            start = f"  {heading:<{wide}}  "
            shown += textwrap.wrap(
                in_one_line(text),
                width,
                initial_indent=start,
                subsequent_indent=" " * len(start),
                max_lines=most_lines,
                placeholder=" ...",
                break_on_hyphens=False,
            )
        return tuple(shown)

    @property
    def in_brief(self) -> str:
        """The whole report in one line, for the window's message."""
        name = Path(self.source).name
        count = len(self.notes)
        return f"{name}: {self.recognised}" + (f"; {counted(count, 'note')}" if count else "")


def report_of(take: Take, calibration: Calibration) -> Report:
    """Return the report on a take."""
    channels = take.channels
    still = _constant_channels(take)
    shapes = [name for name in ARKIT_SHAPES if name in channels]
    rows = [
        ("used", _used(set(chosen(channels)) - still)),
        ("neutral", _neutral(calibration)),
        ("constant", _listed(still)),
        ("missing", _listed(name for name in ARKIT_SHAPES if shapes and name not in channels)),
        ("unknown", _listed(take.unknown)),
        *(("note", note) for note in take.notes),
    ]
    return Report(take.source, _recognised(take), tuple(row for row in rows if row[1]))


def _recognised(take: Take) -> str:
    """Return a text on the kind and size of a take."""
    calibrated = ", calibrated" if take.is_calibrated else ""
    count = len(take.times)
    if count == 1:
        return f"{take.kind}{calibrated}, one frame"
    if take.has_keys:
        return f"{take.kind}{calibrated}, {count} keys in {take.duration:.2f} s"
    rate = 1.0 / float(np.median(np.diff(take.times)))
    return f"{take.kind}{calibrated}, {count} frames in {take.duration:.2f} s, {rate:.4g} a second"


def _constant_channels(take: Take) -> set[str]:
    """Return the channels that never change; for a single frame, the channels at 0."""
    if len(take.times) == 1:
        return {name for name, values in take.channels.items() if not values.any()}
    return {name for name, values in take.channels.items() if not np.ptp(values)}


def _used(names: set[str]) -> str:
    kinds = {
        "of ARKit's shapes": {name for name in names if name in ARKIT_SHAPES},
        "of the action units": {name for name in names if name.startswith("AU")},
        "of the visemes": {name for name in names if name.startswith("viseme")},
        "of the head's angles": {name for name in names if name.startswith("head_")},
        "of the eyes' angles": {name for name in names if name.startswith("eye_")},
    }
    counts = [f"{len(found)} {kind}" for kind, found in kinds.items() if found]
    return ", ".join(counts) or "nothing: no channel ever changes"


def _neutral(calibration: Calibration) -> str:
    """Return a text on how far the neutral face is from 0, and in which channels."""
    slight_value = 0.02  # of a neutral channel, too small for the report
    neutral = {
        name: abs(value)
        for name, value in calibration.neutral.items()
        if name not in ANGLE_NAMES and abs(value) > slight_value
    }
    if not neutral:
        return ""
    most_named = 5  # of neutral channels
    furthest = sorted(neutral, key=lambda name: -neutral[name])[:most_named]
    most = f"by up to {neutral[furthest[0]]:.2g}; most {_listed(furthest)}"
    return f"{counted(len(neutral), 'channel')} above 0 at rest, {most}"


def _listed(names: Iterable[str]) -> str:
    """Join names to a text, with the two sides of a name in one word."""
    listed = sorted(names)
    words: list[str] = []
    for name in listed:
        other = name.removesuffix("Left") + "Right"
        if name.endswith("Left") and other in listed:
            words.append(name.removesuffix("Left") + "Left/Right")
        elif not (name.endswith("Right") and name.removesuffix("Right") + "Left" in listed):
            words.append(name)
    return " ".join(words)
