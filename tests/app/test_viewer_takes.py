"""What hands do to a script, without a window: letting go, auto-key, punching in, the undo list."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius.app.controls.vocabulary import readable
from risorius.app.errors import UserError
from risorius.app.scenes import FaceScene
from risorius.app.script import Channel, Key, Pose, Script, load_script
from risorius.app.script.keyframes import POSES, places_of
from risorius.app.script.places import KeyPlace, Places
from risorius.app.script.recorder import Recorder
from risorius.app.viewer.session.physics import STEP
from risorius.app.viewer.session.scene_controls import change_of
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.settings import PanelState
from risorius.app.viewer.timeline.key_selection import KeySelection

HELLO = Path("docs/hello.toml")


@pytest.fixture
def session(scene: FaceScene) -> Session:
    """A session that plays a script of poses and a blink."""
    scene.reset()
    return Session(scene, load_script(HELLO))


def run(session: Session, steps: int) -> None:
    """Let so many steps of time pass."""
    for _ in range(steps):
        session.advance(STEP)


def set_by_hand(session: Session, **values: float) -> None:
    """Move sliders, and let them go."""
    for name, value in values.items():
        session.set(name, value)
    session.note()


# Letting go


@pytest.mark.parametrize("how", ["seek", "key", "play", "button"])
def test_a_pose_that_is_let_go_is_told_and_comes_back(session: Session, how: str) -> None:
    """Whatever takes it away says so in a line; one undo brings it back to where it was made."""
    session.seek(2.0)
    set_by_hand(session, jaw_open=0.6)
    assert session.differing == {"jaw_open"}
    does = {
        "seek": lambda: session.seek(3.5),
        "key": lambda: session.seek_key(1),
        "play": session.toggle_playing,
        "button": session.let_go,
    }
    line = does[how]()
    assert line is not None and "Jaw open" in line and "[Undo]" in line
    run(session, 10)
    assert not session.differing and session.values["jaw_open"] < 0.6
    session.undo()
    assert session.values["jaw_open"] == 0.6 and session.time == 2.0 and session.has_unsaved_pose
    session.redo()
    assert session.values["jaw_open"] < 0.6


def test_what_is_keyed_or_was_never_moved_is_let_go_in_silence(session: Session) -> None:
    """No word and no step where nothing is lost; scrubbing on is silent, too."""
    assert session.seek(1.0) is None and not session.can_undo
    set_by_hand(session, jaw_open=0.6)
    session.set_key()
    assert session.seek(2.0) is None and session.history.labels[-1] == "Key at 1.00 s"
    set_by_hand(session, jaw_open=0.7)
    assert session.seek(2.5) and session.seek(3.0) is None


# Punching in


def test_recording_begins_at_the_playhead_and_keeps_the_rest(session: Session) -> None:
    """The script plays on; only what was moved is replaced, and only where; one undo is enough."""
    before = session.script
    session.seek(1.5)
    line = session.toggle_recording()
    assert line is not None and "1.50 s" in line and session.is_playing
    run(session, 6)
    session.set("jaw_open", 0.7)
    run(session, 30)
    with pytest.raises(UserError, match="stop the recording"):
        session.seek(0.0)
    line = session.toggle_recording()
    after = session.script
    assert line == "1 control recorded from 1.50 to 2.10 s"
    assert after.poses == before.poses and after.duration == before.duration
    assert set(after.tracks) == {"blink", "jaw_open"}
    assert after.at(1.9)["jaw_open"] == pytest.approx(0.7, abs=2e-3)
    for time in (0.0, 1.0, 1.6, 2.1, 3.0, 4.0):
        assert after.at(time) == before.at(time) | {"jaw_open": before.at(time)["jaw_open"]}
    session.undo()
    assert session.script == before and not session.script_is_unsaved


def test_a_pose_by_hand_is_where_a_recording_begins(session: Session) -> None:
    """What was set before is recorded, not dropped; buttons do not pause the recording."""
    session.seek(1.5)
    set_by_hand(session, jaw_open=0.7)
    session.toggle_recording()
    run(session, 20)
    session.toggle_alone("anger")
    run(session, 20)
    assert session.is_playing
    session.toggle_recording()
    assert session.script.at(1.7)["jaw_open"] == pytest.approx(0.7, abs=2e-3)
    assert session.script.at(2.0) | {"blink": 0.0} == pytest.approx(
        {"anger": 1.0, "jaw_open": 0.0, "joy": 0.0, "blink": 0.0}, abs=2e-3
    )


def test_a_recording_makes_the_script_longer(session: Session) -> None:
    """At the script's end it goes on, and what was held then stays."""
    for step in range(5):  # lengths that are rounded up and down
        session.seek(3.8 + 0.001 * step)
        session.toggle_recording()
        session.set("jaw_open", 0.3 + 0.1 * step)
        run(session, 60)
        session.toggle_recording()
        assert session.time == session.script.duration
        assert session.script.duration == pytest.approx(4.8 + 0.001 * step, abs=1e-5)
    session.toggle_playing()
    assert session.time == 0.0 and session.script.at(4.8)["jaw_open"] == pytest.approx(
        0.7, abs=2e-3
    )


