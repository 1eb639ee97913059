"""iFacialMocap: a line of text for each frame.

    mouthSmile_L-37|browDown_R-5|...|=head#rx,ry,rz,x,y,z|rightEye#rx,ry,rz|leftEye#rx,ry,rz|

Shapes are in percent. Version 2 writes & where version 1 writes -, which leaves room for a sign. A
shape that is not named has not changed. Blocks may come in any order; some apps name shapes in
full (mouthSmileLeft), and some put trackingStatus-0 where they see no face.

Angles are in degrees, about x, y and z; in the maker's own example eyes that look down have a
positive x, and eyes that look to the subject's left a positive y, so that z grows to the right
shoulder.

The app sends to the address that is typed into it. Where it is given none it waits for a word
(`REQUEST`), which makes it answer.

Source: iFacialMocap, "Communication specifications" (ifacialmocap.com/for-developer).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..recordings.names import ARKIT
from .frame import LiveFrame, put_angle, put_shape, shape_named

PORT = 49983
REQUEST = b"iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719"
# Block -> channels of its first three numbers, with their signs; "" for what is not used.
BLOCKS = {
    "head": (("head_pitch", -1.0), ("head_yaw", 1.0), ("head_roll", -1.0)),
    "leftEye": (("eye_pitch_left", -1.0), ("eye_yaw_left", 1.0)),
    "rightEye": (("eye_pitch_right", -1.0), ("eye_yaw_right", 1.0)),
}
_NO_FACE = ("trackingStatus-0", "trackingStatus&0")


def parse(packet: bytes) -> LiveFrame | None:
    """The frame in a packet, None if it is none; see the head of this file."""
    try:
        text = packet.decode("ascii")
    except UnicodeDecodeError:
        return None
    channels: dict[str, float] = {}
    for part in text.replace("=", "|").split("|"):
        name, mark, numbers = part.partition("#")
        if mark:
            _put_block(channels, name.strip(), numbers)
        else:
            _put_written_shape(channels, part)
    has_face = not any(word in text for word in _NO_FACE)
    return LiveFrame(channels, has_face=has_face) if channels or not has_face else None


def _put_block(channels: dict[str, float], name: str, numbers: str) -> None:
    for (channel, sign), number in zip(BLOCKS.get(name, ()), numbers.split(","), strict=False):
        put_angle(channels, channel, sign * _number(number))


def _put_written_shape(channels: dict[str, float], written: str) -> None:
    name, _, percent = written.partition("&" if "&" in written else "-")
    shape = shape_named(name.strip())
    if shape is not None:
        put_shape(channels, shape, _number(percent) / 100.0)


def _number(text: str) -> float:
    """A number as the app writes it; NaN for anything else."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def packets(channels: Mapping[str, float], *, subject: str, frame: int) -> list[bytes]:
    """What the app would send of these channels: one packet; `subject` and `frame` are not told."""
    shapes = [
        f"{_short(name)}-{round(100.0 * channels[name])}" for name in ARKIT if name in channels
    ]
    blocks = [
        f"{block}#"
        + ",".join(f"{sign * channels.get(name, 0.0):.4f}" for name, sign in signs)
        # What the head is away from the camera, or how an eye rolls, nobody needs to know.
        + (",0,0,0" if block == "head" else ",0")
        for block, signs in BLOCKS.items()
    ]
    return [("|".join(shapes) + "|=" + "|".join(blocks) + "|").encode("ascii")]


def _short(name: str) -> str:
    """As the app spells it: _L and _R but for jaw and mouth as a whole."""
    if name in ("jawLeft", "jawRight", "mouthLeft", "mouthRight"):
        return name
    return name.replace("Left", "_L").replace("Right", "_R")
