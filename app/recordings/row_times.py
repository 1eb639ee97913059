"""Times of rows from frame numbers, and different times for rows with equal time stamps."""

from __future__ import annotations

import numpy as np

from risorius.geometry.arrays import Flags, Floats64

DAY_LENGTH = 86_400.0  # [s]


def frame_times(
    numbers: Floats64 | None,
    count: int,
    rate: float | None,
    notes: list[str],
    *,
    has_stamps: bool = False,
) -> Floats64:
    """Return times of frames [s] from their numbers; without numbers rows are consecutive frames.

    has_stamps: whether the file has unusable time stamps, which an earlier note reports.
    """
    if rate is None:
        default_rate = 30.0  # [frames/s], the rate of most cameras
        rate = default_rate
        if count > 1:
            why = "Instead" if has_stamps else "No times are given:"
            notes.append(f"{why} {rate:g} frames a second were assumed.")
    if count == 1 or numbers is None or not mostly_rises(numbers):
        return np.arange(count) / rate
    step = np.nanmedian(np.diff(numbers))
    if step > 1.0:
        notes.append(f"Only one in {step:g} frames was recorded.")
    return (numbers - np.nanmin(numbers)) / rate


def spread(values: Floats64, notes: list[str]) -> Floats64:
    """Spread values that repeat over several rows evenly, so that each row has its own value.

    Rows share a time if a clock counts whole seconds, or if timecode counts 30 frames a second for
    60 rows.
    """
    known = np.isfinite(values)
    there = values[known]
    starts = np.flatnonzero(np.diff(there, prepend=-np.inf) != 0.0)
    lengths = np.diff(starts, append=len(there))
    jumps = np.diff(there[starts])
    if not (jumps > 0.0).any() or np.median(lengths) < 2.0:
        return values
    usual = float(np.median(lengths))
    quantum = float(np.median(jumps[jumps > 0.0]))
    place = np.arange(len(there)) - np.repeat(starts, lengths).astype(np.float64)
    place[: lengths[0]] += max(usual - lengths[0], 0.0)  # the first group may begin before the file
    whole_lengths = np.maximum(lengths, usual)
    found = values.copy()
    found[known] = there + quantum * place / np.repeat(whole_lengths, lengths)
    notes.append(f"About {usual:g} rows have the same time, and were spread evenly.")
    return found


def mostly_rises(values: Floats64) -> bool:
    """Whether more than half of the steps go up."""
    steps: Flags = np.diff(values) > 0.0
    return len(values) == 1 or 2 * int(steps.sum()) > len(steps)
