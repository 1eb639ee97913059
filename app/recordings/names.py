"""The channels of a take: names and units that all readers of recordings use.

    mouthSmileLeft ...      the 52 shapes of Apple's ARKit, 0 to 1, and a little beyond by noise
    AU12, AU12_left ...     action units, 0 to 1 (intensity E is 1)
    viseme_PP ...           visemes, 0 to 1
    head_yaw, head_pitch, head_roll                       [degrees]
    eye_yaw_left, eye_pitch_left, eye_yaw_right, eye_pitch_right    [degrees], in the head's frame

Left and right are the subject's own. Angles grow to the subject's left, up, and (roll) to the left
shoulder, like the controls. Only readers convert the signs and units of a format.

Programs spell these names in many ways, which the functions below recognise: `mouthSmile_L`,
`MouthSmileLeft`, `blendShapes.mouthSmileLeft` and `mouth_smile_left` are one name.

Source: Apple, ARFaceAnchor.BlendShapeLocation (the names).
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass

import numpy as np

from risorius.geometry.arrays import Floats64

ARKIT_SHAPES = (
    "eyeBlinkLeft", "eyeLookDownLeft", "eyeLookInLeft", "eyeLookOutLeft", "eyeLookUpLeft",
    "eyeSquintLeft", "eyeWideLeft", "eyeBlinkRight", "eyeLookDownRight", "eyeLookInRight",
    "eyeLookOutRight", "eyeLookUpRight", "eyeSquintRight", "eyeWideRight", "jawForward", "jawLeft",
    "jawRight", "jawOpen", "mouthClose", "mouthFunnel", "mouthPucker", "mouthLeft", "mouthRight",
    "mouthSmileLeft", "mouthSmileRight", "mouthFrownLeft", "mouthFrownRight", "mouthDimpleLeft",
    "mouthDimpleRight", "mouthStretchLeft", "mouthStretchRight", "mouthRollLower",
    "mouthRollUpper", "mouthShrugLower", "mouthShrugUpper", "mouthPressLeft", "mouthPressRight",
    "mouthLowerDownLeft", "mouthLowerDownRight", "mouthUpperUpLeft", "mouthUpperUpRight",
    "browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight",
    "cheekPuff", "cheekSquintLeft", "cheekSquintRight", "noseSneerLeft", "noseSneerRight",
    "tongueOut",
)  # fmt: skip
"""The 52 shapes in ARKit's order, which packets without names use."""

LARGEST_VALUE = 3.0  # a larger value is an error
LARGEST_ANGLE = 360.0  # [degrees]; a larger one is an error
HEAD_ANGLES = ("head_yaw", "head_pitch", "head_roll")
EYE_ANGLES = ("eye_yaw_left", "eye_pitch_left", "eye_yaw_right", "eye_pitch_right")
ANGLE_NAMES = frozenset((*HEAD_ANGLES, *EYE_ANGLES))
VISEME_NAMES = tuple(
    f"viseme_{sound}" for sound in "sil PP FF TH DD kk CH SS nn RR aa E ih oh ou".split()
)

ACTION_UNIT = re.compile(
    r"au[ _]?0*([1-9]\d?)(?:[ _]?(r|c|l|left|right))?"
    r"(?:[ _.-]?(int(?:ensity)?|detection|detected|presence|present|binary|occurrence))?$"
)
OCULUS_VOWELS = {"i": "ih", "o": "oh", "u": "ou", "e": "E"}  # Oculus' visemes -> ours
VISEME_BY_SOUND = {name.removeprefix("viseme_").casefold(): name for name in VISEME_NAMES}


def measured(name: str, values: Floats64) -> Floats64:
    """Return the values of a channel, with NaN for values too large for a measurement."""
    largest = LARGEST_ANGLE if name in ANGLE_NAMES else LARGEST_VALUE
    return np.where(np.abs(values) > largest, np.nan, values)


def letters_of(name: str) -> str:
    """Return a name in lower case, without separators between words."""
    return re.sub(r"[^a-z0-9]", "", name.casefold())


def _spellings() -> dict[str, str]:
    """Return spelling without separators -> shape; a side may be shortened to L or R."""
    found = {}
    for name in ARKIT_SHAPES:
        found[letters_of(name)] = name
        for side in ("Left", "Right"):
            if name.endswith(side):
                found[letters_of(name.removesuffix(side) + side[0])] = name
    return found


def _angle_spellings() -> dict[str, str]:
    """Return spelling without separators -> angle, for all orders of words."""
    found = {letters_of(name): name for name in (*HEAD_ANGLES, *EYE_ANGLES)}
    for name in EYE_ANGLES:
        _, axis, side = name.split("_")
        for spelling in (f"{side}eye{axis}", f"eye{axis}{side[0]}", f"eye{side}{axis}"):
            found[spelling] = name
    return found


SHAPE_BY_SPELLING = _spellings()
ANGLE_BY_SPELLING = _angle_spellings()


@dataclass(frozen=True)
class ActionUnitName:
    """An action unit that a column holds.

    side: "_left", "_right", or "" for both or unknown. is_short_right: whether the side is
    only the letter R; in OpenFace's files without an L, this R means intensity. kind: "intensity",
    "detection", or "" if the name does not show it.
    """

    number: int
    side: str
    is_short_right: bool
    kind: str

    def channel(self, has_sides: bool) -> str:
        """Return the channel's name. has_sides: whether the file has a column for a left side."""
        side = "" if self.is_short_right and not has_sides else self.side
        return f"AU{self.number}{side}"


def unit_of(column: str) -> ActionUnitName | None:
    """Return the action unit that a column holds, by its name; None for other columns."""
    match = ACTION_UNIT.match(column.casefold())
    if match is None:
        return None
    sides = {"l": "_left", "left": "_left", "r": "_right", "right": "_right"}
    kind = ""
    if match[3]:
        kind = "intensity" if match[3].startswith("int") else "detection"
    if match[2] == "c":
        kind = "detection"
    return ActionUnitName(int(match[1]), sides.get(match[2] or "", ""), match[2] == "r", kind)


@functools.lru_cache(maxsize=4096)  # JSON names each shape again in each frame
def shape_of(column: str) -> str | None:
    """Return the ARKit shape that a column holds, by its name; None for other columns."""
    last_word = re.split(r"[.:/|]", column)[-1]
    return SHAPE_BY_SPELLING.get(letters_of(column)) or SHAPE_BY_SPELLING.get(letters_of(last_word))


def angle_of(column: str) -> str | None:
    """Return the angle of head or eye that a column holds, by its name, or None."""
    return ANGLE_BY_SPELLING.get(letters_of(column))


def viseme_of(column: str) -> str | None:
    """Return the viseme of a column or track: `viseme_PP`, `PP`, or Oculus' `I`, `O`, `U`."""
    sound = column.strip().casefold().removeprefix("viseme_").removeprefix("v_")
    return VISEME_BY_SOUND.get(OCULUS_VOWELS.get(sound, sound).casefold())
