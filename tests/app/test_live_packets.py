"""Packets of live faces: their meaning, and safety against any data from a network."""

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx

from risorius.app.live.livelink import packet_of
from risorius.app.live.livelink import parse as parse_live_link
from risorius.app.live.protocols import PROTOCOLS
from risorius.app.live.vmc import parse as parse_vmc
from risorius.app.recordings.calibration import ANGLE_NAMES
from risorius.app.recordings.names import (
    ARKIT_SHAPES,
    EYE_ANGLES,
    HEAD_ANGLES,
    LARGEST_VALUE,
    VISEME_NAMES,
)

from .live_packets import LIVE_LINK, SHAPES, live_link, osc, vmc

VALUE_ADDRESS = "/VMC/Ext/Blend/Val"
APPLY_ADDRESS = "/VMC/Ext/Blend/Apply"
BONE_ADDRESS = "/VMC/Ext/Bone/Pos"
PROTOCOL_NAMES = tuple(PROTOCOLS)
GOOD_PACKETS = {
    "livelink": live_link({name: 0.01 * index for index, name in enumerate(LIVE_LINK)}),
    "vmc": vmc({name: 0.5 for name in SHAPES[:6]}),
}


def channels_of(frame):
    """The channels of a valid frame."""
    return dict(frame.channels)


# Live Link Face


def test_a_live_link_packet_has_a_name_and_every_shape_in_its_place():
    """Each of the 52 shapes alone has its value, with left and right of jaw and mouth correct."""
    for name, shape in zip(LIVE_LINK, SHAPES, strict=False):
        frame = parse_live_link(live_link({name: 0.75}, subject="Ada"))
        channels = channels_of(frame)
        assert frame.subject == "Ada"
        assert frame.has_face
        assert {each for each in ARKIT_SHAPES if channels[each]} == {shape}
        assert channels[shape] == 0.75


def test_live_link_angles_are_radians_to_the_right_and_down():
    """Radians to the right and down become degrees to the subject's left and up.

    The eyeballs' axes point outward when eyes look ahead.
    """
    angles = {"HeadYaw": 0.5, "HeadPitch": -0.25, "LeftEyePitch": 0.61, "RightEyeYaw": -0.62}
    channels = channels_of(parse_live_link(live_link(angles)))
    assert channels["head_yaw"] == approx(-math.degrees(0.5))
    assert channels["head_pitch"] == approx(math.degrees(0.25))
    assert channels["eye_pitch_left"] == approx(-math.degrees(0.61))
    # The right eye looks fully inward, to the subject's left: 35 degrees or more.
    assert channels["eye_yaw_right"] == approx(math.degrees(0.62), abs=5.0)
    ahead = {"LeftEyeYaw": -0.07, "RightEyeYaw": 0.07}
    channels = channels_of(parse_live_link(live_link(ahead)))
    assert abs(channels["eye_yaw_left"]) < 0.5
    assert abs(channels["eye_yaw_right"]) < 0.5


def test_without_a_face_live_link_sends_no_values():
    """A packet without a face has a count of 0 or no count, or ends after it.

    No values are read.
    """
    packet = live_link(None)
    for cut in (packet, packet[:-1] + b"\x3d", packet[:-1]):
        frame = parse_live_link(cut)
        assert not frame.has_face
        assert not frame.channels


def test_nonsense_among_values_is_left_out():
    """NaN, shapes far outside 0 to 1, and angles over half a turn are left out; 1.2 is noise."""
    odd = {"JawOpen": -9.8e5, "MouthPucker": 1.2, "CheekPuff": math.nan, "TongueOut": math.inf}
    odd |= {"HeadYaw": 9.8e5, "HeadPitch": math.nan}
    channels = channels_of(parse_live_link(live_link(odd)))
    assert channels["mouthPucker"] == approx(1.2)
    assert not {"jawOpen", "cheekPuff", "tongueOut", "head_yaw", "head_pitch"} & channels.keys()


def test_other_versions_and_every_torn_packet_are_none():
    """A packet of another version, or cut at any byte, is refused if values are required."""
    assert parse_live_link(live_link({}, version=5)) is None
    packet = GOOD_PACKETS["livelink"]
    values = len(packet) - 4 * 61
    for end in set(range(len(packet))) - {values, values - 1}:
        assert parse_live_link(packet[:end]) is None, end
    assert parse_live_link(packet + b"\0") is None


def test_an_unprintable_name_is_shortened():
    """Control characters and very long names are not shown in the window."""
    frame = parse_live_link(live_link({}, subject="A\x1b[2J\n" + 300 * "x"))
    assert frame.subject.isprintable()
    assert len(frame.subject) <= 40


# VMC


@pytest.mark.parametrize(
    "spelled", [str, str.upper, str.lower, lambda name: name[0].upper() + name[1:]]
)
def test_vmc_shapes_come_by_name_however_they_are_spelled(spelled):
    """All 52 shapes are read in capital and small letters."""
    assert callable(spelled)
    sent = {spelled(name): 0.01 * index for index, name in enumerate(SHAPES)}
    frame = parse_vmc(vmc(sent))
    assert frame.is_complete
    assert channels_of(frame) == approx({n: 0.01 * i for i, n in enumerate(SHAPES)})


