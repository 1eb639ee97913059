"""Times of rows: timecode of any rate, clocks, time stamps, and `--rate` with each."""

import datetime
import json

import numpy as np
import pytest
from pytest import approx

from risorius.app.recordings.reading import read_take

from .recording_files import has_note, written

JAW = np.linspace(0.0, 0.9, 90)


def take_of(folder, cells, *, name="time", rate=None):
    """The take of a table with these times and an opening jaw."""
    columns = {name: [f'"{cell}"' for cell in cells], "jawOpen": np.linspace(0, 0.9, len(cells))}
    return read_take(written(folder / "take.csv", columns), rate=rate)


def timecode(frame, base, *, separator=":", start=36000):
    """The timecode of a frame counted from `start` [s]."""
    second, number = divmod(frame, base)
    second += start
    return f"{second // 3600 % 24:02}:{second // 60 % 60:02}:{second % 60:02}{separator}{number:02}"


def drop_frame(frame, base, separator=";"):
    """The drop-frame timecode (SMPTE): every minute except each tenth skips two numbers."""
    dropped = base // 15
    tens, rest = divmod(frame, 600 * base - 9 * dropped)
    minutes = max(rest - dropped, 0) // (60 * base - dropped)
    return timecode(frame + dropped * (9 * tens + minutes), base, separator=separator, start=0)


@pytest.mark.parametrize("base", [24, 25, 30, 48, 50, 60, 72, 75, 90, 100, 120, 144, 240])
@pytest.mark.parametrize("step", [1, 2])
def test_any_timecode(base, step, tmp_path):
    """Three seconds last three seconds, even if only every other frame has a row."""
    frames = range(0, 3 * base, step)
    cells = [timecode(frame, base) for frame in frames]
    for rate in (None, float(base), 30.0, base / step):
        take = take_of(tmp_path, cells, name="Timecode", rate=rate)
        assert take.times == approx(np.array(frames) / base, abs=1e-6), rate


@pytest.mark.parametrize(("rate", "base"), [(23.976, 24), (29.97, 30), (47.952, 48), (59.94, 60)])
def test_the_true_rate_of_timecode(rate, base, tmp_path):
    """A `--rate` that is a thousandth below the timecode's rate is the camera's real rate."""
    cells = [timecode(frame, base) for frame in range(3 * base)]
    take = take_of(tmp_path, cells, name="Timecode", rate=rate)
    assert take.duration == approx((3 * base - 1) / rate)


def test_a_rate_that_timecode_contradicts(tmp_path):
    """A `--rate` that contradicts the timecode is not used, and this is reported."""
    cells = [timecode(frame, 60) for frame in range(0, 240, 2)]
    take = take_of(tmp_path, cells, name="Timecode", rate=30.0)
    assert take.duration == approx(238 / 60.0)
    assert has_note(take.notes, "counts 60 frames a second; 30 was not used")


