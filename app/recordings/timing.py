"""The time of each row of a recording: from timecode, a clock, a time stamp or frame numbers.

Timecode counts frames after its seconds (SMPTE 12M): `10:32:09:07.867`, drop-frame with `;`. A
clock has a fraction of the second instead: `10:32:09.129`, perhaps after a date or a number of
days. A time stamp is one number; its name or its steps show the unit.
"""

from __future__ import annotations

import datetime
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from risorius.geometry.arrays import Floats64

from .names import letters_of
from .row_times import DAY_LENGTH, frame_times, mostly_rises, spread
from .table import Table
from .timecode import TIMECODE_FORM, timecode_times, with_colons

CLOCK_FORM = re.compile(
    r"""(?:(?P<days>-?\d+)\s+days?,?\s+\+?)?
        (?:(?P<date>\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4})[T\s,]+)?
        (?:(?P<hours>\d{1,4}):)?(?P<minutes>\d{1,4}):(?P<seconds>\d{1,2}(?:[.,]\d+)?)
        \s*(?P<half>[ap]\.?m\.?)?
        \s*(?P<zone>Z|UTC|GMT|[-+]\d{2}(?::?\d{2})?)?$""",
    re.IGNORECASE | re.VERBOSE,
)
COMPACT_CLOCK = re.compile(  # ISO 8601 in its basic form
    r"(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d(?:[.,]\d+)?)(Z|[-+]\d\d(?::?\d\d)?)?$",
    re.IGNORECASE,
)
DURATION_FORM = re.compile(  # ISO 8601's durations
    r"(?P<sign>[-+]?)P(?=.*\d)(?:(?P<days>[\d.,]+)D)?"
    r"(?:T(?:(?P<hours>[\d.,]+)H)?(?:(?P<minutes>[\d.,]+)M)?(?:(?P<seconds>[\d.,]+)S)?)?$",
    re.IGNORECASE,
)
MEASURED_FORM = re.compile(
    r"(?P<number>[-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:e[-+]?\d+)?)\s*(?P<unit>[a-zµμ]+)$",
    re.IGNORECASE,
)
SHORTEST_STEP = 0.004  # [s] between frames; shorter steps are not seconds
TIME_UNITS = (  # shortest step, longest step, unit [s] of time stamps, and its name
    (SHORTEST_STEP, 2.5, 1.0, "seconds"),
    (4.0, 2.5e3, 1e-3, "milliseconds"),
    (4e3, 2.5e6, 1e-6, "microseconds"),
    (4e6, 2.5e9, 1e-9, "nanoseconds"),
)
SPELLED_UNITS = {
    "seconds": 1.0, "second": 1.0, "sec": 1.0, "secs": 1.0, "s": 1.0,
    "milliseconds": 1e-3, "millis": 1e-3, "msec": 1e-3, "ms": 1e-3,
    "microseconds": 1e-6, "micros": 1e-6, "usec": 1e-6, "us": 1e-6,
    "nanoseconds": 1e-9, "nanos": 1e-9, "nsec": 1e-9, "ns": 1e-9,
}  # fmt: skip


@dataclass(frozen=True)
class Stamp:
    """The name of a column of times.

    place: rank among the known names; of several columns the lowest rank is used. unit: the unit
    in the name [s], or None.
    """

    place: int
    unit: float | None = None


def stamp_of(name: str) -> Stamp | None:
    """Return the kind of time stamp under a column's or key's name; None for other names."""
    letters = letters_of(name)
    stamp_names = (
        "timestamp",
        "time",
        "t",
        "timecode",
        "elapsed",
        "elapsedtime",
        "timeelapsed",
        "frametime",
        "videotime",
        "mediatime",
        "capturetime",
        "relativetime",
        "datetime",
        "clock",
        "clocktime",
        "systemtime",
        "localtime",
        "utctime",
        "timestamputc",
        "unixtime",
        "unixtimestamp",
        "epoch",
        "pts",
    )  # without a unit at the end; the first one that a file has and that rises is used
    if letters in stamp_names:
        return Stamp(stamp_names.index(letters))
    for spelled, unit in SPELLED_UNITS.items():
        stem = letters.removesuffix(spelled)
        if stem == letters:
            continue
        if not stem:  # whole names "ms" and "seconds" are times, "s" may be anything
            return (
                Stamp(len(stamp_names), unit)
                if spelled in ("ms", "seconds", "milliseconds")
                else None
            )
        stem = stem.removesuffix("in")
        if stem in stamp_names:
            return Stamp(stamp_names.index(stem), unit)
    return None


