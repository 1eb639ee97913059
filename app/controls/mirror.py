"""What a mirror makes of a face: the names of the other side, and the values that turn round.

The same for controls and for the channels of recordings.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping

SIDES = (("_left", "_right"), ("Left", "Right"))  # how names end: ours, ARKit's
TURNED = (  # to one side where their value is above 0, to the other below
    "jaw_sideways", "gaze_horizontal", "gaze_horizontal_left", "gaze_horizontal_right",
    "eye_yaw_left", "eye_yaw_right", "head_yaw", "head_roll",
)  # fmt: skip
# Sides of a motion, not of the face: both at once stand still.
OPPOSITE = ("AU30", "lips_sideways", "jaw", "mouth")
SIDEWAYS = ("gaze_horizontal", "eye_yaw", "eyeLookIn", "eyeLookOut")  # copied, eyes would cross
KNOWN = 4096  # names that are taken apart once: panels ask for all of theirs in each frame
_TWINS = {  # action units that are each other's image without saying so: eyes turn left, right ...
    "AU61": "AU62", "AU62": "AU61", "AU51": "AU52", "AU52": "AU51", "AU55": "AU56", "AU56": "AU55",
    "wink": "wink_right", "wink_right": "wink", "contempt": "contempt_right",
    "contempt_right": "contempt",
}  # fmt: skip


@functools.lru_cache(maxsize=KNOWN)
def parted(name: str) -> tuple[str, str]:
    """A name without its side, and the side as it is spelled; "" for the middle."""
    for side in (side for pair in SIDES for side in pair):
        if name.endswith(side):
            return name.removesuffix(side), side
    return name, ""


@functools.lru_cache(maxsize=KNOWN)
def twin_of(name: str) -> str:
    """The name on the other side; itself for one of the middle."""
    if name in _TWINS:
        return _TWINS[name]
    base, side = parted(name)
    for left, right in SIDES:
        if side in (left, right):
            return base + (right if side == left else left)
    return name


def mirrored(values: Mapping[str, float]) -> dict[str, float]:
    """What is left becomes right; the middle turns round."""
    result = dict(values)
    for name, value in values.items():
        if twin_of(name) in values:
            result[twin_of(name)] = -value if name in TURNED else value
    return result


def copied(values: Mapping[str, float], source: str) -> dict[str, float]:
    """One side ("left" or "right") becomes the other, too; the middle and the gaze stay."""
    result = dict(values)
    for name, value in values.items():
        base, side = parted(name)
        twin = twin_of(name)
        is_whole = not side and parted(twin)[0] != name  # of both sides, or a direction
        if is_whole or base in OPPOSITE or base.startswith(SIDEWAYS) or twin not in values:
            continue
        if (side.strip("_").lower() or "left") == source:
            result[twin] = value
    return result
