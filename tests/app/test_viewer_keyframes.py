"""Edits of keys without a window: their effect on a script, and on a session."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from risorius.app.control_names.limits import Limits
from risorius.app.errors import UserError
from risorius.app.performances import script_for
from risorius.app.script import Script, keyframes
from risorius.app.script.key_sets import KeyId, KeySet
from risorius.app.script.keyframes import POSE_TRACK
from risorius.app.script.script_file import load_script, parse_script
from risorius.app.viewer.documents.file_dialogs import FileDialogs
from risorius.app.viewer.documents.scripts import Question, ScriptCommands
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.timeline.keys import KeySelection

from .driving import HELLO_FILE

JOY_KEY = KeyId(POSE_TRACK, 1.0)


@pytest.fixture
def hello() -> Script:
    """Four poses, one with a name, and a blink."""
    return load_script(HELLO_FILE)


def test_a_key_shows_just_the_face_that_was_set(hello, scene):
    """At its time the new key has the controls' values; other poses stay."""
    limits = scene.limits
    wanted = limits.pose({"jaw_open": 0.4, "AU4_left": 0.2, "blink": 0.25})
    script = keyframes.keyed(hello, 2.12, wanted)
    for name, value in wanted.items():
        assert script.at(2.12).get(name, 0.0) == approx(value, abs=1e-9), name
    script.check(limits)
    assert [pose for pose in script.poses if pose.time != 2.12] == list(hello.poses)
    former, changed = (
        [key for key in each.tracks["blink"].keys if key.time != 2.12] for each in (hello, script)
    )
    assert changed == former
    again = keyframes.keyed(hello, 1.0, limits.pose({"jaw_open": 0.7}))
    assert again.poses[1].name == "joy"
    assert again.poses[1].easing == "ease-out"
    assert again.poses[1].values == {"jaw_open": 0.7}


def test_a_key_in_a_recording(scene):
    """In a script of tracks, changed controls get a key, or all if none was changed."""
    text = "[tracks]\njoy=[{time=0,value=0},{time=2,value=1,easing='linear'}]\n"
    script = parse_script(text + "jaw_open=[{time=0,value=0.5}]", source="take.toml")
    pose = scene.limits.pose
    changed = keyframes.keyed(script, 1.0, pose({"joy": 0.5, "jaw_open": 0.1}))
    assert changed.poses == ()
    assert changed.tracks["joy"] == script.tracks["joy"]
    assert [(key.time, key.value) for key in changed.tracks["jaw_open"].keys] == [
        (0, 0.5),
        (1, 0.1),
    ]
    held = keyframes.keyed(script, 1.0, pose({"joy": 0.5, "jaw_open": 0.5}))
    assert len(held.tracks["joy"].keys) == 3
    assert len(held.tracks["jaw_open"].keys) == 2
    for time in np.linspace(0.0, 2.0, 9):
        assert held.at(time) == approx(script.at(time))


def test_one_control_is_keyed_over_poses(hello, scene):
    """A new track is 0 at the poses around its key; other controls and poses are unchanged."""
    wanted = scene.limits.pose({"jaw_open": 0.4})
    script = keyframes.with_keys_of(hello, 2.0, wanted, ["jaw_open"])
    assert script.poses == hello.poses
    assert script.at(2.0)["jaw_open"] == approx(0.4)
    assert script.tracks["blink"] == hello.tracks["blink"]
    start = max(pose.time for pose in hello.poses if pose.time < 2.0)
    end = min(pose.time for pose in hello.poses if pose.time > 2.0)
    for time in np.linspace(0.0, hello.duration, 41):
        now = script.at(time)
        for name, value in hello.at(time).items():
            if name != "jaw_open" or not start < time < end:
                assert now[name] == approx(value, abs=1e-9), (name, time)
    script.check(scene.limits)


def test_a_key_at_a_pose_changes_that_pose(hello, scene):
    """At a pose, a control without a track is set in the pose, one with a track gets a key."""
    wanted = scene.limits.pose({"joy": 0.5, "blink": 0.75})
    script = keyframes.with_keys_of(hello, 1.0, wanted, ["joy", "blink"])
    assert [pose.time for pose in script.poses] == [pose.time for pose in hello.poses]
    assert script.poses[1].name == "joy" and script.at(1.0)["joy"] == 0.5
    assert script.at(1.0)["blink"] == approx(0.75)
    assert "joy" not in script.tracks
    before = hello.poses[1].values
    after = script.poses[1].values
    for name in set(before) - {"joy", "blink"}:
        assert after[name] == before[name], name


def test_a_blink_is_keyed_over_poses(session):
    """A blink is three keys of one control: the eye shuts and opens, other curves stay."""
    selection = KeySelection(session)
    before = session.script
    for time, value in ((2.0, 0.0), (2.2, 1.0), (2.4, 0.0)):
        session.seek(time)
        session.set("AU43", value)
        selection.set_key()
    script = session.script
    assert script.poses == before.poses
    assert set(script.tracks) == {*before.tracks, "AU43"}
    assert script.at(2.2)["AU43"] == approx(1.0)
    assert all(script.at(time)["AU43"] == approx(0.0) for time in (1.0, 2.0, 2.4, 3.0))
    session.seek(2.2)
    selection.delete_keys_of(["AU43"])
    assert session.values["AU43"] == approx(0.0)
    selection.clear_tracks_of(["AU43"])
    assert session.script.tracks == before.tracks
    session.undo()
    assert "AU43" in session.script.tracks


