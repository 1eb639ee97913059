"""VMC, the Virtual Motion Capture protocol: OSC messages, several to a frame.

    /VMC/Ext/Blend/Val   name, value        a shape, an expression or a vowel
    /VMC/Ext/Blend/Apply                    now those before it count
    /VMC/Ext/Bone/Pos    name, x, y, z, and a quaternion x, y, z, w

52 shapes take more room than one packet has, so they may come in several before Apply. Senders
spell names with small and with capital letters. Besides ARKit's shapes they send the presets of VRM
avatars, version 0 and 1. One channel that is named more than once gets the greatest value.

Bones turn in Unity's axes: x to the avatar's right, y up, z ahead, left-handed. Of these we take
the head (with the neck, if it is in the same packet) and the eyes.

Bundles are taken apart here and not by the library, which never comes back from one that holds a
negative length.

Source: protocol.vmc.info; VRM 0.x and 1.0, presets of expressions; Ekman and Friesen, EMFACS, for
what emotions look like.
"""

from __future__ import annotations

import contextlib
import math
import re
import struct
from collections.abc import Iterator, Mapping

with contextlib.suppress(ImportError):  # see Protocol.check
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
    from pythonosc.osc_message import OscMessage
    from pythonosc.osc_message import ParseError as MessageError
    from pythonosc.osc_message_builder import OscMessageBuilder

from ..recordings.names import ARKIT
from .frame import LiveFrame, put_angle, put_shape, shape_named

PORT = 39539
VALUE, APPLY, BONE = "/VMC/Ext/Blend/Val", "/VMC/Ext/Blend/Apply", "/VMC/Ext/Bone/Pos"
DEEPEST = 4  # bundles in one another
MOST_IN_PACKET = 24  # shapes, with which a packet stays below the 1500 bytes of a network
BONES = ("Neck", "Head", "LeftEye", "RightEye")
_BUNDLE = b"#bundle\0"
_HEAD = len(_BUNDLE) + 8  # and a time, which nobody waits for
# The messages that we read, as their bytes begin: of others the library might complain in the log.
_KNOWN = re.compile(
    rb"/VMC/Ext/(Blend/Val\0\0,s[fdi]\0|Blend/Apply\0{4}(,\0{3})?\Z|Bone/Pos\0{3},sf{7}\0{3})"
)
_BOTH = ("Left", "Right")

Quaternion = tuple[float, float, float, float]  # x, y, z, w


def _sided(**shares: float) -> dict[str, float]:
    """Shares of shapes, each for the left and the right one."""
    return {f"{name}{side}": share for name, share in shares.items() for side in _BOTH}


_HAPPY = _sided(mouthSmile=1.0, cheekSquint=0.7)
_SAD = {"browInnerUp": 1.0, **_sided(browDown=0.4, mouthFrown=1.0)}
_RELAXED = _sided(mouthSmile=0.4)
_LEFT = {"eyeLookOutLeft": 1.0, "eyeLookInRight": 1.0}
_RIGHT = {"eyeLookInLeft": 1.0, "eyeLookOutRight": 1.0}
PRESETS: dict[str, dict[str, float]] = {
    "a": {"viseme_aa": 1.0}, "i": {"viseme_ih": 1.0}, "u": {"viseme_ou": 1.0},
    "e": {"viseme_E": 1.0}, "o": {"viseme_oh": 1.0},
    "aa": {"viseme_aa": 1.0}, "ih": {"viseme_ih": 1.0}, "ou": {"viseme_ou": 1.0},
    "ee": {"viseme_E": 1.0}, "oh": {"viseme_oh": 1.0},
    "joy": _HAPPY, "happy": _HAPPY, "sorrow": _SAD, "sad": _SAD, "fun": _RELAXED,
    "relaxed": _RELAXED,
    "angry": _sided(browDown=1.0, eyeWide=0.3, eyeSquint=0.4, mouthPress=0.6),
    "surprised": {"browInnerUp": 1.0, "jawOpen": 0.4, **_sided(browOuterUp=1.0, eyeWide=1.0)},
    "blink": _sided(eyeBlink=1.0),
    "blink_l": {"eyeBlinkLeft": 1.0}, "blink_r": {"eyeBlinkRight": 1.0},
    "lookup": _sided(eyeLookUp=1.0), "lookdown": _sided(eyeLookDown=1.0),
    "lookleft": _LEFT, "lookright": _RIGHT,
}  # fmt: skip
"""What presets of VRM avatars mean, by their names in small letters: shares of channels."""


def parse(packet: bytes) -> LiveFrame | None:
    """What a packet adds to a frame, None if it is none; see the head of this file."""
    channels: dict[str, float] = {}
    bones: dict[str, Quaternion] = {}
    has_values = is_applied = False
    try:
        for message in _messages(packet, DEEPEST):
            if not _KNOWN.match(message):
                continue
            parsed = OscMessage(message)
            if parsed.address == APPLY:
                is_applied = True
            elif parsed.address == VALUE:
                has_values = True
                _put_value(channels, *parsed.params)
            elif parsed.params[0] in BONES:
                name, _, _, _, *turn = parsed.params
                bones[name] = (turn[0], turn[1], turn[2], turn[3])
    except (MessageError, ValueError, struct.error):  # Unicode errors among them
        return None
    _put_bones(channels, bones)
    if not (has_values or is_applied or bones):
        return None
    return LiveFrame(channels, is_complete=is_applied or not has_values)