@pytest.mark.parametrize(
    ("axis", "angle", "sign"),
    [((0, 1, 0), "head_yaw", -1.0), ((1, 0, 0), "head_pitch", -1.0), ((0, 0, 1), "head_roll", 1.0)],
)
def test_vmc_bones_turn_in_unitys_axes(axis, angle, sign):
    """Unity's axes are left-handed: about y to the right, x down, z to the left shoulder."""
    half = math.radians(10.0)
    turn = [math.sin(half) * each for each in axis]
    frame = parse_vmc(osc((BONE_ADDRESS, "Head", 0.0, 0.0, 0.0, *map(float, turn), math.cos(half))))
    channels = channels_of(frame)
    assert frame is not None and frame.is_complete  # without shapes no Apply is needed
    assert channels[angle] == approx(sign * 20.0, abs=1e-4)
    assert sum(abs(value) for value in channels.values()) == approx(20.0, abs=1e-3)


def test_vmc_head_turns_on_its_neck_and_eyes_turn_apart():
    """Two bones of 10 degrees turn the head by 20; each eye has its own bone.

    Bones without rotation are ignored.
    """
    tenth = (0.0, math.sin(math.radians(5.0)), 0.0, math.cos(math.radians(5.0)))
    none = (0.0, 0.0, 0.0, 0.0)
    place = (0.0, 1.5, 0.0)
    packet = osc(
        (BONE_ADDRESS, "Neck", *place, *tenth),
        (BONE_ADDRESS, "Head", *place, *tenth),
        (BONE_ADDRESS, "LeftEye", *place, *tenth),
        (BONE_ADDRESS, "RightEye", *place, *none),
        (BONE_ADDRESS, "Hips", *place, *tenth),
    )
    channels = channels_of(parse_vmc(packet))
    assert channels["head_yaw"] == approx(-20.0, abs=1e-3)
    assert channels["eye_yaw_left"] == approx(-10.0, abs=1e-3)
    assert "eye_yaw_right" not in channels


@pytest.mark.parametrize("size", [-4, -8, -(2**31), 2**31 - 1, 5])
def test_a_bundle_with_a_wrong_length_is_none(size):
    """A bundle with a negative length is refused, because reading it could loop for ever."""
    inner = osc((APPLY_ADDRESS,))[16:]
    assert parse_vmc(b"#bundle\0" + struct.pack(">Qi", 1, size) + inner) is None


def test_bundles_in_bundles_end_somewhere():
    """Three nested bundles are read, a thousand are refused."""
    packet = vmc({"JawOpen": 0.5})
    for _ in range(3):
        packet = b"#bundle\0" + struct.pack(">Qi", 1, len(packet)) + packet
    assert channels_of(parse_vmc(packet)) == {"jawOpen": 0.5}
    for _ in range(1000):
        packet = b"#bundle\0" + struct.pack(">Qi", 1, len(packet)) + packet
    assert parse_vmc(packet) is None


def test_messages_that_we_do_not_read_are_passed_over(caplog):
    """Other addresses, values and unknown types are ignored, without a line in the log."""
    packet = osc(
        ("/VMC/Ext/OK", 1),
        (VALUE_ADDRESS, 3, "JawOpen"),
        (VALUE_ADDRESS, "JawOpen", 0.5),
        (APPLY_ADDRESS,),
    )
    assert channels_of(parse_vmc(packet)) == {"jawOpen": 0.5}
    assert parse_vmc(b"/VMC/Ext/Blend/Val\0\0,zz\0") is None
    assert parse_vmc(osc(("/other", 1.0))) is None
    assert not caplog.records


# All protocols


def test_a_sent_packet_is_read_back(generator):
    """A packet of the project's sender has every shape and angle when it is read."""
    shapes = {name: float(generator.random()) for name in ARKIT_SHAPES}
    angles = {name: float(generator.uniform(-40.0, 40.0)) for name in (*HEAD_ANGLES, *EYE_ANGLES)}
    packet = packet_of({**shapes, **angles}, subject="x", frame=1)
    assert channels_of(parse_live_link(packet)) == approx({**shapes, **angles}, abs=0.006)


def is_sound(frame):
    """Whether there is no frame, or a plausible one; shapes a little outside 0 to 1 are noise."""
    if frame is None:
        return True
    known = {*ARKIT_SHAPES, *VISEME_NAMES, *ANGLE_NAMES}
    shapes = [value for name, value in frame.channels.items() if name not in ANGLE_NAMES]
    angles = [abs(value) for name, value in frame.channels.items() if name in ANGLE_NAMES]
    are_shapes_sound = all(abs(value) <= LARGEST_VALUE for value in shapes)
    are_angles_sound = all(value <= 180.0 for value in angles)
    return frame.channels.keys() <= known and are_shapes_sound and are_angles_sound


@pytest.mark.parametrize("kind", PROTOCOL_NAMES)
@given(data=st.data())
def test_hypothesis_finds_no_packet_that_does_harm(kind, data):
    """Good packets with a part replaced by random bytes or text raise no error."""
    good = GOOD_PACKETS[kind]
    begin = data.draw(st.integers(0, len(good)))
    end = data.draw(st.integers(begin, len(good)))
    text = st.text(alphabet="|=#-&,.0123456789enaif_LR/\0jawOpen").map(str.encode)
    middle = data.draw(st.one_of(st.binary(max_size=64), text))
    assert is_sound(PROTOCOLS[kind].parser()(good[:begin] + middle + good[end:]))


def test_a_shape_just_below_zero_is_noise():
    """A packet found by hypothesis: a shape of -2e-38, which is kept as other noise is."""
    good = GOOD_PACKETS["livelink"]
    packet = good[:227] + b"\0" * 11 + b"\x80" + good[239:]
    frame = PROTOCOLS["livelink"].parser()(packet)
    assert is_sound(frame)
    assert -1e-37 < frame.channels["browDownRight"] < 0.0
