"""Mapping of a recording's channels to the controls of the face.

Shapes, action units and visemes move the control of the same name; angles move head and eyes. If
two channels measure the same motion, only one of them moves the face, see `chosen`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np

from risorius.geometry.arrays import Floats64

from ..control_names.angles import FULL_ANGLES
from .names import ARKIT_SHAPES

Value = TypeVar("Value", float, Floats64)

_ACTION_UNIT = re.compile(r"(AU[0-9]{1,2})(_left|_right)?")
_SHAPE_OF_UNIT = {  # action unit -> beginning of the names of shapes that also measure it
    "AU1": "browInnerUp", "AU2": "browOuterUp", "AU4": "browDown", "AU5": "eyeWide",
    "AU6": "cheekSquint", "AU7": "eyeSquint", "AU9": "noseSneer", "AU10": "mouthUpperUp",
    "AU12": "mouthSmile", "AU14": "mouthDimple", "AU15": "mouthFrown", "AU16": "mouthLowerDown",
    "AU17": "mouthShrug", "AU18": "mouthPucker", "AU20": "mouthStretch", "AU22": "mouthFunnel",
    "AU23": "mouthPress", "AU24": "mouthPress", "AU25": "jawOpen", "AU26": "jawOpen",
    "AU27": "jawOpen", "AU28": "mouthRoll", "AU34": "cheekPuff", "AU43": "eyeBlink",
    "AU45": "eyeBlink", "AU46": "eyeBlink",
}  # fmt: skip
ARKIT_SET = frozenset(ARKIT_SHAPES)
_LOOKS_OF_ANGLE = {
    f"eye_{angle}_{side.lower()}": frozenset(f"eyeLook{way}{side}" for way in ways)
    for angle, ways in (("yaw", ("In", "Out")), ("pitch", ("Up", "Down")))
    for side in ("Left", "Right")
}


def controls_of(channels: Mapping[str, Value]) -> dict[str, Value]:
    """Convert channels to values of controls, arrays or numbers like the input.

    Values are not cut off at the limits of controls.
    """
    controls: dict[str, Value] = {}
    of_eyes = {
        "eye_yaw_left": "gaze_horizontal_left",
        "eye_yaw_right": "gaze_horizontal_right",
        "eye_pitch_left": "gaze_vertical_left",
        "eye_pitch_right": "gaze_vertical_right",
    }
    for channel in chosen(channels):
        control = of_eyes.get(channel, channel)
        controls[control] = channels[channel] / FULL_ANGLES.get(control, 1.0)
    return controls


def chosen(channels: Mapping[str, Any]) -> tuple[str, ...]:
    """Choose the channels that move the face, if two channels measure the same motion.

    Angles of eyes replace eyeLook shapes, which are derived from the angles and are limited. If an
    angle is always 0, the tracker does not measure it, and the shapes are used. Shapes of ARKit
    replace the action units that measure the same motion, because shapes separate left and right.
    """
    left_out: set[str] = set()
    for angle, looks in _LOOKS_OF_ANGLE.items():
        if angle in channels and not looks.isdisjoint(channels):
            left_out |= looks if np.any(channels[angle]) else {angle}
    shapes = tuple(name for name in channels if name in ARKIT_SET)
    for name in channels:
        unit = _ACTION_UNIT.fullmatch(name) if shapes else None
        twin = _SHAPE_OF_UNIT.get(unit[1]) if unit else None
        if twin and any(shape.startswith(twin) for shape in shapes):
            left_out.add(name)
    return tuple(name for name in channels if name not in left_out)