def test_a_loop_is_recorded_once(session: Session) -> None:
    """Begun at the script's end it goes on at the start, and the second time round is not taken."""
    session.seek(4.0)
    session.is_looping = True
    session.toggle_recording()
    session.set("jaw_open", 0.7)
    run(session, 245)
    session.set("jaw_open", 0.1)
    run(session, 10)
    session.toggle_recording()
    assert session.script.duration == 4.0
    for time in (0.0, 1.0, 3.9):
        assert session.script.at(time)["jaw_open"] == pytest.approx(0.7, abs=2e-3)


LIMITS = dict.fromkeys(("a", "b", "c"), (0.0, 1.0))
TIMES = st.integers(0, 120).map(lambda frame: round(frame / 30.0, 6))
SHARES = st.integers(0, 100).map(lambda percent: percent / 100.0)
EASINGS = st.sampled_from(["linear", "smooth", "hold", "ease-in", "ease-out"])


@st.composite
def scripts(draw: st.DrawFn) -> Script:
    """Poses, tracks, or both, of three controls; four seconds."""
    poses = [
        Pose(time, draw(st.dictionaries(st.sampled_from("abc"), SHARES)), draw(EASINGS))
        for time in sorted(draw(st.sets(TIMES, max_size=4)))
    ]
    tracks = {
        name: Channel.of([Key(time, draw(SHARES), draw(EASINGS)) for time in sorted(times)])
        for name, times in draw(
            st.dictionaries(st.sampled_from("abc"), st.sets(TIMES, min_size=1, max_size=5))
        ).items()
    }
    return Script("drawn", 4.0, "drawn", poses=tuple(poses), tracks=tracks)


def cut_by(script: Script, name: str, times: tuple[float, ...], moment: float) -> bool:
    """Whether a moment is on the way between two keys of a track that one of the times parts."""
    keys = script.tracks.get(name, Channel([], [])).times
    ways = itertools.pairwise(keys)
    return any(a < moment < b and any(a < time < b for time in times) for a, b in ways)


@given(
    scripts(),
    st.integers(0, 230).map(lambda frame: round(frame / 60.0, 6)),
    st.lists(st.dictionaries(st.sampled_from("ab"), SHARES), min_size=1, max_size=30),
)
@settings(max_examples=100, deadline=None)
def test_punching_in_changes_nothing_else(
    played: Script, start: float, moves: list[dict[str, float]]
) -> None:
    """Outside of the recording every key, and what is not touched throughout, is as it was.

    To the bit, but for an eased way that is cut: that is followed as closely as can be seen.
    """
    recorder, held, time = Recorder(played, start, LIMITS), dict[str, float](), start
    shown = {}
    for move in moves:
        held |= move
        time += STEP
        told = {name: min(max(value, 0.0), 1.0) for name, value in played.at(time).items()}
        shown[time] = {**dict.fromkeys(LIMITS, 0.0), **told, **held}
        recorder.add(time, shown[time])
    script, end = recorder.script(), round(time, 6)
    if script is None:
        assert all(value == told.get(name, 0.0) for name, value in held.items())
        return
    script.check(LIMITS)
    assert script.poses == played.poses and script.duration == max(4.0, end)
    assert set(script.tracks) == set(played.tracks) | set(recorder.samples)
    for name in LIMITS:
        if name not in recorder.samples:
            assert script.tracks.get(name) is played.tracks.get(name)
            continue
        begin = float(next(t for t, v in shown.items() if v[name] != played_at(played, t, name)))
        keys = played.tracks.get(name, Channel([], [])).keys
        now = script.tracks[name]
        assert (np.diff(now.times) > 0.0).all()
        assert {key.time for key in keys if not start <= key.time <= end} <= set(now.times)
        for moment in np.linspace(0.0, 4.0, 121).tolist():
            before, after = played.at(moment).get(name, 0.0), script.at(moment).get(name, 0.0)
            if moment < begin - 1.01 * STEP or (moment > end and end < 4.0 - 0.04):
                if cut_by(played, name, (begin - STEP, end), moment):
                    assert after == pytest.approx(before, abs=3e-3)
                else:
                    assert after == before
        for moment, values in shown.items():
            if begin <= moment < end - 0.101:
                assert script.at(moment)[name] == pytest.approx(values[name], abs=4e-3)


