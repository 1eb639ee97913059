"""What a recording holds, without a window: a finger's muscles, and a pose that it found."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.app.errors import UserError
from risorius.app.scenes import FaceScene
from risorius.app.script import parse_script
from risorius.app.viewer.picture.skin_drag import SkinDrag
from risorius.app.viewer.session.physics import STEP
from risorius.app.viewer.session.session import Session
from risorius.app.viewer.settings import Settings

MAJOR = "zygomaticus_major_left"
SCRIPT = f"duration = 4\n[tracks]\n{MAJOR} = [{{time = 0, value = 0}}, {{time = 4, value = 1}}]"
BROW = 24  # a landmark
AHEAD = np.array([0.0, 0.0, -1.0])


@pytest.fixture
def session() -> Session:
    """A smile that comes slowly on one side."""
    return Session(FaceScene(), parse_script(SCRIPT, source="smile.toml"))


def test_a_pull_that_is_recorded_leaves_other_muscles_to_the_script(session: Session) -> None:
    """Only what holds the pulled brow is recorded; the smile goes on as the script has it."""
    session.toggle_recording()
    for _ in range(10):
        session.advance(STEP)
    brow = session.scene.positions[session.scene.head.landmarks[BROW]].copy()
    finger = SkinDrag(session, Settings(), brow, AHEAD, poses=True)
    before = session.script
    for up in np.linspace(1.0, 6.0, 6):
        finger.to(brow + up * np.eye(3)[1])
        session.advance(STEP)
    finger.let_go()
    for _ in range(60):
        session.advance(STEP)
    session.toggle_recording()
    assert any(name.startswith("frontalis") for name in session.script.tracks)
    assert session.script.tracks[MAJOR] is before.tracks[MAJOR]


def test_a_pose_survives_a_recording_of_nothing(session: Session) -> None:
    """Where no time passed, the pose is by hand again: unsaved, told when it goes, undone."""
    session.seek(1.0)
    session.set("jaw_open", 0.6)
    session.note()
    session.toggle_recording()
    with pytest.raises(UserError, match="nothing was recorded"):
        session.toggle_recording()
    assert session.values["jaw_open"] == 0.6 and session.has_unsaved_pose
    assert "[Undo]" in (session.seek(2.0) or "")
    session.undo()
    assert session.values["jaw_open"] == 0.6
