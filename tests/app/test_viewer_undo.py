"""Changes of a script by hand, without a window; and small parts of the window."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius.app.scenes import FaceScene
from risorius.app.script.key_sets import KeyId, KeySet
from risorius.app.script.keyframes import POSE_TRACK, all_keys
from risorius.app.script.script_file import load_script
from risorius.app.viewer.picture.stage import (
    CALM_FRAMES,
    DETAIL_LEVELS,
    FULL_DETAIL,
    PATIENCE_FRAMES,
    LevelOfDetail,
)
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.timeline.keys import KeySelection
from risorius.assets.loading import read_words

from .driving import HELLO_FILE, run, set_by_hand

SHARES = st.integers(0, 100).map(lambda percent: percent / 100.0)


@pytest.mark.parametrize("how", ["seek", "key", "play", "button"])
def test_a_discarded_pose_is_reported_and_can_be_restored(session, how):
    """Each way to discard a pose prints a line; one undo restores the pose at its own time."""
    session.seek(2.0)
    set_by_hand(session, jaw_open=0.6)
    assert session.differing == {"jaw_open"}
    does = {
        "seek": lambda: session.seek(3.5),
        "key": lambda: session.seek_key(1),
        "play": session.toggle_playing,
        "button": session.release_controls,
    }
    line = does[how]()
    assert line is not None
    assert "Jaw open" in line
    assert "[Undo]" in line
    run(session, 10)
    assert not session.differing
    assert session.values["jaw_open"] < 0.6
    session.undo()
    assert session.values["jaw_open"] == 0.6
    assert session.time == 2.0
    assert session.work.has_unsaved_pose
    session.redo()
    assert session.values["jaw_open"] < 0.6


COMMANDS = {
    "slide": lambda s, x: set_by_hand(s, jaw_open=x),
    "link": lambda s, x: (s.set("AU12_left", x, linked=True), s.note()),
    "joy": lambda s, x: s.toggle_solo("joy"),
    "mirror": lambda s, x: s.mirror(),
    "neutral": lambda s, x: s.neutral(),
    "seek": lambda s, x: s.seek(4.0 * x),
    "next": lambda s, x: s.seek_key(1),
    "key": lambda s, x: s.set_key(),
    "let go": lambda s, x: s.release_controls(),
    "auto": lambda s, x: setattr(s, "is_keying", x > 0.5),
    "new": lambda s, x: s.work.begin_script(),
    "undo": lambda s, x: s.undo(),
    "redo": lambda s, x: s.redo(),
}


class Still(FaceScene):
    """A face that needs no time to settle."""

    def step(self, seconds):
        """Do nothing."""


@given(st.lists(st.tuples(st.sampled_from(sorted(COMMANDS)), SHARES), max_size=12))
@settings(max_examples=60, deadline=None)
def test_undo_gives_the_state_before(steps):
    """After any commands, undo returns to each earlier state, and redo to the last."""
    session = Session(SHARED_CLOCK, load_script(HELLO_FILE))

    def state():
        by_hand = None if session.is_following else dict(session.values)
        return session.script, session.file, by_hand

    for command, share in steps:
        before = state()
        place = session.history.place
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


SHARED_CLOCK = Still()


# Copies.


def test_keys_are_pasted_in_another_script(session, scene):
    """Copied keys do not change with their script, and are pasted at the playhead."""
    selection = KeySelection(session)
    assert not selection.copied
    selection.keys = KeySet.from_keys(KeyId(POSE_TRACK, 1.0), KeyId("blink", 2.12))
    assert "2 keys copied" in str(selection.copy())
    selection.delete()
    session.work.begin_script()
    session.seek(0.5)
    assert selection.copied
    assert selection.paste() == "2 keys copied to 0.50 s"
    assert selection.keys == {KeyId(POSE_TRACK, 0.5), KeyId("blink", 1.62)}
    assert all_keys(session.script) == selection.keys | {KeyId(POSE_TRACK, 0.0)}
    assert session.script.poses[1].name == "joy"
    session.undo()
    assert all_keys(session.script) == {KeyId(POSE_TRACK, 0.0)}


def test_detail_falls_once_and_does_not_flicker():
    """Slow frames lower the detail once to a level that fits.

    It rises by one level when a motion begins, or later, so that it does not flicker.
    """
    chosen = LevelOfDetail(is_software=False)
    assert chosen.detail == FULL_DETAIL
    for _ in range(PATIENCE_FRAMES):
        chosen.note(0.063)
    assert chosen.detail.scale == 0.75
    for _ in range(CALM_FRAMES - 1):
        chosen.note(0.01)
    assert chosen.level == 2
    chosen.begin_motion()
    assert chosen.level == 1
    for _ in range(CALM_FRAMES):
        chosen.note(0.01)
    assert chosen.level == 0
    for _ in range(PATIENCE_FRAMES):
        chosen.note(0.3)
    assert chosen.detail == DETAIL_LEVELS[-1]


@pytest.mark.parametrize(
    ("source", "copied"),
    [
        ("left", {"AU12_left": 0.5, "AU12_right": 0.5, "wink": 0.2, "wink_right": 0.2}),
        ("right", {"mouthSmileLeft": 0.3, "mouthSmileRight": 0.3}),
    ],
)
def test_one_side_is_copied_to_the_other(session, source, copied):
    """One side is copied to the other in all spellings of sides; eyes and jaw stay."""
    middle = {"gaze_horizontal_left": 0.4, "jaw_sideways": 0.1, "AU61": 0.2}
    session.neutral()
    set_by_hand(session, AU12_left=0.5, mouthSmileRight=0.3, wink=0.2, **middle)
    session.mirror(source)
    assert {name: value for name, value in session.values.items() if value} == copied | middle


def test_words_are_of_controls_that_there_are(session):
    """Names, synonyms and filters of the search table all refer to existing controls."""
    limits = session.controls.limits
    words = read_words()

    def is_known(name):
        return any(f"{name}{side}" in limits for side in ("", "_left", "Left"))

    found = {name for names in words["synonyms"].values() for name in names}
    assert all(map(is_known, [*words["names"], *found]))
    assert words["order"] == list(session.controls.groups)
