"""Mapping of a recording's channels to controls of the face."""

import numpy as np
import pytest

from risorius.app.recordings.mapping import chosen, controls_of
from risorius.app.recordings.names import EYE_ANGLES


def test_angles_become_fractions_of_the_range_of_neck_and_eyes():
    """An angle becomes a control: its fraction of the greatest angle of neck or eye."""
    angles = {"head_yaw": 45.0, "head_pitch": -15.0, "head_roll": 30.0, "eye_yaw_left": 15.0}
    assert controls_of(angles) == pytest.approx(
        {"head_yaw": 1.0, "head_pitch": -0.5, "head_roll": 1.0, "gaze_horizontal_left": 0.5},
        abs=1e-4,
    )


def test_eyes_move_by_their_angles_or_else_by_their_shapes():
    """Each eye moves by its angles, or by its shapes where an angle is always 0.

    An angle that is always 0 was not measured.
    """
    shapes = {"eyeLookInLeft": 0.5, "eyeLookUpLeft": 0.2, "eyeLookInRight": 0.1, "jawOpen": 0.1}
    measured = {"eye_yaw_left": -3.0, "eye_pitch_left": 0.0, "eye_yaw_right": np.array([0.0, 2.0])}
    assert set(chosen({**shapes, **measured})) == {
        "eye_yaw_left", "eyeLookUpLeft", "eye_yaw_right", "jawOpen"
    }  # fmt: skip
    angles = dict.fromkeys(EYE_ANGLES, 0.0)
    assert set(chosen({**shapes, **angles})) == {*shapes, "eye_pitch_right"}
    assert set(chosen(angles)) == set(EYE_ANGLES)


def test_an_action_unit_counts_where_no_shape_means_the_same():
    assert set(chosen({"AU12": 1.0, "AU4_left": 1.0})) == {"AU12", "AU4_left"}
    both = {"AU12": 1.0, "AU6": 1.0, "AU26_left": 1.0, "mouthSmileLeft": 0.2, "viseme_PP": 1.0}
    assert set(chosen(both)) == {"AU6", "AU26_left", "mouthSmileLeft", "viseme_PP"}
    assert set(chosen({**both, "jawOpen": 0.1})) == {*chosen(both), "jawOpen"} - {"AU26_left"}
