"""When each row of a recording was seen: from timecode, a time stamp, or the number of a frame."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .table import Table
from .take import Array

RATES = (24.0, 25.0, 30.0, 50.0, 60.0, 120.0, 240.0, 1000.0)  # [frames / s]
DEFAULT_RATE = 30.0  # of most cameras
TIMECODE = re.compile(r"(\d{1,3}):(\d{1,2}):(\d{1,2})(?:[:;](\d{1,6}(?:\.\d+)?))?$")
DAY = 86_400.0  # [s]
SHORTEST_STEP = 0.004  # [s] between frames; shorter ones are no seconds
UNITS = (  # shortest step, longest step, of which length [s]; of a time stamp
    (SHORTEST_STEP, 2.5, 1.0, "seconds"),
    (4.0, 2.5e3, 1e-3, "milliseconds"),
    (4e3, 2.5e6, 1e-6, "microseconds"),
    (4e6, 2.5e9, 1e-9, "nanoseconds"),
)
STAMPS = (
    "timestamp", "time", "t", "timestamp_ms", "timestampms", "time_ms", "seconds", "time_s",
    "timestamp_s", "time_sec", "timestampseconds", "timecode", "elapsed", "elapsed_time",
)  # fmt: skip
FRAMES = ("frame", "frame_number", "framenumber", "frame_id", "frameid", "frame_index", "frames")


def times_of(table: Table, rate: float | None, notes: list[str]) -> tuple[Array, set[str]]:
    """Seconds of each row, shape (rows,), NaN where none can be told; and the columns of times.

    rate: frames a second, where the user knows better than the file.
    """
    places = table.places
    column = next((places[name] for name in STAMPS if name in places), None)
    frame = next((places[name] for name in FRAMES if name in places), None)
    used = {name for name in (*STAMPS, *FRAMES) if name in places}
    used.add("approx_time")  # of py-feat: minutes and whole seconds, of no use
    if column is not None:
        cells = table.cells(column)
        if sum(":" in cell for cell in cells[:100]) * 2 > len(cells[:100]):
            return clock_times(cells, rate, notes), used
        if rate is None:
            times = stamp_times(table.numbers([column])[:, 0], notes)
            if times is not None:
                return times, used
    numbers = None if frame is None else table.numbers([frame])[:, 0]
    return frame_times(numbers, len(table.lines), rate, notes), used


def frame_times(numbers: Array | None, count: int, rate: float | None, notes: list[str]) -> Array:
    """Times of frames by their numbers, or one row after the other where they have none."""
    if rate is None:
        rate = DEFAULT_RATE
        if count > 1:
            notes.append(f"No times are given: {rate:g} frames a second were assumed.")
    if count == 1 or numbers is None or not _mostly_rises(numbers):
        return np.arange(count) / rate
    step = np.nanmedian(np.diff(numbers))
    if step > 1.0:
        notes.append(f"Only one in {step:g} frames was recorded.")
    return (numbers - np.nanmin(numbers)) / rate


def stamp_times(stamps: Array, notes: list[str]) -> Array | None:
    """Time stamps in seconds, whatever their unit is; None where they are of no use."""
    if len(stamps) == 1:
        return None
    if not np.isfinite(stamps).any():
        notes.append("The time stamps are no numbers, and were not used.")
        return None
    if not _mostly_rises(stamps):
        notes.append("The time stamps do not rise, and were not used.")
        return None
    steps = np.diff(stamps)
    step = float(np.nanmedian(steps[steps > 0.0]))
    if step in (1.0, 2.0) and np.all(stamps % 1.0 == 0.0):
        notes.append("The time stamps count frames.")
        return None
    for shortest, longest, unit, name in UNITS:
        if shortest <= step < longest:
            if unit != 1.0:
                notes.append(f"Time stamps were read as {name}.")
            return (stamps - np.nanmin(stamps)) * unit
    notes.append(f"The time stamps are {step:g} apart, which no camera is, and were not used.")
    return None


def clock_times(cells: Sequence[str], rate: float | None, notes: list[str]) -> Array:
    """Times of SMPTE timecode, HH:MM:SS:FF.fraction, NaN where a cell has none."""
    parts = np.full((len(cells), 4), np.nan)  # hours, minutes, seconds, frames with their fraction
    for row, cell in enumerate(cells):
        if found := TIMECODE.match(cell):
            parts[row] = [float(part or 0.0) for part in found.groups()]
    numbers, known = parts[:, 3].copy(), np.isfinite(parts[:, 0])
    if not known.any():
        return numbers
    seconds = np.unwrap(parts[known, :3] @ (3600.0, 60.0, 1.0), period=DAY)  # also over midnight
    highest = int(numbers[known].max())
    base = next((each for each in RATES if each > highest), highest + 1.0)
    if rate is None and np.ptp(seconds) > 0.0:
        notes.append(f"Timecode of {base:g} frames a second, as it counts to {highest}.")
    elif rate is None and len(cells) > 1:
        base = max(base, 60.0)
        notes.append(f"Less than a second of timecode: {base:g} frames a second were assumed.")
    numbers[known] += seconds * base
    if not _mostly_rises(numbers):
        notes.append("The timecode stands still, and was not used.")
        return frame_times(None, len(cells), rate or base, notes)
    return numbers / (rate or base)


def _mostly_rises(values: Array) -> bool:
    """Whether more than half of the steps go up."""
    steps: npt.NDArray[np.bool_] = np.diff(values) > 0.0
    return len(values) == 1 or 2 * int(steps.sum()) > len(steps)