def is_frame(name: str) -> bool:
    """Whether this is a name of a column of frame numbers."""
    frame_names = (
        "frame",
        "framenumber",
        "frameid",
        "frameindex",
        "frameidx",
        "frames",
        "frameno",
        "framenum",
        "framecount",
    )
    return letters_of(name) in frame_names


def times_of(table: Table, rate: float | None, notes: list[str]) -> tuple[Floats64, set[str]]:
    """Return the time of each row [s], (rows,), NaN where unknown; and the columns of times.

    rate: frames a second from the user, which override the file.
    """
    places = table.places

    def texts(name: str) -> list[str]:
        return table.cells(places[name])

    def numbers(name: str) -> Floats64:
        return table.numbers([places[name]])[:, 0]

    used = {name for name in places if is_frame(name) or stamp_of(name)}
    used.add("approx_time")  # py-feat's: minutes and whole seconds, which are useless
    return find_times([*places], texts, numbers, len(table.lines), rate, notes), used


def find_times(
    names: Sequence[str],
    texts: Callable[[str], list[str]],
    numbers: Callable[[str], Floats64],
    count: int,
    rate: float | None,
    notes: list[str],
    written_rate: float | None = None,
) -> Floats64:
    """Return the times of `count` rows [s], shape (count,), NaN where unknown.

    names: names of columns or keys. texts, numbers: functions from a name to its cells, as texts
        and as numbers with NaN.
    rate: frames a second from the user. written_rate: frames a second from the file.
    """
    stamps = {name: stamp for name in names if (stamp := stamp_of(name))}
    has_stamps = False
    sample_size = 100  # cells that show whether a column holds clock times
    for name in sorted(
        stamps, key=lambda name: (stamps[name].place, stamps[name].unit is not None)
    ):
        cells = with_colons(texts(name))
        sample = [cell for cell in cells if cell][:sample_size]
        times: Floats64 | None = None
        if sum(bool(TIMECODE_FORM.match(cell)) for cell in sample) * 2 > len(sample):
            times = timecode_times(cells, rate, notes)
        elif rate is not None:
            continue
        elif sum(_seconds_with_unit(cell) is not None for cell in sample) * 2 > len(sample):
            times = stamp_times(np.array([_seconds_in(cell) for cell in cells]), notes, 1.0)
        elif sum(_is_clock(cell) for cell in sample) * 2 > len(sample):
            times = clock_times(cells, name, notes)
        else:
            times = stamp_times(numbers(name), notes, stamps[name].unit)
        if times is not None:
            return times
        has_stamps = True
    if rate is None and written_rate is not None:
        notes.append(f"{written_rate:g} frames a second, from the file.")
    frame = next((numbers(name) for name in names if is_frame(name)), None)
    return frame_times(frame, count, rate or written_rate, notes, has_stamps=has_stamps)


def _is_clock(cell: str) -> bool:
    return ":" in cell or COMPACT_CLOCK.match(cell) is not None


def _seconds_with_unit(cell: str) -> float | None:
    """Return the seconds in `33 ms`, `0.033 s` or ISO 8601's `PT0.033S`; None for other cells."""
    if found := MEASURED_FORM.match(cell):
        spelled = found["unit"].casefold().replace("µ", "u").replace("μ", "u")
        unit = SPELLED_UNITS.get(spelled) or SPELLED_UNITS.get(f"{spelled}s")
        return None if unit is None else float(found["number"].replace(",", ".")) * unit
    found = DURATION_FORM.match(cell)
    if not found:
        return None
    lengths = {"days": DAY_LENGTH, "hours": 3600.0, "minutes": 60.0, "seconds": 1.0}
    try:
        parts = [
            float((found[part] or "0").replace(",", ".")) * length
            for part, length in lengths.items()
        ]
    except ValueError:  # two points in a number
        return None
    return -sum(parts) if found["sign"] == "-" else sum(parts)


