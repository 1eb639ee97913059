"""`risorius send`: packets leave in the recording's own time, with unchanged values."""

import socket
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.live.livelink import parse
from risorius.app.live.protocols import LOOPBACK_ADDRESS
from risorius.app.live.sender import Sender
from risorius.app.recordings.take import Take

from .command_line import succeeded

STEP = 1.0 / 60.0


def take_of(**channels):
    """A take with these values, 60 per second."""
    count = len(next(iter(channels.values())))
    arrays = {name: np.array(values) for name, values in channels.items()}
    return Take("test", "test.csv", np.arange(count) * STEP, arrays)


@pytest.fixture
def heard() -> Iterator[socket.socket]:
    """A socket that receives packets."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as opened:
        opened.bind((LOOPBACK_ADDRESS, 0))
        opened.settimeout(10.0)
        yield opened


def test_a_take_comes_in_as_it_went_out(heard):
    """Every frame arrives, in order."""
    smile = [0.0, 0.25, 0.5, 0.75]
    turn = [0.0, 5.0, 10.0, -15.0]
    take = take_of(mouthSmileLeft=smile, head_yaw=turn)
    with Sender(LOOPBACK_ADDRESS, heard.getsockname()[1], "test") as sender:
        sender.play(take, sleep=lambda _: None)
    found = []
    while len(found) < 4:
        frame = parse(heard.recv(9000))
        assert frame.is_complete
        found.append((frame.channels["mouthSmileLeft"], frame.channels["head_yaw"]))
    assert [each[0] for each in found] == approx(smile, abs=1e-6)
    assert [each[1] for each in found] == approx(turn, abs=1e-3)


def test_a_recording_comes_along(monkeypatch, tmp_path, heard):
    """Without a file, an installed recording is sent, which speaks and blinks."""
    monkeypatch.chdir(tmp_path)
    sent = []
    monkeypatch.setattr(Sender, "play", lambda _, take, **__: sent.append(take))
    said = succeeded("send", "--port", heard.getsockname()[1])
    assert "speech.csv: Live Link Face, 6.10 s, " in said
    assert sent[0].channels["jawOpen"].max() > 0.2
    assert sent[0].channels["eyeBlinkLeft"].max() > 0.6
    assert Path(sent[0].source).stat().st_size < 60_000


class Stopped(Exception):  # noqa: N818, what ends the test is no error
    """Raised at the end of the test's time."""


def clock_until(end):
    """A clock, a sleep that advances the clock and ends the test, and the slept times."""
    now = [0.0]
    slept = []

    def sleep(seconds):
        """Advance the clock."""
        slept.append(seconds)
        now[0] += seconds
        if now[0] > end:
            raise Stopped

    return lambda: now[0], sleep, slept


def test_a_take_keeps_its_time_and_may_go_round(heard):
    """A frame is sent when it is due; in a loop, the first follows the last like any other."""
    clock, sleep, slept = clock_until(0.5)
    take = take_of(jawOpen=[0.0, 0.5, 1.0])
    with (
        Sender(LOOPBACK_ADDRESS, heard.getsockname()[1], "test") as sender,
        pytest.raises(Stopped),
    ):
        sender.play(take, is_looping=True, clock=clock, sleep=sleep)
    assert slept[0] == 0.0
    assert slept[1:] == approx([STEP] * (len(slept) - 1))
    assert len(slept) > 25


def test_a_take_without_anything_to_send_is_refused():
    """A take without known channels is refused in one line with the file."""
    with (
        Sender(LOOPBACK_ADDRESS, None, "test") as sender,
        pytest.raises(UserError, match=r"test\.csv: test has no values to send"),
    ):
        sender.play(take_of(viseme_PP=[1.0]))


def test_the_command_sends_a_file(tmp_path, heard):
    """The command prints the recording's name and the address."""
    file = tmp_path / "take.csv"
    file.write_text("time,jawOpen,AU38\n0.0,0.5,0.1\n0.05,0.25,0.2\n")
    port = heard.getsockname()[1]
    said = succeeded("send", file, "--port", port)
    assert f"to 127.0.0.1, port {port}; " in said
    frame = parse(heard.recv(9000))
    assert frame.subject == "take"
    assert frame.channels["jawOpen"] == 0.5
