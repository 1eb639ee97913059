"""The last step of every reader: sort rows by time, and fill gaps in channels.

While a face is out of sight, the last visible pose is held; in the last 0.3 s before the face is
seen again, a straight line leads to the next pose. A shorter gap is one straight line. So no motion
is invented, and no value jumps. Missing rows are filled in the same way.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from risorius.geometry.arrays import Floats64, Integers64

from ..errors import UserError
from ..text import counted
from .names import measured
from .take import Take

SHORT_GAP = 0.3  # [s]; a gap up to this is bridged by a straight line


def take_from_rows(
    kind: str,
    source: str,
    times: Floats64,
    channels: Mapping[str, Floats64],
    *,
    notes: Sequence[str] = (),
    unknown: Sequence[str] = (),
    is_calibrated: bool = False,
    has_keys: bool = False,
) -> Take:
    """Make a Take from rows that may be out of order, and channels that may have NaN.

    times: [s], shape (T,). channels: name -> shape (T,). has_keys: whether rows are keys, which may
    be far apart. Raises UserError if no row has a face and a time.
    """
    all_notes = list(notes)
    channels = {name: measured(name, values) for name, values in channels.items()}
    channels = {name: values for name, values in channels.items() if np.isfinite(values).any()}
    if not channels:
        raise UserError(f"{source}: {kind}: no frame shows a face; nothing can be played")
    kept = _rows_in_order(times, f"{source}: {kind}")
    if len(kept) < len(times):
        all_notes.append(_note_on_rows_left_out(len(times) - len(kept)))
    times = times[kept] - times[kept[0]]
    rows = {name: values[kept] for name, values in channels.items()}
    seen = np.any([np.isfinite(values) for values in rows.values()], axis=0)
    if not seen.all():
        all_notes.append(
            f"No face in {int((~seen).sum())} of {len(seen)} frames: the last pose is held there."
        )
    holes = np.empty(0, dtype=np.intp) if has_keys else _gap_rows(times)
    if len(holes):
        all_notes.append(_gap_sentence(np.diff(times)[holes]))
        times = np.insert(times, holes + 1, times[holes + 1] - SHORT_GAP)
        rows = {name: np.insert(values, holes + 1, np.nan) for name, values in rows.items()}
    filled = {
        name: _filled_gaps(times, values)
        for name, values in rows.items()
        if np.isfinite(values).any()
    }
    if not filled:
        raise UserError(f"{source}: {kind}: no frame shows a face with a time")
    return Take(
        kind=kind,
        source=source,
        times=times,
        channels=filled,
        is_calibrated=is_calibrated,
        notes=tuple(all_notes),
        unknown=tuple(unknown),
        has_keys=has_keys,
    )


def _rows_in_order(times: Floats64, recording: str) -> Integers64:
    """Return the rows to keep in the order of their times [s], one row for each time.

    Raises UserError, which names the recording, without any time or for more than a day.
    """
    if not np.isfinite(times).any():
        raise UserError(f"{recording}: no row has a time that can be read")
    longest_take = 86_400.0  # [s]
    known = np.flatnonzero(np.abs(times - np.nanmedian(times)) <= longest_take)
    moments, first = np.unique(times[known], return_index=True)
    duration = moments[-1] - moments[0]
    if duration > longest_take:
        raise UserError(f"{recording}: lasts {duration:.6g} s; a recording lasts a day at most")
    return known[first]


def _note_on_rows_left_out(count: int) -> str:
    """Return the report's sentence on rows without a time."""
    were = "was" if count == 1 else "were"
    return f"{counted(count, 'row')} without a time {were} left out."


def _gap_sentence(gaps: Floats64) -> str:
    """Return the report's sentence on missing rows; gaps: their durations [s]."""
    return (
        f"Rows are missing in {counted(len(gaps), 'place')}, {float(gaps.max()):.3g} s at most: "
        "the last pose is held there."
    )


def _gap_rows(times: Floats64) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return the numbers of rows after which other rows are missing."""
    steps = np.diff(times)
    if len(steps) < 3:
        return np.empty(0, dtype=np.intp)
    most_steps = 4.0  # a gap of more usual steps, longer than SHORT_GAP, has missing rows
    longest = max(SHORT_GAP, most_steps * float(np.median(steps)))
    return np.flatnonzero(steps > longest)


def _filled_gaps(times: Floats64, values: Floats64) -> Floats64:
    """Fill NaN in a channel: hold the value over a gap, with a straight line at the gap's end."""
    known = np.isfinite(values)
    if known.all():
        return values
    at = times[known]
    there = values[known]
    is_long = np.diff(at) > SHORT_GAP
    # The old value is repeated 0.3 s before each frame that ends a long gap.
    at = np.concatenate([at, at[1:][is_long] - SHORT_GAP])
    there = np.concatenate([there, there[:-1][is_long]])
    order = np.argsort(at, kind="stable")
    return np.interp(times, at[order], there[order])