def _seconds_in(cell: str) -> float:
    """Return the seconds in a cell, with or without a unit; NaN for other cells."""
    seconds = _seconds_with_unit(cell)
    if seconds is not None:
        return seconds
    try:
        return float(cell)
    except ValueError:
        return np.nan


def stamp_times(
    stamps: Floats64, notes: list[str], unit_of_name: float | None = None
) -> Floats64 | None:
    """Convert time stamps of any unit to seconds; return None if no unit fits.

    unit_of_name: the unit in the column's name [s]. It is used if frames are then 0.5 ms to 10 s
    apart.
    """
    if len(stamps) == 1:
        return None
    if not np.isfinite(stamps).any():
        notes.append("The time stamps are not numbers, and were not used.")
        return None
    stamps = spread(stamps, notes)
    if not mostly_rises(stamps):
        notes.append("The time stamps do not rise, and were not used.")
        return None
    steps = np.diff(stamps)
    step = float(np.nanmedian(steps[steps > 0.0]))
    if unit_of_name is not None and 5e-4 <= step * unit_of_name <= 10.0:
        name = next(name for *_, unit, name in TIME_UNITS if unit == unit_of_name)
        return _in_seconds(stamps, unit_of_name, name, notes)
    if step in (1.0, 2.0) and np.all(stamps % 1.0 == 0.0):
        notes.append("The time stamps count frames.")
        return None
    for shortest, longest, unit, name in TIME_UNITS:
        if shortest <= step < longest:
            return _in_seconds(stamps, unit, name, notes)
    notes.append(
        f"The time stamps are {step:g} apart, unlike those of a camera, and were not used."
    )
    return None


def _in_seconds(stamps: Floats64, unit: float, name: str, notes: list[str]) -> Floats64:
    """Return the stamps in seconds from 0, and note their unit."""
    if unit != 1.0:
        notes.append(f"Time stamps were read as {name}.")
    return (stamps - np.nanmin(stamps)) * unit


def clock_times(cells: Sequence[str], name: str, notes: list[str]) -> Floats64 | None:
    """Convert clock times to seconds from the first.

    Cells are such as `2024-05-01T12:00:00.033Z`, `0 days 00:00:00.033`, `00:00:00,033`, `0:00.03`.
    A cell without a time is NaN. Returns None if no cell has a time, or if times do not rise. Zones
    are ignored. Dates in another order than year, month, day are ignored too; the hours then show
    midnight.
    """
    seconds = np.full(len(cells), np.nan)
    days = np.zeros(len(cells))
    for row, cell in enumerate(cells):
        spread_out = COMPACT_CLOCK.sub(r"\1-\2-\3T\4:\5:\6\7", cell)
        if found := CLOCK_FORM.match(spread_out):
            seconds[row] = _seconds_of_day(found)
            days[row] = _day_of(found)
    known = np.isfinite(seconds)
    if not known.any():
        notes.append(f"The times in '{name}' cannot be read, and were not used.")
        return None
    if days[known].any():  # timedelta's days go below 0
        seconds[known] += DAY_LENGTH * (days[known] - days[known].min())
    else:
        seconds[known] = np.unwrap(seconds[known], period=DAY_LENGTH)
    if len(cells) == 1:
        return None
    seconds = spread(seconds, notes)
    if not mostly_rises(seconds):
        notes.append(f"The times in '{name}' do not rise, and were not used.")
        return None
    notes.append(f"The times in '{name}' were read as hours, minutes and seconds.")
    return seconds - np.nanmin(seconds)


def _seconds_of_day(found: re.Match[str]) -> float:
    """Return the seconds since midnight, or since the beginning, from a match of CLOCK_FORM."""
    hours = int(found["hours"] or 0)
    if found["half"]:
        hours = hours % 12 + (12 if found["half"][0] in "pP" else 0)
    seconds = float(found["seconds"].replace(",", "."))
    return 3600.0 * hours + 60.0 * int(found["minutes"]) + seconds


def _day_of(found: re.Match[str]) -> int:
    """Return the number of the day in a match of CLOCK_FORM; 0 if the day is unknown."""
    if found["days"]:
        return int(found["days"])
    parts = re.split("[-/.]", found["date"] or "")
    if len(parts[0]) != 4:
        return 0
    try:
        return datetime.date(*map(int, parts)).toordinal()
    except ValueError:
        return 0
