"""Packets written after the descriptions of their formats, without the code under test."""

import struct
from collections.abc import Mapping

from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder

# The values of a Live Link Face packet, in order.
LIVE_LINK = (
    "EyeBlinkLeft EyeLookDownLeft EyeLookInLeft EyeLookOutLeft EyeLookUpLeft EyeSquintLeft "
    "EyeWideLeft EyeBlinkRight EyeLookDownRight EyeLookInRight EyeLookOutRight EyeLookUpRight "
    "EyeSquintRight EyeWideRight JawForward JawLeft JawRight JawOpen MouthClose MouthFunnel "
    "MouthPucker MouthLeft MouthRight MouthSmileLeft MouthSmileRight MouthFrownLeft "
    "MouthFrownRight MouthDimpleLeft MouthDimpleRight MouthStretchLeft MouthStretchRight "
    "MouthRollLower MouthRollUpper MouthShrugLower MouthShrugUpper MouthPressLeft MouthPressRight "
    "MouthLowerDownLeft MouthLowerDownRight MouthUpperUpLeft MouthUpperUpRight BrowDownLeft "
    "BrowDownRight BrowInnerUp BrowOuterUpLeft BrowOuterUpRight CheekPuff CheekSquintLeft "
    "CheekSquintRight NoseSneerLeft NoseSneerRight TongueOut HeadYaw HeadPitch HeadRoll "
    "LeftEyeYaw LeftEyePitch LeftEyeRoll RightEyeYaw RightEyePitch RightEyeRoll"
).split()
SHAPES = tuple(name[0].lower() + name[1:] for name in LIVE_LINK[:52])


def live_link(
    values: Mapping[str, float] | None, *, subject: str = "somebody", version: int = 6
) -> bytes:
    """A packet of Live Link Face; with None as values, the app sees no face."""
    device = b"A0B1C2D3-0000-1111-2222-333344445555"
    name = subject.encode()
    packet = struct.pack(">Bi", version, len(device)) + device
    packet += struct.pack(">i", len(name)) + name
    packet += struct.pack(">ifii", 1234, 0.5, 60, 1)
    if values is None:
        return packet + b"\0"
    numbers = [values.get(each, 0.0) for each in LIVE_LINK]
    return packet + struct.pack(">B61f", 61, *numbers)


def osc(*messages: tuple[object, ...]) -> bytes:
    """An OSC bundle of messages, each with an address and values."""
    bundle = OscBundleBuilder(IMMEDIATELY)
    for address, *values in messages:
        builder = OscMessageBuilder(str(address))
        for value in values:
            builder.add_arg(value)
        bundle.add_content(builder.build())
    return bytes(bundle.build().dgram)


def vmc(values: Mapping[str, float]) -> bytes:
    """A complete VMC frame in one packet."""
    shapes = [("/VMC/Ext/Blend/Val", name, value) for name, value in values.items()]
    return osc(*shapes, ("/VMC/Ext/Blend/Apply",))
