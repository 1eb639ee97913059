"""Takes of Live Link Face: times, names, units and signs are found from the content."""

import math

import numpy as np
import pytest
from pytest import approx

from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.recordings.reading import is_recording, read_take

from .recording_files import ANGLE_COLUMNS, has_note, live_link, take_in, timecodes, written


def test_a_raw_take(tmp_path):
    """All 52 shapes and seven angles have their values, in degrees with the project's signs."""
    columns = live_link()
    take = take_in(tmp_path, columns)
    assert take.kind == "Live Link Face"
    assert not take.is_calibrated
    assert not take.unknown
    assert set(ARKIT_SHAPES) < set(take.channels)
    assert take.times == approx(np.arange(120) / 60.0, abs=1e-9)
    for name in ARKIT_SHAPES:
        there = np.array(columns[name[0].upper() + name[1:]])
        assert take.channels[name] == approx(there, abs=1e-6)
    for ours, theirs in (
        ("head_yaw", "HeadYaw"),
        ("head_pitch", "HeadPitch"),
        ("head_roll", "HeadRoll"),
        ("eye_pitch_right", "RightEyePitch"),
    ):
        there = np.degrees(np.array(columns[theirs], dtype=float))
        assert take.channels[ours] == approx(-there, abs=1e-3)


@pytest.mark.parametrize("name", ["take.csv", "take.toml", "take", "take.json"])
def test_the_name_of_the_file_does_not_count(name, tmp_path):
    """The kind of a file is found from its content, not its name."""
    path = written(tmp_path / name, live_link())
    assert is_recording(path)
    assert read_take(path).kind == "Live Link Face"


@pytest.mark.parametrize(
    "left_out", [("TongueOut",), (), ("TongueOut", *ANGLE_COLUMNS), ANGLE_COLUMNS]
)
def test_fewer_columns(left_out, tmp_path):
    """Files of 60, 61, 51 and 52 columns are read; a missing column gives no channel."""
    columns = {name: values for name, values in live_link().items() if name not in left_out}
    take = take_in(tmp_path, columns)
    assert ("tongueOut" in take.channels) == ("TongueOut" not in left_out)
    assert ("head_yaw" in take.channels) == ("HeadYaw" not in left_out)


def test_values_that_are_none(tmp_path):
    """A value such as -9.8e5 is not a measurement; other values of its frame, and 1.2, count."""
    columns = live_link()
    jaw = np.full(120, 0.5)
    jaw[7] = -9.8e5
    jaw[9] = 1.2
    take = take_in(tmp_path, columns | {"JawOpen": jaw})
    assert take.channels["jawOpen"][7] == approx((0.5 + 0.5) / 2.0)
    assert take.channels["jawOpen"][9] == 1.2
    assert has_note(take.notes, "far from 0 to 1")


@pytest.mark.parametrize(("name", "unit"), [("radians", 1.0), ("degrees", math.pi / 180.0)])
def test_units_of_angles(name, unit, tmp_path):
    """The unit of angles is found from their size: no head turns by over 90 degrees."""
    take = take_in(tmp_path, live_link(unit=unit))
    assert has_note(take.notes, f"read as {name}")
    known = live_link()
    for ours, theirs in (("head_yaw", "HeadYaw"), ("eye_pitch_left", "LeftEyePitch")):
        there = -np.degrees(np.array(known[theirs], dtype=float))
        assert take.channels[ours] == approx(there, abs=0.02)


def test_axes_of_the_eyeballs(tmp_path):
    """The axes of eyeballs point 4 degrees outward from the gaze, and are corrected.

    Otherwise a face would squint.
    """
    take = take_in(tmp_path, live_link())
    left = take.channels["eye_yaw_left"]
    right = take.channels["eye_yaw_right"]
    assert np.abs(left - right).max() < 1e-3
    wanted = -np.degrees(0.62 * take.channels["eyeLookInLeft"])
    wanted += np.degrees(0.59 * take.channels["eyeLookOutLeft"])
    assert left == approx(wanted, abs=1e-3)


def test_angles_that_are_switched_off(tmp_path):
    """If all head angles are 0, the app did not record them, and the take has no head angles."""
    off = {name: np.zeros(120) for name in ("HeadYaw", "HeadPitch", "HeadRoll")}
    take = take_in(tmp_path, live_link() | off)
    assert "head_yaw" not in take.channels
    assert "eye_yaw_left" in take.channels
    assert has_note(take.notes, "switched off")


def test_a_calibrated_take(tmp_path):
    """A take is recognised as calibrated if brows and nose are 0 at rest, unlike in a raw take."""
    columns = live_link()
    shapes = {name[0].upper() + name[1:] for name in ARKIT_SHAPES}
    calibrated = dict(columns)
    for name in shapes & columns.keys():
        calibrated[name] = np.maximum(np.array(columns[name]) - 0.2, 0.0)
    assert read_take(written(tmp_path / "cal.csv", calibrated)).is_calibrated
    assert not read_take(written(tmp_path / "raw.csv", columns)).is_calibrated


# Times.


def take_of(path, codes, rate=None):
    """Times and notes of a take with these timecodes."""
    columns = {
        "Timecode": codes,
        "BlendShapeCount": [61] * len(codes),
        "JawOpen": [0.1] * len(codes),
    }
    take = read_take(written(path / "take.csv", columns), rate=rate)
    return take.times, take.notes


def test_the_fraction_of_a_frame(tmp_path):
    """At slightly less than 60 frames per second, the fraction gives each frame's exact time."""
    frames = 37.867 + 1.003 * np.arange(400)
    times, notes = take_of(tmp_path, timecodes(frames))
    assert times == approx(1.003 * np.arange(400) / 60.0, abs=1e-4)
    assert has_note(notes, "60 frames a second")


def test_a_rate_that_the_user_knows(tmp_path):
    """A rate given by the user has priority over one found."""
    times, _ = take_of(tmp_path, timecodes(np.arange(10)), rate=30.0)
    assert times[-1] == approx(9 / 30.0)


def test_midnight(tmp_path):
    """Time continues after 23:59:59."""
    codes = [code[:-4] for code in timecodes(np.arange(60), 60, start=86_399)]
    codes += [code[:-4] for code in timecodes(np.arange(60), 60, start=0)]
    times, _ = take_of(tmp_path, codes)
    assert times == approx(np.arange(120) / 60.0, abs=1e-9)


def test_thousandths(tmp_path):
    """Thousandths of a second in place of frame numbers are recognised."""
    codes = [f"10:00:{n // 25:02}:{n % 25 * 40:03}" for n in range(100)]
    times, _ = take_of(tmp_path, codes)
    assert times == approx(np.arange(100) / 25.0, abs=1e-9)
