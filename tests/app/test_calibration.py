"""Calibration of recordings and single frames: neutral face, gains, mirroring."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.recordings.calibration import (
    BLINK_GAIN,
    OPENFACE_GAIN,
    Calibration,
    calibration_for,
    gains_of,
    neutral_now,
    neutral_of,
)
from risorius.app.recordings.names import ARKIT_SHAPES, EYE_ANGLES, HEAD_ANGLES, VISEME_NAMES

from .recording_files import take_of

SHAPES = (*ARKIT_SHAPES, "AU12", "AU12_left", "AU4_right")
ANGLES = (*HEAD_ANGLES, *EYE_ANGLES)

shapes = st.dictionaries(st.sampled_from(SHAPES), st.floats(0.0, 1.0), min_size=1)
angles = st.dictionaries(st.sampled_from(ANGLES), st.floats(-90.0, 90.0))
frames = st.builds(lambda of_shapes, of_angles: {**of_shapes, **of_angles}, shapes, angles)


def test_a_mirror_swaps_sides_and_turns_the_head():
    frame = {
        "mouthSmileLeft": 0.5, "head_yaw": 10.0, "head_pitch": 5.0, "eye_yaw_left": 3.0, "AU61": 0.2
    }  # fmt: skip
    mirrored = Calibration(mirror=True).apply(frame)
    assert mirrored == {
        "mouthSmileRight": 0.5, "head_yaw": -10.0, "head_pitch": 5.0, "eye_yaw_right": -3.0,
        "AU62": 0.2,
    }  # fmt: skip


@given(frames)
def test_the_neutral_face_becomes_rest(frame):
    calibrated = Calibration(neutral_now(frame)).apply(frame)
    assert not any(calibrated.values())


@given(frames, st.sampled_from(["first:1", "first:0", "first"]))
def test_a_face_that_never_moves_is_neutral_by_its_first_second(frame, method):
    take = take_of(**frame)
    calibrated = Calibration(neutral_of(take, method)).apply(take.channels)
    assert not any(np.any(values) for values in calibrated.values())


def test_channels_that_rest_at_zero_are_not_calibrated():
    """A held blink, gaze or open jaw is not subtracted as a part of the neutral face."""
    held = take_of(browDownLeft=0.3, jawOpen=0.3, mouthClose=0.2, eyeBlinkLeft=0.4, eyeLookInLeft=1)
    neutral = neutral_of(held)
    assert neutral == {"browDownLeft": approx(0.3)}


def test_the_head_is_straight_in_the_first_second():
    turning = take_of(seconds=3.0, head_yaw=np.r_[np.full(11, 8.0), np.full(20, 30.0)])
    calibrated = Calibration(neutral_of(turning)).apply(turning.channels)
    assert calibrated["head_yaw"][0] == approx(0.0)
    assert calibrated["head_yaw"][-1] == approx(22.0)


def test_gains_suit_the_kind_of_file():
    blinking = calibration_for(take_of(seconds=0.5, eyeBlinkLeft=0.5, jawOpen=0.5))
    assert blinking.apply({"eyeBlinkLeft": 0.5, "jawOpen": 0.5}) == {
        "eyeBlinkLeft": approx(0.5 * BLINK_GAIN),
        "jawOpen": 0.5,
    }
    units = calibration_for(take_of("OpenFace 2", seconds=0.5, AU12=0.5))
    assert units.apply({"AU12": 0.5})["AU12"] == approx(0.5 * OPENFACE_GAIN)


def test_later_gains_count_and_patterns_reach_many():
    channels = ("mouthSmileLeft", "mouthSmileRight", "jawOpen", "head_yaw")
    gains, default = gains_of(["all=2", "mouth*=1.5", "mouthSmileLeft=0"], channels)
    assert (gains, default) == ({"mouthSmileLeft": 0.0, "mouthSmileRight": 1.5}, 2.0)
    turned = Calibration(gains=gains, default_gain=default).apply({"head_yaw": 10.0})
    assert turned == {"head_yaw": 10.0}, "all is all shapes: a head turns as far as it did"


def test_a_gain_names_a_channel_as_the_file_spells_it():
    settings = ["JawOpen=0.5", "MouthSmile_L=2", "HeadYaw=3"]
    gains, _ = gains_of(settings, ["jawOpen", "mouthSmileLeft", "head_yaw"])
    assert gains == {"jawOpen": 0.5, "mouthSmileLeft": 2.0, "head_yaw": 3.0}


@pytest.mark.parametrize(
    "setting",
    ["mouthSmile=1", "jawOpen", "jawOpen=", "jawOpen=wide", "jawOpen=nan", "=1", "all=-1"],
)
def test_a_wrong_gain_is_reported(setting):
    with pytest.raises(UserError, match=rf"--gain {setting}: "):
        gains_of([setting], ["jawOpen", "mouthSmileLeft"])


@pytest.mark.parametrize("method", ["", "last", "first:x", "first:-1", "first:nan", "percentile:5"])
def test_a_wrong_neutral_is_reported(method):
    with pytest.raises(UserError, match=rf"--neutral {method}: "):
        neutral_of(take_of(jawOpen=0.1), method)


def test_visemes_are_as_they_were_written():
    take = take_of(viseme_sil=0.4)
    for method in (None, "first:1", "percentile"):
        assert set(neutral_of(take, method)) & set(VISEME_NAMES) == set()


def test_short_and_calibrated_takes_keep_their_faces():
    assert neutral_of(take_of(seconds=1.0, browDownLeft=0.3)) == {}
    calibrated = take_of(browDownLeft=0.3)
    object.__setattr__(calibrated, "is_calibrated", True)
    assert neutral_of(calibrated) == {}
