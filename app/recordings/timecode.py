"""Timecode, which counts frames after the seconds: `10:32:09:07.867`; drop-frame has `;`.

Source: SMPTE 12M.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from risorius.geometry.arrays import Floats64

from .row_times import DAY_LENGTH, frame_times, mostly_rises, spread

TIMECODE_FORM = re.compile(r"(\d{1,3}):(\d{1,2}):(\d{1,2})([:;])(\d{1,6}(?:\.\d+)?)$")


def timecode_times(cells: Sequence[str], rate: float | None, notes: list[str]) -> Floats64:
    """Convert timecode, HH:MM:SS:FF.fraction, to times [s]; NaN for a cell without timecode.

    rate: frames a second from the user; it is used if the timecode agrees.
    """
    parts = np.full((len(cells), 4), np.nan)  # hours, minutes, seconds, frames with their fraction
    has_semicolon = False
    for row, cell in enumerate(cells):
        if found := TIMECODE_FORM.match(cell):
            parts[row] = [float(part) for part in found.group(1, 2, 3, 5)]
            has_semicolon = has_semicolon or found[4] == ";"
    numbers = parts[:, 3].copy()
    known = np.isfinite(numbers)
    clock = parts[known, :3] @ (3600.0, 60.0, 1.0)
    seconds = np.unwrap(clock, period=DAY_LENGTH)  # also over midnight
    base, is_sure = _base_of(seconds, numbers[known])
    pace = base  # true frames a second: 29.97 for a timecode that counts to 30
    if rate is not None:
        if not is_sure and round(rate) > numbers[known].max():
            base = float(round(rate))
        ntsc_tolerance = 0.0025  # 29.97 is a thousandth less than 30, 23.976 than 24
        is_agreed = abs(rate / base - 1.0) < ntsc_tolerance
        pace = rate if is_agreed else base
        if not is_agreed:
            notes.append(
                f"The timecode counts {base:g} frames a second; {rate:g} was not used for it."
            )
    elif np.ptp(seconds) > 0.0:
        highest = int(numbers[known].max())
        notes.append(f"Timecode of {base:g} frames a second, as it counts to {highest}.")
    elif len(cells) > 1:
        base = pace = max(base, 60.0)
        notes.append(f"Less than a second of timecode: {base:g} frames a second were assumed.")
    is_dropping = has_semicolon or _jumps_at_minutes(seconds, numbers[known], base)
    dropped = _dropped_per_minute(parts[known], base) if is_dropping else 0
    numbers[known] += seconds * base
    if dropped:
        minutes = seconds // 60.0
        numbers[known] -= dropped * (minutes - minutes // 10.0)
        if pace == base:
            pace = base / 1.001
        notes.append(f"Timecode drops frames: it runs at {pace:.4g} a second.")
    numbers = spread(numbers, notes)
    if not mostly_rises(numbers):
        notes.append("The timecode stands still, and was not used.")
        return frame_times(None, len(cells), rate or base, notes)
    return numbers / pace


def _base_of(seconds: Floats64, numbers: Floats64) -> tuple[float, bool]:
    """Return how many frames timecode counts in a second, and whether the data prove it.

    seconds: whole seconds, shape (T,). numbers: frame numbers within the second, shape (T,). From
    one second to the next, the number falls by this count minus the usual step.
    """
    highest = float(numbers.max())
    rates = (  # [frames / s], as timecode counts them
        24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 72.0, 75.0, 90.0, 100.0, 120.0, 144.0, 240.0, 1000.0
    )  # fmt: skip
    usual = next((rate for rate in rates if rate > int(highest)), int(highest) + 1.0)
    steps = np.diff(numbers)
    turns = np.diff(seconds)
    within = steps[(turns == 0.0) & (steps > 0.0)]
    over = steps[turns == 1.0]
    if not within.size or not over.size:
        return usual, False
    counts = np.median(within) - over
    count = float(round(float(np.median(counts))))
    fraction = float(np.mean(np.abs(counts - count) < 0.25))
    if len(counts) > 1 and fraction > 0.6 and count > int(highest):
        return count, True
    fitting = [rate for rate in rates if int(highest) < rate and abs(count / rate - 1.0) < 0.04]
    return min(fitting, key=lambda rate: abs(rate - count), default=usual), True


def _dropped_per_minute(parts: Floats64, base: float) -> int:
    """Return how many frame numbers timecode leaves out at a minute; 0 if the file has them.

    parts: hours, minutes, seconds, frames, shape (T, 4). Every tenth minute has all numbers.
    """
    if base % 30.0 != 0.0:
        return 0
    dropped = 2 * int(base // 30.0)
    is_other_minute = parts[:, 1] % 10.0 != 0.0
    is_there = is_other_minute & (parts[:, 2] == 0.0) & (parts[:, 3] < dropped)
    return 0 if is_there.any() else dropped


def _jumps_at_minutes(seconds: Floats64, numbers: Floats64, base: float) -> bool:
    """Whether most minutes lack the frame numbers that drop-frame timecode leaves out.

    seconds: whole seconds, shape (T,). numbers: frame numbers within the second, shape (T,).
    """
    steps = np.diff(seconds * base + numbers)
    minutes = seconds // 60.0
    is_turn = (np.diff(minutes) == 1.0) & (minutes[1:] % 10.0 != 0.0)
    if base % 30.0 != 0.0 or not is_turn.any():
        return False
    missing = np.median(steps[is_turn]) - np.median(steps[steps > 0.0])
    return bool(abs(missing - base // 15.0) < 0.5)


def with_colons(cells: list[str]) -> list[str]:
    """Return timecode with a colon before the frames, even if the file has a point there.

    Two digits after the point are usually hundredths of a second. If there are at least 24 numbers,
    and none reaches 60, they count frames.
    """
    if not cells or not all(re.fullmatch(r"\d+:\d+:\d+\.\d\d", cell) for cell in cells if cell):
        return cells
    numbers = {cell[-2:] for cell in cells if cell}
    seconds = {cell[:-3] for cell in cells if cell}
    if len(seconds) < 3 or len(numbers) < 24 or max(numbers) >= "60":
        return cells
    return [f"{cell[:-3]}:{cell[-2:]}" if cell else "" for cell in cells]
