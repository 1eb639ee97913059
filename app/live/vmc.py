"""VMC, the Virtual Motion Capture protocol: several OSC messages for each frame.

    /VMC/Ext/Blend/Val   name, value        a shape
    /VMC/Ext/Blend/Apply                    applies all shapes before it
    /VMC/Ext/Bone/Pos    name, x, y, z, and a quaternion x, y, z, w

52 shapes do not fit into one packet, so several packets may come before Apply. Senders spell names
in lower or upper case. A channel that is named more than once gets the last value.

Bones turn in Unity's axes: x to the avatar's right, y up, z ahead, left-handed. Only the head (with
the neck, if it is in the same packet) and the eyes are read.

This module splits bundles without the library, because a negative length in a bundle makes the
library loop forever.

Source: protocol.vmc.info.
"""

from __future__ import annotations

import contextlib
import math
import re
import struct
from collections.abc import Iterator, Mapping

from scipy.spatial.transform import Rotation

with contextlib.suppress(ImportError):  # see Protocol.check
    from pythonosc.osc_message import OscMessage
    from pythonosc.osc_message import ParseError as MessageError

from risorius.geometry.transforms import angles_of

from .frame import LiveFrame, set_angle, set_shape, shape_named

_BUNDLE_MARK = b"#bundle\0"
_HEADER_LENGTH = len(_BUNDLE_MARK) + 8  # the mark and a time, which is ignored
# First bytes of the messages that are read; the library might log errors for other messages.
_KNOWN_BEGINNING = re.compile(
    rb"/VMC/Ext/(Blend/Val\0\0,s[fdi]\0|Blend/Apply\0{4}(,\0{3})?\Z|Bone/Pos\0{3},sf{7}\0{3})"
)
Quaternion = tuple[float, float, float, float]  # x, y, z, w


def parse(packet: bytes) -> LiveFrame | None:
    """Return the channels that a packet adds to a frame; None if it is not a packet of VMC."""
    channels: dict[str, float] = {}
    bones: dict[str, Quaternion] = {}
    has_values = is_applied = False
    try:
        value_address = "/VMC/Ext/Blend/Val"
        apply_address = "/VMC/Ext/Blend/Apply"
        most_depth = 4  # depth to which bundles may be nested
        read_bones = ("Neck", "Head", "LeftEye", "RightEye")
        for message in _messages(packet, most_depth):
            if not _KNOWN_BEGINNING.match(message):
                continue
            parsed = OscMessage(message)
            if parsed.address == apply_address:
                is_applied = True
            elif parsed.address == value_address:
                has_values = True
                name, value = parsed.params
                if shape := shape_named(name):
                    set_shape(channels, shape, value)
            elif parsed.params[0] in read_bones:
                name, _, _, _, x, y, z, w = parsed.params
                bones[name] = (x, y, z, w)
    except (MessageError, ValueError, struct.error):  # a Unicode error is a ValueError
        return None
    _set_bones(channels, bones)
    if not (has_values or is_applied or bones):
        return None
    return LiveFrame(channels, is_complete=is_applied or not has_values)


def _messages(packet: bytes, depth: int) -> Iterator[bytes]:
    """Yield the messages of a packet as bytes; raise ValueError for a truncated bundle."""
    if not packet.startswith(_BUNDLE_MARK):
        yield packet
        return
    at = _HEADER_LENGTH
    while at < len(packet):
        (size,) = struct.unpack_from(">i", packet, at)
        at += 4
        if size < 0 or at + size > len(packet) or depth == 0:
            raise ValueError
        yield from _messages(packet[at : at + size], depth - 1)
        at += size


def _set_bones(channels: dict[str, float], bones: Mapping[str, Quaternion]) -> None:
    if "Head" in bones:
        chain = [bones[name] for name in ("Neck", "Head") if name in bones]
        for name, angle in zip(("yaw", "pitch", "roll"), _angles(*chain), strict=True):
            set_angle(channels, f"head_{name}", angle)
    for side in ("Left", "Right"):
        if f"{side}Eye" in bones:
            yaw, pitch, _ = _angles(bones[f"{side}Eye"])
            set_angle(channels, f"eye_yaw_{side.lower()}", yaw)
            set_angle(channels, f"eye_pitch_{side.lower()}", pitch)


def _angles(*turns: Quaternion) -> tuple[float, float, float]:
    """Return yaw, pitch and roll [degrees] of a chain of rotations, with the signs of names.py.

    The angles are NaN if a quaternion is too near to 0, or too large, to be a rotation.
    """
    if not all(1e-6 < math.hypot(*turn) < 1e6 for turn in turns):
        return math.nan, math.nan, math.nan
    whole = Rotation.identity()
    for turn in turns:
        whole *= Rotation.from_quat(turn)
    # Unity's x points to the subject's right, which mirrors yaw and roll.
    yaw, pitch, roll = angles_of(whole.as_matrix())
    return -yaw, pitch, -roll