@pytest.mark.parametrize("separator", [";", ":"])
@pytest.mark.parametrize("base", [30, 60, 120])
def test_drop_frame(base, separator, tmp_path):
    """Over eleven minutes, skipped numbers cause no jump, and the real rate is used."""
    frames = np.arange(700 * base // 5) * 5
    cells = [drop_frame(int(frame), base, separator) for frame in frames]
    take = take_of(tmp_path, cells, name="Timecode")
    assert take.times == approx(frames * 1.001 / base, abs=1e-4)
    assert has_note(take.notes, "Timecode drops frames")


@pytest.mark.parametrize(("start", "step"), [(0, 1), (3, 5), (7, 10)])
def test_colons_that_drop_nothing(start, step, tmp_path):
    """Rows that miss the first numbers of minutes by chance are not drop-frame timecode."""
    frames = range(start, 7200, step)
    take = take_of(tmp_path, [timecode(frame, 30) for frame in frames], name="Timecode")
    assert take.times == approx((np.array(frames) - start) / 30.0)


def test_a_semicolon_that_drops_nothing(tmp_path):
    """With a semicolon, timecode that has the skipped numbers is not drop-frame."""
    frames = range(0, 2100)
    cells = [timecode(frame, 30, separator=";", start=0) for frame in frames]
    take = take_of(tmp_path, cells, name="Timecode")
    assert take.times == approx(np.array(frames) / 30.0)


@pytest.mark.parametrize("base", [24, 25, 30, 48, 60])
def test_frames_behind_a_point(base, tmp_path):
    """Two digits after the point that never reach 60 are frames; others are hundredths."""
    frames = range(3 * base)
    cells = [timecode(frame, base, separator=".") for frame in frames]
    take = take_of(tmp_path, cells, name="Timecode")
    assert take.times == approx(np.array(frames) / base)
    cells = [f"00:00:{frame / base:05.2f}" for frame in frames]
    assert take_of(tmp_path, cells).times == approx(np.array(frames) / base, abs=6e-3)


def test_rows_that_share_a_frame_of_timecode(tmp_path):
    """60 rows per second with timecode of 30 frames are read as 60 per second."""
    cells = [timecode(row // 2, 30) for row in range(180)]
    take = take_of(tmp_path, cells, name="Timecode")
    assert take.times == approx(np.arange(180) / 60.0)
    assert has_note(take.notes, "spread evenly")


def clock(form):
    """A time formatted by strftime, with {ms} for milliseconds."""
    start = datetime.datetime(2024, 5, 1, 12, 0, 0)

    def label(seconds):
        at = start + datetime.timedelta(milliseconds=round(seconds * 1000))
        return at.strftime(form).replace("{ms}", f"{at.microsecond // 1000:03}")

    return label


def timedelta_of_pandas(seconds):
    """A time delta as printed by pandas."""
    return f"0 days 00:00:{seconds:09.6f}"


def timedelta_from_below(seconds):
    """A time delta as printed by pandas, from a second before 0."""
    if seconds < 1.0:
        return f"-1 days +23:59:{59 + seconds:09.6f}"
    return f"0 days 00:00:{seconds - 1.0:09.6f}"


CLOCKS = {
    "HH:MM:SS.mmm": clock("%H:%M:%S.{ms}"),
    "HH:MM:SS,mmm": clock("%H:%M:%S,{ms}"),
    "from 0": lambda s: f"00:00:{s:06.3f}",
    "M:SS.s": lambda s: f"0:{s:05.2f}",
    "ISO 8601 in UTC": clock("%Y-%m-%dT%H:%M:%S.{ms}Z"),
    "ISO 8601 with a zone": clock("%Y-%m-%dT%H:%M:%S.{ms}+02:00"),
    "ISO 8601 without a zone": clock("%Y-%m-%dT%H:%M:%S.{ms}"),
    "ISO 8601 with a blank": clock("%Y-%m-%d %H:%M:%S.{ms}"),
    "German": clock("%d.%m.%Y %H:%M:%S,{ms}"),
    "American": clock("%m/%d/%Y %I:%M:%S.{ms} %p"),
    "ISO 8601 in its basic form": clock("%Y%m%dT%H%M%S.{ms}Z"),
    "ISO 8601's durations": lambda s: f"PT{s:.4f}S",
    "long durations": lambda s: f"P1DT2H3M{s:.3f}S",
    "milliseconds with their unit": lambda s: f"{1e3 * s:.1f} ms",
    "seconds with their unit": lambda s: f"{s:.4f} s",
    "seconds in words": lambda s: f"{s:.4f} seconds",
    "microseconds with their unit": lambda s: f"{1e6 * s:.0f}µs",
    "many minutes": lambda s: f"132:{s:06.3f}",
    "pandas": timedelta_of_pandas,
    "pandas, over a day": timedelta_from_below,
    "Python, over a day": lambda s: str(datetime.timedelta(days=1, seconds=s - 1.0)),
    "Python": lambda s: str(datetime.timedelta(seconds=s)),
    "epoch in seconds": lambda s: f"{1_714_564_800 + s:.4f}",
    "epoch in milliseconds": lambda s: round((1_714_564_800 + s) * 1e3),
    "epoch in microseconds": lambda s: 1_714_564_800_000_000 + round(s * 1e6),
    "epoch in nanoseconds": lambda s: 1_714_564_800_000_000_000 + round(s * 1e9),
}


@pytest.mark.parametrize("kind", CLOCKS)
def test_clocks_and_stamps(kind, tmp_path):
    """90 frames last 89 / 30 s in all forms of times, in tables and in JSON."""
    times = np.arange(90) / 30.0
    cells = [CLOCKS[kind](float(time)) for time in times]
    for rate in (None, 30.0):
        take = take_of(tmp_path, cells, rate=rate)
        assert take.times == approx(times, abs=6e-3)
        assert not has_note(take.notes, "No times are given")
    frames = [{"time": cell, "jawOpen": jaw} for cell, jaw in zip(cells, JAW, strict=True)]
    path = tmp_path / "take.json"
    path.write_text(json.dumps(frames))
    assert read_take(path).times == approx(times, abs=6e-3)


@pytest.mark.parametrize("form", ["%H:%M:%S.{ms}", "%Y-%m-%d %H:%M:%S.{ms}"])
def test_a_clock_over_midnight(form, tmp_path):
    """Time continues after midnight, with a date and without."""
    times = np.arange(90) / 30.0
    take = take_of(tmp_path, [clock(form)(43_199.0 + float(time)) for time in times])
    assert take.times == approx(times, abs=2e-3)


@pytest.mark.parametrize(
    ("name", "step", "seconds"),
    [
        ("frame_time_in_ms", 1000 / 30, 1 / 30),
        ("frameTime", 1 / 30, 1 / 30),
        ("time (s)", 5.0, 5.0),
        ("timestamp [ms]", 2.0, 0.002),
        ("ts", 1 / 30, 1 / 30),
        ("timestampUs", 1e6 / 30, 1 / 30),
        ("pts", 0.04, 0.04),
    ],
)
def test_names_of_times(name, step, seconds, tmp_path):
    """The name of a time column may state its unit."""
    take = take_of(tmp_path, [f"{step * row:.6f}" for row in range(90)], name=name)
    assert take.times == approx(seconds * np.arange(90), abs=1e-5)
    assert not take.unknown


def test_a_clock_of_whole_seconds(tmp_path):
    """Rows with the same whole second are spread over this second."""
    take = take_of(tmp_path, [f"12:00:{row // 30:02}" for row in range(90)])
    assert take.times == approx(np.arange(90) / 30.0)
    assert has_note(take.notes, "spread evenly")


def test_times_that_cannot_be_read(tmp_path):
    """A column of unreadable times is named, and frames are played at a fixed rate."""
    take = take_of(tmp_path, ["half past: ten"] * 90)
    assert take.duration == approx(89 / 30.0)
    assert has_note(take.notes, "The times in 'time' cannot be read, and were not used")
    assert has_note(take.notes, "Instead 30 frames a second were assumed")
    assert not has_note(take.notes, "No times are given")