def test_a_key_of_one_control_keeps_the_others_in_hand(session):
    """*Key this* keys one control; another moved control stays as it is, without a key."""
    selection = KeySelection(session)
    session.seek(2.0)
    session.set("jaw_open", 0.4)
    session.set("AU4_left", 0.3)
    selection.key_controls(["jaw_open"])
    assert session.values["AU4_left"] == 0.3 and session.differing == {"AU4_left"}
    assert session.touched == {"AU4_left"}
    selection.set_key()
    assert not session.differing and session.script.at(2.0)["AU4_left"] == approx(0.3)
    with pytest.raises(UserError, match="no control was moved"):
        selection.set_key()


def test_the_face_follows_an_edit_if_it_followed_the_script(session):
    """If a key moves away from the playhead, the face follows; a pose set by hand stays."""
    session.seek(1.0)
    assert session.values["joy"] == 1.0
    session.edit(keyframes.moved(session.script, KeySet.from_keys(JOY_KEY), 0.5)[0])
    assert 0.0 < session.values["joy"] < 1.0
    session.set("joy", 0.3)
    session.edit(keyframes.moved(session.script, KeySet.from_keys(KeyId(POSE_TRACK, 1.5)), -0.5)[0])
    assert session.values["joy"] == 0.3


def test_undo_restores_the_file_of_a_script(session, tmp_path):
    """Undo beyond the opening of another script also restores the first script's file name."""
    own = session.file.path
    other = tmp_path / "other.toml"
    other.write_text("[[pose]]\ntime = 0.0\n[[pose]]\ntime = 1.0\njoy = 1.0\n")
    session.work.open(load_script(other))
    assert session.file.path == other
    assert session.work.name == "other.toml"
    session.undo()
    assert session.file.path == own
    assert not session.work.script_is_unsaved
    session.redo()
    session.work.begin_script()
    assert session.file.path is None
    assert session.work.name == "Untitled"
    assert Session(session.scene, script_for(None, "face")).file.path is None


def test_a_new_script_keeps_the_face(session):
    """A pose set by hand becomes the new script's first key; undo restores the old script."""
    before = session.script
    session.set("jaw_open", 0.4)
    session.note()
    session.work.begin_script()
    assert session.values["jaw_open"] == 0.4
    assert session.script.poses[0].values == {"jaw_open": 0.4}
    assert session.script.tracks == {}
    session.undo()
    assert session.script == before
    assert session.values["jaw_open"] == 0.4


def test_a_new_script_asks_for_no_pose(session):
    """The pose stays unsaved in a new script; a changed script leads to a question."""
    question = Question(session)
    commands = ScriptCommands(session, FileDialogs(), question, lambda *_: None)
    session.set("jaw_open", 0.4)
    session.note()
    commands.new()
    assert not question.is_open
    assert session.file.path is None
    assert session.values["jaw_open"] == 0.4
    assert session.work.unsaved == "the pose"
    session.set("joy", 0.5)
    session.set_key()
    commands.new()
    assert question.is_open


def test_losses_of_a_file_are_noticed(session):
    """Changes by other programs and lost comments are reported; a # in a title is not."""
    path = session.file.path
    assert session.file.objection == ""
    session.work.save_script(path)
    assert session.file.objection == ""
    text = path.read_text()
    path.write_text(text + "# mine\n")
    assert "another program" in session.file.objection
    session.work.open(load_script(path))
    assert "comments" in session.file.objection
    path.write_text(text.replace('"Hello"', '"No. #1 \\" # 2"'))
    session.work.open(load_script(path))
    assert session.script.title == 'No. #1 " # 2' and session.file.objection == ""
    path.unlink()
    assert session.file.objection == ""


@given(amount=st.floats(-3.0, 3.0), choice=st.lists(st.booleans(), min_size=8, max_size=8))
def test_raised_keys_stay_within_limits(amount, choice):
    """Chosen keys are raised by the amount within limits; other keys and all times stay."""
    hello = load_script(HELLO_FILE)
    limits = Limits(dict.fromkeys(("joy", "jaw_open", "blink"), (0.0, 1.0)))
    everything = sorted(keyframes.all_keys(hello))
    places = KeySet.from_keys(
        *(place for place, is_in in zip(everything, choice, strict=True) if is_in)
    )
    script = keyframes.raised(hello, places, amount, limits, {"joy"})
    script.check(limits)
    assert keyframes.all_keys(script) == keyframes.all_keys(hello)
    for name, before, after in (
        ("blink", hello.tracks["blink"], script.tracks["blink"]),
        (POSE_TRACK, hello.posed_channel("joy"), script.posed_channel("joy")),
    ):
        for old, new in zip(before.keys, after.keys, strict=True):
            wanted = min(max(old.value + amount, 0.0), 1.0)
            is_in = KeyId(name, old.time) in places
            assert new.value == approx(wanted if is_in else old.value, abs=1e-6)
            assert new.easing == old.easing
    assert [pose.values.get("jaw_open") for pose in script.poses] == [None, 0.1, None, None]
    assert keyframes.raised(hello, places, 0.0, limits, {"joy"}) == hello
