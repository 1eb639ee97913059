"""Recordings into a script during play, without a window."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx

from risorius.app.control_names.limits import Limits
from risorius.app.errors import UserError
from risorius.app.script import Channel, Key, Pose, Script
from risorius.app.script.recorder import Recorder
from risorius.app.script.script_file import load_script
from risorius.app.viewer.session.physics import STEP_TIME

from .driving import run

SMILE_MUSCLE = "zygomaticus_major_left"


def test_recording_begins_at_the_playhead_and_keeps_the_rest(session):
    """The script continues; only moved controls are replaced, where they move.

    One undo is enough.
    """
    before = session.script
    session.seek(1.5)
    line = session.toggle_recording()
    assert line is not None
    assert "1.50 s" in line
    assert session.is_playing
    run(session, 6)
    session.set("jaw_open", 0.7)
    run(session, 30)
    with pytest.raises(UserError, match="stop the recording"):
        session.seek(0.0)
    line = session.toggle_recording()
    after = session.script
    assert line == "1 control recorded from 1.50 to 2.10 s"
    assert after.poses == before.poses
    assert after.duration == before.duration
    assert set(after.tracks) == {"blink", "jaw_open"}
    assert after.at(1.9)["jaw_open"] == approx(0.7, abs=2e-3)
    for time in (0.0, 1.0, 1.6, 2.1, 3.0, 4.0):
        assert after.at(time) == before.at(time) | {"jaw_open": before.at(time)["jaw_open"]}
    session.undo()
    assert session.script == before
    assert not session.work.script_is_unsaved


LIMITS = Limits(dict.fromkeys(("a", "b", "c"), (0.0, 1.0)))
TIMES = st.integers(0, 120).map(lambda frame: round(frame / 30.0, 6))
SHARES = st.integers(0, 100).map(lambda percent: percent / 100.0)
EASINGS = st.sampled_from(["linear", "smooth", "hold", "ease-in", "ease-out"])


@st.composite
def scripts(draw):
    """Scripts of poses, tracks, or both, with three controls and four seconds."""
    names = st.sampled_from("abc")
    poses = []
    for time in sorted(draw(st.sets(TIMES, max_size=4))):
        poses.append(Pose(time, draw(st.dictionaries(names, SHARES)), draw(EASINGS)))
    tracks = {}
    times_by_name = draw(st.dictionaries(names, st.sets(TIMES, min_size=1, max_size=5)))
    for name, times in times_by_name.items():
        keys = [Key(time, draw(SHARES), draw(EASINGS)) for time in sorted(times)]
        tracks[name] = Channel.from_keys(keys)
    return Script("drawn", 4.0, "drawn", poses=tuple(poses), tracks=tracks)


def cut_by(script, name, times, moment):
    """Whether a moment lies between two keys of a track, with one of the times between them."""
    keys = script.tracks.get(name, Channel([], [])).times
    for start, end in itertools.pairwise(keys):
        if start < moment < end:
            return any(start < time < end for time in times)
    return False


@given(
    scripts(),
    st.integers(0, 230).map(lambda frame: round(frame / 60.0, 6)),
    st.lists(st.dictionaries(st.sampled_from("ab"), SHARES), min_size=1, max_size=30),
)
@settings(max_examples=100, deadline=None)
def test_punching_in_changes_nothing_else(played, start, moves):
    """Outside a recording, every key and every untouched control stays the same, to the bit.

    An easing that the recording cuts is replaced with an invisible error.
    """
    recorder = Recorder(played, start)
    held = dict[str, float]()
    time = start
    shown = {}
    for move in moves:
        held |= move
        time += STEP_TIME
        scripted = played.values(time, LIMITS)
        shown[time] = LIMITS.pose(held, scripted)
        recorder.add(time, shown[time])
    script = recorder.script()
    end = round(time, 6)
    if script is None:
        assert all(value == scripted[name] for name, value in held.items())
        return
    script.check(LIMITS)
    assert script.poses == played.poses
    assert script.duration == max(4.0, end)
    assert set(script.tracks) == set(played.tracks) | set(recorder.samples)
    for name in LIMITS:
        if name not in recorder.samples:
            assert script.tracks.get(name) is played.tracks.get(name)
            continue
        begin = float(
            next(t for t, v in shown.items() if v[name] != played.values(t, LIMITS)[name])
        )
        keys = played.tracks.get(name, Channel([], [])).keys
        now = script.tracks[name]
        assert (np.diff(now.times) > 0.0).all()
        assert {key.time for key in keys if not start <= key.time <= end} <= set(now.times)
        for moment in np.linspace(0.0, 4.0, 121).tolist():
            before = played.at(moment).get(name, 0.0)
            after = script.at(moment).get(name, 0.0)
            if moment < begin - 1.01 * STEP_TIME or (moment > end and end < 4.0 - 0.04):
                if cut_by(played, name, (begin - STEP_TIME, end), moment):
                    assert after == approx(before, abs=3e-3)
                else:
                    assert after == before
        for moment, values in shown.items():
            if begin <= moment < end - 0.101:
                assert script.at(moment)[name] == approx(values[name], abs=4e-3)


def paused(session):
    """A recording from 1 s, in which the jaw moves, paused at 2 s."""
    session.seek(1.0)
    session.toggle_recording()
    run(session, 30)
    session.set("jaw_open", 0.5)
    run(session, 30)
    session.toggle_playing()
    run(session, 30)


def test_moves_in_a_pause_stay_by_hand_when_it_ends(session):
    """Moves in a pause are not recorded, which a line reports, and can still be keyed."""
    paused(session)
    session.set("AU4", 0.8)
    session.set("jaw_open", 0.1)
    line = session.toggle_recording()
    assert line is not None
    assert "1 control recorded" in line
    assert "2 controls" in line
    assert "not keyed" in line
    assert session.values["AU4"] == 0.8
    assert session.values["jaw_open"] == 0.1
    assert session.differing == {"AU4", "jaw_open"}
    assert session.work.has_unsaved_pose
    assert session.script.at(1.8)["jaw_open"] == approx(0.5, abs=0.002)
    assert "AU4" not in session.script.tracks
    assert "[Undo]" in (session.seek(0.0) or "")
    session.undo()
    assert session.values["AU4"] == 0.8
    assert session.values["jaw_open"] == 0.1


def test_a_recording_plays_back_to_the_same_positions(session, tmp_path):
    """A recording that was saved and loaded moves each vertex as before, to 0.01 mm."""
    session.work.begin_script()
    session.edit(replace(session.script, duration=1.0))
    session.toggle_recording()
    run(session, 30)
    for step in range(60):
        session.set("jaw_open", step / 60.0)
        session.advance(STEP_TIME)
    session.set(SMILE_MUSCLE, 0.8)
    run(session, 60)
    wanted = session.scene.positions.copy()
    assert np.abs(wanted - session.scene.rest_positions).max() > 10.0
    session.toggle_recording()
    assert "the script" in session.work.unsaved
    session.work.save_script(tmp_path / "take.toml")
    assert not session.work.unsaved
    session.neutral()
    run(session, 90)
    session.work.open(load_script(tmp_path / "take.toml"))
    session.toggle_playing()
    while session.is_playing:
        session.advance(STEP_TIME)
    assert np.abs(session.scene.positions - wanted).max() < 0.01


def test_the_face_that_is_led_becomes_keys_poses_and_recordings(session, tmp_path):
    """Keys, poses and recordings store the visible live face, not the sliders' values."""
    session.live_override.override({"jaw_open": 0.5}, 1.0)
    session.work.save_pose(tmp_path / "pose.toml")
    assert load_script(tmp_path / "pose.toml").at(0.0)["jaw_open"] == 0.5
    session.work.begin_script()
    session.set_key()
    assert session.script.at(0.0)["jaw_open"] == 0.5
    session.neutral()
    session.toggle_recording()
    for step in range(30):
        session.live_override.override({"jaw_open": step / 30.0}, 1.0)
        session.advance(STEP_TIME)
    session.toggle_recording()
    assert session.script.at(0.25)["jaw_open"] == approx(0.5, abs=0.05)
