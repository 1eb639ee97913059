"""A live face driven by a sender: sockets on loopback, calibration, rest without a sender."""

import socket
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import pytest
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.live.live_face import (
    CALIBRATION_TIME,
    EASING_IN,
    EASING_OUT,
    LOST_AFTER,
    LiveFace,
    SenderState,
)
from risorius.app.live.protocols import LOOPBACK_ADDRESS, PROTOCOLS, Listening
from risorius.app.live.receiver import Receiver

from .live_packets import live_link, osc, vmc

VALUE_ADDRESS = "/VMC/Ext/Blend/Val"
APPLY_ADDRESS = "/VMC/Ext/Blend/Apply"


class Clock:
    """A clock that advances only when it is set."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class Wire:
    """A live face, and a socket that sends to it."""

    def __init__(self, kind):
        self.clock = Clock()
        self.woken = 0
        self.face = LiveFace(Listening(kind, port=0), wake=self._wake, clock=self.clock)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def _wake(self):
        self.woken += 1

    def send(self, *packets):
        """Send packets, and wait until they have arrived."""
        wanted = self.face.received + len(packets)
        for packet in packets:
            self._socket.sendto(packet, (LOOPBACK_ADDRESS, self.face.port))
        assert until(lambda: self.face.received == wanted)

    def take(self, *packets, seconds=0.0):
        """Send packets, and let the face read them after this time."""
        self.send(*packets)
        self.pass_time(seconds)

    def pass_time(self, seconds):
        """Let time pass in one step."""
        self.clock.now += seconds
        self.face.advance(seconds)

    def close(self):
        """Close the face and the socket."""
        self.face.close()
        self._socket.close()


def until(condition, seconds=10.0):
    """Wait until a condition is true, up to a limit."""
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.001)
    return condition()


@pytest.fixture
def wire(request: pytest.FixtureRequest) -> Iterator[Wire]:
    """A live face with the protocol of the test, by default Live Link Face."""
    opened = Wire(getattr(request, "param", "livelink"))
    yield opened
    opened.close()


def test_a_frame_leads_the_controls(wire):
    """Shapes become controls, with slightly stronger blinks, and a line names the sender."""
    assert wire.face.state is SenderState.WAITING
    assert wire.face.presence == 0.0
    wire.take(live_link({"JawOpen": 0.5, "EyeBlinkLeft": 0.5, "HeadYaw": -0.3927}, subject="Ada"))
    controls = wire.face.controls()
    assert wire.face.state is SenderState.RECEIVING
    assert wire.face.subject == "Ada"
    assert wire.woken == 1
    assert wire.face.has_news
    assert wire.face.rate == 1.0
    assert controls["jawOpen"] == 0.5
    assert 0.5 < controls["eyeBlinkLeft"] < 0.65
    assert controls["head_yaw"] == approx(0.5, abs=1e-3)  # of 45 degrees
    wire.pass_time(0.01)
    assert not wire.face.has_news


def test_a_lost_face_eases_out_within_a_second_and_comes_back_smoothly(wire):
    """Without packets, the face's presence falls to 0 in small steps within a second.

    It rises again when packets resume.
    """
    frame = live_link({"JawOpen": 0.5})
    wire.take(frame)
    for _ in range(30):
        wire.take(frame, seconds=1.0 / 60.0)
    assert wire.face.presence == 1.0
    assert not wire.face.is_easing
    assert LOST_AFTER + EASING_OUT <= 1.0
    presences = []
    for _ in range(62):
        wire.pass_time(1.0 / 60.0)
        presences.append(wire.face.presence)
    assert wire.face.state is SenderState.LOST
    assert wire.face.silence > 1.0
    assert presences[0] == 1.0
    assert presences[-1] == 0.0
    assert not wire.face.is_easing
    steps = [before - after for before, after in pairwise(presences)]
    assert min(steps) >= 0.0
    assert max(steps) < 0.08
    assert wire.face.controls()["jawOpen"] == 0.5  # the value before fading
    wire.take(frame, seconds=1.0 / 60.0)
    assert 0.0 < wire.face.presence < 0.1
    wire.take(frame, seconds=EASING_IN)
    assert wire.face.presence == 1.0


def test_a_sender_without_a_face_releases_the_controls(wire):
    """Packets without values are not a lost signal, but the face returns to rest."""
    wire.take(live_link({"JawOpen": 0.5}))
    wire.take(live_link(None), seconds=0.1)
    assert wire.face.state is SenderState.NO_FACE
    assert wire.woken == 1
    for _ in range(60):
        wire.take(live_link(None), seconds=1.0 / 60.0)
    assert wire.face.presence == 0.0
    assert wire.face.state is SenderState.NO_FACE


def test_calibrating_takes_the_neutral_face_away(wire):
    """Calibration subtracts the median of half a second, which a blink does not change."""
    neutral = {"BrowDownLeft": 0.3, "HeadPitch": 0.2}
    wire.take(live_link(neutral))
    wire.face.calibrate()
    for number in range(20):
        blink = {"EyeBlinkLeft": 1.0} if number in (8, 9, 10) else {}
        assert wire.face.is_calibrating
        wire.take(live_link({**neutral, **blink}), seconds=CALIBRATION_TIME / 19.5)
    assert not wire.face.is_calibrating
    controls = wire.face.controls()
    assert controls["browDownLeft"] == 0.0
    assert controls["eyeBlinkLeft"] == 0.0
    assert controls["head_pitch"] == approx(0.0, abs=1e-6)
    wire.take(live_link({**neutral, "BrowDownLeft": 1.0, "EyeBlinkLeft": 1.0}))
    controls = wire.face.controls()
    assert controls["browDownLeft"] == 1.0
    assert controls["eyeBlinkLeft"] >= 1.0


def test_gains_and_mirror_may_be_given_from_the_start():
    """Gains and mirroring work as for recordings; wrong ones are refused before listening."""
    listening = Listening("livelink", port=0, gains=("jawOpen=2", "mouth*=0.5"), mirror=True)
    face = LiveFace(listening)
    try:
        face.channels.update({"jawOpen": 0.3, "mouthSmileLeft": 0.8})
        controls = face.controls()
        assert controls["jawOpen"] == approx(0.6)
        assert controls["mouthSmileRight"] == approx(0.4)
    finally:
        face.close()
    with pytest.raises(UserError):
        LiveFace(replace(listening, gains=("nobody=2",)))


@pytest.mark.parametrize("wire", ["vmc"], indirect=True)
def test_missing_values_stay(wire):
    """Values missing in a packet stay as they were, because a sender may send changes only."""
    wire.take(vmc({"jawOpen": 0.5, "cheekPuff": 0.3}))
    wire.take(vmc({"jawOpen": 0.2}))
    channels = wire.face.channels
    assert channels["jawOpen"] == approx(0.2)
    assert channels["cheekPuff"] == approx(0.3)


@pytest.mark.parametrize("wire", ["vmc"], indirect=True)
def test_parts_of_a_frame_count_together(wire):
    """No control moves, and the window does not wake, before the message Apply."""
    wire.take(osc((VALUE_ADDRESS, "jawOpen", 0.5), (VALUE_ADDRESS, "eyeBlinkLeft", 0.6)))
    assert wire.face.state is SenderState.WAITING
    assert not wire.face.channels
    assert not wire.woken
    wire.take(osc((VALUE_ADDRESS, "mouthPucker", 0.25)), osc((APPLY_ADDRESS,)))
    assert wire.woken == 1
    wanted = {"jawOpen": 0.5, "mouthPucker": 0.25, "eyeBlinkLeft": 0.6}
    assert wire.face.channels == approx(wanted)
    wire.take(osc((VALUE_ADDRESS, "eyeBlinkLeft", 0.1), (APPLY_ADDRESS,)))
    assert wire.face.channels["eyeBlinkLeft"] == approx(0.1)


@pytest.mark.parametrize(
    "address",
    ["192.0.2.1", "nobody.invalid", "x" * 300, "é" * 70 + ".de", "::1", "<broadcast>", ""],
)
def test_an_address_of_another_computer_is_refused(address):
    """Listening on another computer's address is refused.

    An empty address must not mean all addresses.
    """
    with pytest.raises(UserError, match=r"cannot listen|write a computer's name"):
        Receiver(Listening("livelink", address, 0)).close()


def test_only_the_address_given_is_listened_on():
    """By default the port is open on the loopback address only."""
    for kind in PROTOCOLS:
        assert Listening(kind).address == LOOPBACK_ADDRESS
    receiver = Receiver(Listening("livelink", port=0))
    try:
        assert receiver.address == LOOPBACK_ADDRESS
    finally:
        receiver.close()
