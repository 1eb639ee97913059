"""The face of a window is recognised as at rest, so that the window can sleep."""

import numpy as np
import pytest

from risorius.app.performances import script_for
from risorius.app.viewer.session.physics import STEP_TIME, FrameTimes, Physics
from risorius.app.viewer.session.session import Session
from tests.sim.poses import advance


@pytest.mark.parametrize("control", ["anger", "mentalis", "joy"])
def test_a_held_pose_comes_to_rest(face, control):
    """A held pose comes to rest, also if lips in contact tremble by some thousandths of a mm."""
    session = Session(face, script_for(None, "face"))
    physics = Physics(session, FrameTimes())
    session.set(control, 1.0)
    for _ in range(240):
        physics.advance(STEP_TIME, is_skin_dragged=False)
        if physics.is_at_rest:
            break
    assert physics.is_at_rest
    rested = session.scene.positions.copy()
    advance(session.scene, 120, STEP_TIME)
    assert np.abs(session.scene.positions - rested).max() < 0.05  # no motion was left
    assert np.abs(rested - session.scene.rest_positions).max() > 1.0
