"""What undo keeps, and what a recording keeps of moves while it waits, without a window."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest

from risorius.app.errors import UserError
from risorius.app.scenes import FaceScene
from risorius.app.script import load_script, parse_script
from risorius.app.viewer.picture.skin_drag import SkinDrag
from risorius.app.viewer.session.physics import STEP
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.settings import Display, Settings

HELLO = Path("docs/hello.toml")
AHEAD = np.array([0.0, 0.0, -1.0])
BROW = 24  # another landmark
MAJOR = "zygomaticus_major_left"
SMILE = f"duration = 4\n[tracks]\n{MAJOR} = [{{time = 0, value = 0}}, {{time = 4, value = 1}}]"


@pytest.fixture
def session(scene: FaceScene) -> Session:
    """A session that shows a script of poses and a blink."""
    scene.reset()
    session = Session(scene, load_script(HELLO))
    session.show(Display())
    return session


def run(session: Session, steps: int) -> None:
    """Let so many steps of time pass."""
    for _ in range(steps):
        session.advance(STEP)


def look(session: Session, **fields: object) -> None:
    """Draw the scene in another way."""
    display = deepcopy(session.display)
    vars(display).update(fields)
    session.show(display)


def key(session: Session, time: float, **values: float) -> None:
    """Move sliders at a time, let them go, and make a key of it."""
    session.seek(time)
    for name, value in values.items():
        session.set(name, value)
    session.note()
    session.set_key()


def test_looking_differently_keeps_what_can_be_done_again(session: Session) -> None:
    """Edits that were undone come back after a change of the view, and leave the view alone."""
    before = session.script
    key(session, 1.5, jaw_open=0.7)
    look(session, wireframe=True)
    key(session, 2.5, jaw_open=0.2)
    edited = session.script
    for _ in range(5):
        session.undo()
    assert session.script == before and session.display == Display()
    look(session, light="side")
    look(session, colours="splits")
    assert session.history.labels[1:3] == ["View: light", "View: colours"]
    while session.history.can_redo:
        session.redo()
    assert session.script == edited
    assert session.display == Display(light="side", colours="splits", wireframe=True)
    while session.history.can_undo:
        session.undo()
    assert session.script == before and session.display == Display()


def test_scrubbing_keeps_what_can_be_done_again(session: Session) -> None:
    """A pose that is let go on the way to another time costs no redo of the script."""
    key(session, 1.5, jaw_open=0.7)
    edited = session.script
    session.undo()
    assert session.values["jaw_open"] == 0.7 and session.seek(3.0)
    session.redo()
    assert session.script == edited
    session.undo()
    session.undo()
    assert session.values["jaw_open"] == 0.7 and session.time == 1.5
    session.neutral()
    assert not session.history.can_redo


def paused(session: Session) -> None:
    """Begin to record at 1 s, move the jaw, and pause at 2 s."""
    session.seek(1.0)
    session.toggle_recording()
    run(session, 30)
    session.set("jaw_open", 0.5)
    run(session, 30)
    session.toggle_playing()
    run(session, 30)


def test_moves_in_a_pause_are_recorded_when_it_goes_on(session: Session) -> None:
    """They begin where it was paused."""
    paused(session)
    session.set("AU4", 0.8)
    run(session, 30)
    session.toggle_playing()
    run(session, 30)
    session.toggle_recording()
    assert session.is_following and session.script.at(1.95).get("AU4", 0.0) == 0.0
    assert session.script.at(2.05)["AU4"] == session.script.at(2.35)["AU4"] == 0.8


def test_moves_in_a_pause_stay_by_hand_when_it_ends(session: Session) -> None:
    """They are no part of the recording, which is told, and still there to be keyed."""
    paused(session)
    session.set("AU4", 0.8)
    session.set("jaw_open", 0.1)
    line = session.toggle_recording()
    assert line is not None and "1 control recorded" in line and "2 controls" in line
    assert "not keyed" in line
    assert session.values["AU4"] == 0.8 and session.values["jaw_open"] == 0.1
    assert session.differing == {"AU4", "jaw_open"} and session.has_unsaved_pose
    assert session.script.at(1.8)["jaw_open"] == pytest.approx(0.5, abs=0.002)
    assert "AU4" not in session.script.tracks
    assert "[Undo]" in (session.seek(0.0) or "")
    session.undo()
    assert session.values["AU4"] == 0.8 and session.values["jaw_open"] == 0.1


@pytest.fixture
def smiling(scene: FaceScene) -> Session:
    """A smile that comes slowly on one side."""
    scene.reset()
    return Session(scene, parse_script(SMILE, source="smile.toml"))


def test_a_pull_that_is_recorded_leaves_other_muscles_to_the_script(smiling: Session) -> None:
    """Only what holds the pulled brow is recorded; the smile goes on as the script has it."""
    smiling.toggle_recording()
    run(smiling, 10)
    brow = smiling.scene.positions[smiling.scene.head.landmarks[BROW]].copy()
    finger = SkinDrag(smiling, Settings(), brow, AHEAD, poses=True)
    before = smiling.script
    for up in np.linspace(1.0, 6.0, 6):
        finger.to(brow + up * np.eye(3)[1])
        smiling.advance(STEP)
    finger.let_go()
    run(smiling, 60)
    smiling.toggle_recording()
    assert any(name.startswith("frontalis") for name in smiling.script.tracks)
    assert smiling.script.tracks[MAJOR] is before.tracks[MAJOR]


def test_a_pose_survives_a_recording_of_nothing(smiling: Session) -> None:
    """Where no time passed, the pose is by hand again: unsaved, told when it goes, undone."""
    smiling.seek(1.0)
    smiling.set("jaw_open", 0.6)
    smiling.note()
    smiling.toggle_recording()
    with pytest.raises(UserError, match="nothing was recorded"):
        smiling.toggle_recording()
    assert smiling.values["jaw_open"] == 0.6 and smiling.has_unsaved_pose
    assert "[Undo]" in (smiling.seek(2.0) or "")
    smiling.undo()
    assert smiling.values["jaw_open"] == 0.6
