"""Live Link Face, the app of Epic Games: one binary packet for each frame.

    u8 version, 6                      then, big-endian:
    i32 length, device id              i32 length, subject's name
    i32 frame, f32 part of a frame, i32 frames a second, i32 denominator of these
    u8 count of values, 61             f32 values: 52 shapes, 3 angles each of head and both eyes

A packet without values, or with a count of 0, means that no face was seen. The order of shapes is
ARKit's; the app's files have another order. Angles are in radians: an eye that looks fully down has
a pitch of 0.61. Angles grow to the subject's right, downward, and to the right shoulder.

Source: packets of the app; Epic Games, "Live Link Face", and its table of blend shapes.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping

from ..recordings.named_columns import OUTWARD_ANGLES
from ..recordings.names import ARKIT_SHAPES
from .frame import LiveFrame, readable_subject, set_angle, set_shape

PROTOCOL_VERSION = 6
VALUE_COUNT = 61
LONGEST_TEXT = 1024  # [bytes] of an id or a name
# Channels after the shapes; None for the roll of eyes.
ANGLE_CHANNELS = (
    "head_yaw", "head_pitch", "head_roll",
    "eye_yaw_left", "eye_pitch_left", None, "eye_yaw_right", "eye_pitch_right", None,
)  # fmt: skip


def parse(packet: bytes) -> LiveFrame | None:
    """Parse a packet in the format above; return None for any other packet."""
    if packet[:1] != bytes([PROTOCOL_VERSION]):
        return None
    try:
        _, at = _text(packet, 1)
        subject, at = _text(packet, at)
        at += struct.calcsize(">ifii")
        if len(packet) < at:
            return None
        name = readable_subject(subject)
        if len(packet) == at or packet[at:] in (b"\0", bytes([VALUE_COUNT])):
            return LiveFrame(subject=name, has_face=False)
        if packet[at] != VALUE_COUNT or len(packet) != at + 1 + 4 * VALUE_COUNT:
            return None
        values = struct.unpack_from(f">{VALUE_COUNT}f", packet, at + 1)
    except (struct.error, ValueError):
        return None
    channels: dict[str, float] = {}
    for shape, value in zip(ARKIT_SHAPES, values, strict=False):
        set_shape(channels, shape, value)
    for angle, value in zip(ANGLE_CHANNELS, values[len(ARKIT_SHAPES) :], strict=True):
        if angle is not None:
            set_angle(channels, angle, -math.degrees(value) - OUTWARD_ANGLES.get(angle, 0.0))
    return LiveFrame(channels, name)


def _text(packet: bytes, at: int) -> tuple[bytes, int]:
    """Read a length and a text; return text and end. Raises ValueError for a wrong length."""
    (length,) = struct.unpack_from(">i", packet, at)
    end = at + 4 + length
    if not 0 <= length <= LONGEST_TEXT or end > len(packet):
        raise ValueError
    return packet[at + 4 : end], end


def packet_of(channels: Mapping[str, float], *, subject: str, frame: int) -> bytes:
    """Return Live Link Face's packet for these channels; missing channels are 0."""
    values = [channels.get(name, 0.0) for name in ARKIT_SHAPES]
    for angle in ANGLE_CHANNELS:
        degrees = channels.get(angle or "", 0.0) + OUTWARD_ANGLES.get(angle or "", 0.0)
        values.append(-math.radians(degrees))
    head = struct.pack(">B", PROTOCOL_VERSION)
    device = b"risorius"
    for text in (device, subject.encode()[:LONGEST_TEXT]):
        head += struct.pack(">i", len(text)) + text
    frame_rate = 60
    time = struct.pack(">ifii", frame, 0.0, frame_rate, 1)
    return head + time + struct.pack(f">B{VALUE_COUNT}f", VALUE_COUNT, *values)