def _messages(packet: bytes, depth: int) -> Iterator[bytes]:
    """The messages of a packet, each as bytes; ValueError for a bundle that is torn."""
    if not packet.startswith(_BUNDLE):
        yield packet
        return
    at = _HEAD
    while at < len(packet):
        (size,) = struct.unpack_from(">i", packet, at)
        at += 4
        if size < 0 or at + size > len(packet) or depth == 0:
            raise ValueError
        yield from _messages(packet[at : at + size], depth - 1)
        at += size


def _put_value(channels: dict[str, float], name: str, value: float) -> None:
    """A shape, or what a preset is made of, unless the channel is stronger already."""
    shape, written = shape_named(name), name.lower()
    if shape is not None:
        shares: Mapping[str, float] = {shape: 1.0}
    else:
        shares = PRESETS.get(written) or PRESETS.get(_version_0(written), {})
    for channel, share in shares.items():
        if value * share >= channels.get(channel, -math.inf):
            put_shape(channels, channel, value * share)


def _version_0(name: str) -> str:
    """Presets that VRM 1.0 spells in another way: blinkLeft is Blink_L."""
    return {"blinkleft": "blink_l", "blinkright": "blink_r"}.get(name, name)


def _put_bones(channels: dict[str, float], bones: Mapping[str, Quaternion]) -> None:
    if "Head" in bones:
        turn = bones["Head"]
        if "Neck" in bones:
            turn = _product(bones["Neck"], turn)
        for name, angle in zip(("yaw", "pitch", "roll"), _angles(turn), strict=True):
            put_angle(channels, f"head_{name}", angle)
    for side in _BOTH:
        if f"{side}Eye" in bones:
            yaw, pitch, _ = _angles(bones[f"{side}Eye"])
            put_angle(channels, f"eye_yaw_{side.lower()}", yaw)
            put_angle(channels, f"eye_pitch_{side.lower()}", pitch)


def _product(first: Quaternion, second: Quaternion) -> Quaternion:
    """The rotation `second`, and after it `first`."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _angles(turn: Quaternion) -> tuple[float, float, float]:
    """Yaw, pitch and roll [degrees] as names.py counts them; NaN for what turns nothing."""
    length = math.hypot(*turn)
    if not 1e-6 < length < 1e6:
        return math.nan, math.nan, math.nan
    x, y, z, w = (each / length for each in turn)
    ahead = 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)
    yaw = -math.atan2(ahead[0], ahead[2])
    pitch = math.asin(min(max(ahead[1], -1.0), 1.0))
    roll = math.atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z))
    return math.degrees(yaw), math.degrees(pitch), math.degrees(roll)


def packets(channels: Mapping[str, float], *, subject: str, frame: int) -> list[bytes]:
    """What an app would send of these channels, in several packets; of nobody by name."""
    messages: list[tuple[str, tuple[str | float, ...]]] = [
        (VALUE, (name[0].upper() + name[1:], channels[name])) for name in ARKIT if name in channels
    ]
    for bone, prefix, suffix in (
        ("Head", "head_", ""),
        ("LeftEye", "eye_", "_left"),
        ("RightEye", "eye_", "_right"),
    ):
        names = [f"{prefix}{angle}{suffix}" for angle in ("yaw", "pitch", "roll")]
        if any(name in channels for name in names):
            turn = _quaternion(*(channels.get(name, 0.0) for name in names))
            messages.append((BONE, (bone, 0.0, 0.0, 0.0, *turn)))
    vowels = {next(iter(shares)): name for name, shares in PRESETS.items() if len(name) == 1}
    messages += [
        (VALUE, (vowels[name].upper(), value)) for name, value in channels.items() if name in vowels
    ]
    messages.append((APPLY, ()))
    return [
        _bundle(messages[at : at + MOST_IN_PACKET])
        for at in range(0, len(messages), MOST_IN_PACKET)
    ]


def _quaternion(yaw: float, pitch: float, roll: float) -> Quaternion:
    """The rotation that has these angles [degrees], see `_angles`."""
    half_y, half_x, half_z = (0.5 * math.radians(each) for each in (-yaw, -pitch, roll))
    about_y = (0.0, math.sin(half_y), 0.0, math.cos(half_y))
    about_x = (math.sin(half_x), 0.0, 0.0, math.cos(half_x))
    about_z = (0.0, 0.0, math.sin(half_z), math.cos(half_z))
    return _product(about_y, _product(about_x, about_z))


def _bundle(messages: list[tuple[str, tuple[str | float, ...]]]) -> bytes:
    bundle = OscBundleBuilder(IMMEDIATELY)
    for address, values in messages:
        builder = OscMessageBuilder(address)
        for value in values:
            builder.add_arg(value)
        bundle.add_content(builder.build())
    return bytes(bundle.build().dgram)
