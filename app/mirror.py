"""What a mirror makes of a face: the names of the other side, and the values that turn round.

The same for controls and for the channels of recordings.
"""

from __future__ import annotations

SIDES = (("_left", "_right"), ("Left", "Right"))  # how names end: ours, ARKit's
TURNED = (  # to one side where their value is above 0, to the other below
    "jaw_sideways", "gaze_horizontal", "gaze_horizontal_left", "gaze_horizontal_right",
    "eye_yaw_left", "eye_yaw_right", "head_yaw", "head_roll",
)  # fmt: skip
_TWINS = {  # action units that are each other's image without saying so: eyes turn left, right ...
    "AU61": "AU62", "AU62": "AU61", "AU51": "AU52", "AU52": "AU51", "AU55": "AU56", "AU56": "AU55",
}  # fmt: skip


def parted(name: str) -> tuple[str, str]:
    """A name without its side, and the side as it is spelled; "" for the middle."""
    for side in (side for pair in SIDES for side in pair):
        if name.endswith(side):
            return name.removesuffix(side), side
    return name, ""


def twin_of(name: str) -> str:
    """The name on the other side; itself for one of the middle."""
    base, side = parted(name)
    for left, right in SIDES:
        if side in (left, right):
            return base + (right if side == left else left)
    return _TWINS.get(name, name)