def played_at(script: Script, time: float, name: str) -> float:
    """What a script makes of a control of 0 to 1."""
    return min(max(script.at(time).get(name, 0.0), 0.0), 1.0)


# Undo


COMMANDS = {
    "slide": lambda s, x: set_by_hand(s, jaw_open=x),
    "link": lambda s, x: (s.set("AU12_left", x, linked=True), s.note()),
    "joy": lambda s, x: s.toggle_alone("joy"),
    "mirror": lambda s, x: s.mirror(),
    "neutral": lambda s, x: s.neutral(),
    "seek": lambda s, x: s.seek(4.0 * x),
    "next": lambda s, x: s.seek_key(1),
    "key": lambda s, x: s.set_key(),
    "whole": lambda s, x: s.set_key(is_whole=True),
    "let go": lambda s, x: s.let_go(),
    "auto": lambda s, x: setattr(s, "is_keying", x > 0.5),
    "new": lambda s, x: s.begin_script(),
    "undo": lambda s, x: s.undo(),
    "redo": lambda s, x: s.redo(),
}


class Still(FaceScene):
    """A face that takes no time."""

    def step(self, seconds: float) -> None:
        """Stay."""


@given(st.lists(st.tuples(st.sampled_from(sorted(COMMANDS)), SHARES), max_size=12))
@settings(max_examples=60, deadline=None)
def test_undo_gives_the_state_before(steps: list[tuple[str, float]]) -> None:
    """After any commands: back through all that was, and forward again to where it ended."""
    session = Session(SHARED, load_script(HELLO))

    def state() -> tuple[object, ...]:
        by_hand = None if session.is_following else dict(session.values)
        return session.script, session.file, by_hand

    for command, share in steps:
        before, place = state(), session.history.place
        COMMANDS[command](session, share)
        after = state()
        if session.history.place == place + 1 and command != "redo":
            session.undo()
            assert state() == before
            session.redo()
            assert state() == after
    states = [state()]
    while session.history.can_undo:
        session.undo()
        states.append(state())
    for earlier in states[-2::-1]:
        session.redo()
        assert state() == earlier


SHARED = Still()


def test_the_undo_list_has_names(session: Session) -> None:
    """Each state is called as what led to it, and can be gone to at once."""
    session.seek(1.2)
    set_by_hand(session, AU12_left=0.6)
    session.mirror()
    session.set("AU12_left", 0.3, linked=True)
    session.note()
    session.set_key()
    selection = KeySelection(session, PanelState())
    selection.places = Places.of(KeyPlace(POSES, 1.0), KeyPlace(POSES, 3.0))
    selection.nudge(1)
    selection.delete()
    assert session.history.labels == [
        "Beginning", "Set AU12 left to 0.60", "Mirror", "Set AU12 to 0.30", "Key at 1.20 s",
        "Move 2 keys", "Delete 2 keys",
    ]  # fmt: skip
    session.go_to(2)
    assert session.values["AU12_right"] == 0.6 and session.script_is_unsaved is False
    session.go_to(6)
    assert [pose.time for pose in session.script.poses] == [0.0, 1.2, 4.0]
    assert change_of({}, {"jaw_open": 0.1, "joy": 0.2}) == "Set 2 controls"
    assert readable("AU12_left") == "AU12 left"


# Copies


def test_keys_are_pasted_in_another_script(session: Session, scene: FaceScene) -> None:
    """What was copied stays as it was, whatever became of its script; it comes at the playhead."""
    selection = KeySelection(session, PanelState())
    assert not selection.copied
    selection.places = Places.of(KeyPlace(POSES, 1.0), KeyPlace("blink", 2.12))
    assert "2 keys copied" in str(selection.copy())
    selection.delete()
    session.begin_script()
    session.seek(0.5)
    assert selection.copied and selection.paste() == "2 keys copied to 0.50 s"
    assert selection.places == {KeyPlace(POSES, 0.5), KeyPlace("blink", 1.62)}
    assert places_of(session.script) == selection.places | {KeyPlace(POSES, 0.0)}
    assert session.script.poses[1].name == "joy"
    session.undo()
    assert places_of(session.script) == {KeyPlace(POSES, 0.0)}
