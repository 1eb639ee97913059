"""Recordings as scripts: on time, in few keys, with a report; commands that read them."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.performances import limits_of, read_performance
from risorius.app.playback import LEAD_TIME, Playback
from risorius.app.recordings.conversion import lead_of, script_of
from risorius.app.recordings.take import Take
from risorius.app.script.script_file import load_script
from risorius.app.script.thinning import LINE_TOLERANCE

from . import recording_files
from .command_line import risorius

RATE = 60
take_of = partial(recording_files.take_of, seconds=3.0, rate=RATE)


def wave():
    """A channel that rises and falls between 0 and 1."""
    times = np.arange(3 * RATE + 1) / RATE
    return 0.5 - 0.5 * np.cos(5.0 * times)


def written(folder, seconds=1.0):
    """Write a recording in which a smile begins and the head turns to its right."""
    times = np.arange(round(seconds * RATE) + 1) / RATE
    path = folder / "take.csv"
    rows = [f"{t:.4f},{t / seconds:.4f},{20.0 * t / seconds:.4f},7" for t in times]
    path.write_text("\n".join(["time,mouthSmileLeft,headYaw,mood", *rows]), encoding="utf-8")
    return path


@given(st.floats(0.0, 0.3), st.floats(0.0, 2.5))
def test_the_lead_shifts_the_script(lead, moment):
    take = take_of(jawOpen=wave(), head_yaw=20.0 * wave())
    script, _ = script_of(take, Playback(neutral="none", lead=lead), limits_of("face"))
    for name, size in (("jawOpen", 1.0), ("head_yaw", 20.0 / 45.0)):
        recorded = np.interp(moment + lead_of(name, lead), take.times, size * wave())
        assert script.at(moment)[name] == approx(recorded, abs=2.0 * LINE_TOLERANCE)
    assert script.duration == approx(3.0), "as long as its sound"


def test_the_default_lead_equals_the_lag_of_the_skin(face):
    """With the default lead, a jaw that opens in waves is open on time, within a frame.

    The skin lags behind the controls by this lead.
    """
    scene = face
    take = take_of(jawOpen=0.6 * wave())
    lips = scene.landmarks[[62, 66]]
    late = {}
    for lead in (0.0, LEAD_TIME):
        script, _ = script_of(take, Playback(neutral="none", lead=lead), scene.limits)
        scene.reset()
        gaps = []
        for moment in take.times:
            scene.pose(script.at(float(moment)))
            scene.step(1.0 / RATE)
            upper, lower = scene.positions[lips, 1]
            gaps.append(upper - lower)
        shifts = range(-5, 11)
        middle = np.arange(20, len(gaps) - 20)
        wanted = take.channels["jawOpen"][middle]
        shifted = [np.take(gaps, middle + shift) for shift in shifts]
        fits = [np.corrcoef(wanted, gap)[0, 1] for gap in shifted]
        late[lead] = shifts[int(np.argmax(fits))]
    assert late[0.0] >= 2, "frames that the lips are late"
    assert abs(late[LEAD_TIME]) <= 1


def test_one_frame_is_a_pose():
    one = Take("MediaPipe", "one.json", np.zeros(1), {"mouthSmileLeft": np.array([0.4])})
    script, report = script_of(one, Playback(), limits_of("face"))
    assert script.poses[0].values == {"mouthSmileLeft": 0.4}
    assert not script.tracks
    assert report.recognised == "MediaPipe, one frame"


def test_the_report_lists_used_and_unused_channels():
    take = take_of(
        jawOpen=wave(), browDownLeft=0.3 + 0.1 * wave(), cheekPuff=0.2, AU26=wave(),
        head_yaw=90.0 * wave(), head_roll=0.0
    )  # fmt: skip
    _, report = script_of(take, Playback(), limits_of("face"))
    said = {heading: text for heading, text in report.rows}
    assert report.lines[0] == "take.csv: Live Link Face, 181 frames in 3.00 s, 60 a second"
    assert said["used"] == "2 of ARKit's shapes, 1 of the head's angles"
    assert said["constant"] == "cheekPuff head_roll"
    assert "mouthSmileLeft/Right" in said["missing"]
    assert "jawOpen" not in said["missing"].split()
    assert "browDownLeft" in said["neutral"]
    assert len(report.lines) <= 24
    assert max(map(len, report.lines)) <= 100


def test_a_recording_becomes_a_script_that_plays_the_same(tmp_path):
    path = written(tmp_path)
    output = tmp_path / "script.toml"
    result = risorius("convert", path, "-o", output, "--gain", "mouth*=0.5")
    assert result.exit_code == 0, result.output
    assert "Table of named columns" in result.stderr
    assert "unknown" in result.stderr
    assert "mood" in result.stderr
    script = load_script(output)
    converted = read_performance(path, Playback(gains=("mouth*=0.5",)))[0]
    assert script.tracks == converted.tracks
    assert script.duration == converted.duration
    assert script.at(1.0)["mouthSmileLeft"] == approx(0.5, abs=0.01)
    assert script.at(1.0)["head_yaw"] == approx(-20.0 / 45.0, abs=0.01)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("take.mov", b"\0\0\0\x18ftypqt  \xb9\0", "is not a text file; a recording of a face"),
        ("take.txt", b"hello, this is\na text\n", "is a table of which no column is known"),
        ("take.toml", b"hello, this is\na text\n", "not valid TOML"),
    ],
)
def test_the_error_names_the_apparent_kind_of_file(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UserError, match=words):
        read_performance(tmp_path / name)


@pytest.mark.parametrize(
    ("channel", "degrees", "axis", "towards"),
    [
        ("head_yaw", 20.0, 2, 0),  # the face turns to the subject's left (+x)
        ("head_pitch", 20.0, 2, 1),  # the face turns up
        ("head_roll", 20.0, 1, 0),  # the crown moves to the left shoulder
        ("eye_yaw_left", 15.0, 2, 0),
        ("eye_pitch_right", 15.0, 2, 1),
    ],
)
def test_angles_turn_head_and_eyes_as_they_were_recorded(face, channel, degrees, axis, towards):
    """A recorded angle turns only its own bone, by the same angle.

    Angles are to the subject's left, up, and to the left shoulder.
    """
    bones = {"eye_yaw_left": "eye_left", "eye_pitch_right": "eye_right"}
    script, _ = script_of(take_of(**{channel: degrees}), Playback(neutral="none"), face.limits)
    face.reset()
    face.pose(script.at(1.0))
    face.step(2.0)
    matrix = face.bone_transforms()[bones.get(channel, "cranium")]
    turned = np.degrees(np.arctan2(matrix[towards, axis], matrix[axis, axis]))
    assert turned == approx(degrees, abs=1.0)
