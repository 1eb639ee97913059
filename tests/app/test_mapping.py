"""The table from channels of a recording to controls of the face."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from risorius.app.errors import UserError
from risorius.app.recordings.mapping import (
    chosen,
    load_mapping,
    parse_mapping,
    usual_mapping,
)
from risorius.app.recordings.names import ARKIT, EYE_ANGLES, VISEMES
from risorius.app.scenes import FaceScene


def test_a_channel_moves_the_control_of_its_name() -> None:
    values = dict.fromkeys((*ARKIT, *VISEMES), 0.5)
    assert usual_mapping().controls(values) == values


def test_angles_become_shares_of_what_neck_and_eyes_can() -> None:
    angles = {"head_yaw": 45.0, "head_pitch": -15.0, "head_roll": 30.0, "eye_yaw_left": 15.0}
    assert usual_mapping().controls(angles) == pytest.approx(
        {"head_yaw": 1.0, "head_pitch": -0.5, "head_roll": 1.0, "gaze_horizontal_left": 0.5},
        abs=1e-4,
    )


def test_eyes_move_by_their_angles_or_else_by_their_shapes() -> None:
    """Each eye and each direction for itself; an angle that is always 0 was not measured."""
    shapes = {"eyeLookInLeft": 0.5, "eyeLookUpLeft": 0.2, "eyeLookInRight": 0.1, "jawOpen": 0.1}
    measured = {"eye_yaw_left": -3.0, "eye_pitch_left": 0.0, "eye_yaw_right": np.array([0.0, 2.0])}
    assert set(chosen({**shapes, **measured})) == {
        "eye_yaw_left", "eyeLookUpLeft", "eye_yaw_right", "jawOpen"
    }  # fmt: skip
    angles = dict.fromkeys(EYE_ANGLES, 0.0)
    assert set(chosen({**shapes, **angles})) == {*shapes, "eye_pitch_right"}
    assert set(chosen(angles)) == set(EYE_ANGLES)


def test_an_action_unit_counts_where_no_shape_tells_the_same() -> None:
    assert set(chosen({"AU12": 1.0, "AU4_left": 1.0})) == {"AU12", "AU4_left"}
    both = {"AU12": 1.0, "AU6": 1.0, "AU26_left": 1.0, "mouthSmileLeft": 0.2, "viseme_PP": 1.0}
    assert set(chosen(both)) == {"AU6", "AU26_left", "mouthSmileLeft", "viseme_PP"}
    assert set(chosen({**both, "jawOpen": 0.1})) == {*chosen(both), "jawOpen"} - {"AU26_left"}


def test_shares_add_up_for_arrays_as_for_numbers() -> None:
    table = "jawOpen = { jaw_open = 0.5, lips_closed = -0.2 }\nmouthFunnel = { jaw_open = 0.1 }"
    mapping = parse_mapping(table, source="t")
    assert mapping.controls({"jawOpen": 1.0, "mouthFunnel": 1.0}) == pytest.approx(
        {"jaw_open": 0.6, "lips_closed": -0.2}
    )
    curves = mapping.controls(
        {"jawOpen": np.array([0.0, 1.0]), "mouthFunnel": np.array([0.0, 1.0])}
    )
    np.testing.assert_allclose(curves["jaw_open"], [0.0, 0.6])


def test_a_table_of_ones_own_goes_over_the_usual_one(tmp_path: Path) -> None:
    path = tmp_path / "my.toml"
    path.write_text("mouthSmileLeft = {}\nhead_yaw = { head_yaw = 0.05 }\n", encoding="utf-8")
    controls = load_mapping(path).controls(
        {"mouthSmileLeft": 1.0, "head_yaw": 10.0, "head_roll": 3}
    )
    assert controls == pytest.approx({"head_yaw": 0.5, "head_roll": 0.1}, abs=1e-4)


def test_a_table_names_controls_that_the_face_has() -> None:
    limits = FaceScene().limits
    usual_mapping().check(limits)
    with pytest.raises(UserError, match="row 'AU12': there is no control called 'smile_muscle'"):
        parse_mapping("AU12 = { smile_muscle = 1 }", source="my.toml").check(limits)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ("jawOpen = 1", r"'jawOpen': was 1, must be a table"),
        ("jawopen = { jaw_open = 1 }", "'jawopen': no recording has such a channel"),
        ("jawOpen = { jaw_open = true }", "'jaw_open': was True, must be a number from -2 to 2"),
        ("jawOpen = { jaw_open = nan }", "'jaw_open': was nan, must be a number"),
        ("jawOpen = { jaw_open = 3 }", "'jaw_open': was 3, must be a number"),
        (f"jawOpen = {{ jaw_open = 1{'0' * 400} }}", "'jaw_open': was 10+.*, must be a number"),
        ("jawOpen = { jaw_open = '1' }", "'jaw_open': was '1', must be a number"),
        ("jawOpen = {", "not valid TOML"),
    ],
)
def test_a_wrong_table_is_told_in_one_line(tmp_path: Path, table: str, told: str) -> None:
    path = tmp_path / "my.toml"
    path.write_text(table, encoding="utf-8")
    with pytest.raises(UserError, match=told) as error:
        load_mapping(path)
    assert str(error.value).startswith(str(path))
