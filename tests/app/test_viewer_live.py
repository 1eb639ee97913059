"""A live face in the real window, driven by `risorius send` and by real clicks."""

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

import pytest
from pytest import approx

from risorius.app.live.live_face import LiveFace, SenderState
from risorius.app.live.protocols import LOOPBACK_ADDRESS, Listening
from risorius.app.live.sender import Sender
from risorius.app.viewer import Viewer
from risorius.app.viewer.session import live_commands

from .driving import NEEDS_A_SCREEN, click, moved, until

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm", "silent")]


class FrameClock:
    """A clock that counts the window's frames, each as a twentieth of a second at most.

    A slow machine therefore loses no face and misses no event.
    """

    def __init__(self, frame):
        """frame: the window's function that draws a frame."""
        self._frame = frame
        self._now = 0.0
        self._last = time.perf_counter()

    def __call__(self):
        return self._now

    def frame(self):
        """Draw a frame and advance the clock."""
        last, self._last = self._last, time.perf_counter()
        self._now += min(self._last - last, 0.05)
        self._frame()


@pytest.fixture
def clock(viewer: Viewer, monkeypatch: pytest.MonkeyPatch) -> FrameClock:
    """The clock of the live face in the window."""
    made = FrameClock(viewer.frame)
    monkeypatch.setattr(viewer, "frame", made.frame)
    monkeypatch.setattr(live_commands, "LiveFace", partial(LiveFace, clock=made))
    return made


@pytest.fixture
def silent(viewer: Viewer, clock: FrameClock) -> Iterator[None]:
    """Listen to no sender before and after the test."""
    viewer.context.live.stop()
    viewer.context.live.wanted = Listening("livelink", port=0)
    yield
    viewer.context.live.stop()


def listen(viewer):
    """Listen on a free port."""
    viewer.context.live.start(Listening("livelink", port=0))
    face = viewer.context.live.face
    assert face is not None
    return face


@contextmanager
def sending(face, file):
    """Send a recording to the window from another process, in a loop."""
    words = ["send", file, "--loop", "--port", face.port]
    process = subprocess.Popen(
        [sys.executable, "-m", "risorius", *map(str, words)], stdout=subprocess.DEVNULL
    )
    try:
        yield
    finally:
        process.terminate()
        process.wait()


def hold(viewer, clock, seconds, **channels):
    """Send the same face in every frame, for at least this time and until it leads."""
    face = viewer.context.live.face
    end = clock() + seconds
    with Sender(LOOPBACK_ADDRESS, face.port, "Ada") as sender:

        def leads():
            """Whether the face leads and the time is over; otherwise send once more."""
            is_enough = clock() >= end and face.presence == 1.0
            if not is_enough:
                sender.send(channels)
            return is_enough

        assert until(viewer, leads)


def write_take(file, **channels):
    """Write a recording of two seconds in which the channels rise and stay."""
    lines = [",".join(("time", *channels))]
    for index in range(120):
        share = min(index / 30.0, 1.0)
        values = [f"{share * value:.4f}" for value in channels.values()]
        lines.append(",".join((f"{index / 60.0:.4f}", *values)))
    file.write_text("\n".join(lines) + "\n")
    return file


def test_a_recording_that_is_sent_moves_the_face(viewer, tmp_path):
    """A sent recording opens the mouth; when packets end it closes and the window is idle."""
    face = listen(viewer)
    assert until(viewer, lambda: "live state" in viewer.gui.places)
    with sending(face, write_take(tmp_path / "take.csv", jawOpen=0.9, browInnerUp=0.5)):
        assert until(viewer, lambda: moved(viewer) > 8.0)
        assert face.state is SenderState.RECEIVING
        assert not viewer.schedule.is_idle
        assert viewer.session.current["jawOpen"] > 0.1
        assert not face.unusable
    assert until(viewer, lambda: face.presence == 0.0)
    assert face.state is SenderState.LOST
    assert until(viewer, lambda: moved(viewer) < 0.3)
    assert until(viewer, lambda: viewer.schedule.is_idle)
    assert not viewer.session.work.unsaved


def test_buttons_listen_calibrate_mirror_and_stop(viewer, clock):
    """Buttons start, calibrate, mirror and stop; a calibrated neutral face moves nothing."""
    session = viewer.session
    click(viewer, "tab Live")
    click(viewer, "listen")
    face = viewer.context.live.face
    assert face is not None
    assert not viewer.context.live.is_receiving
    frown = {"browDownLeft": 0.3, "mouthFrownLeft": 0.2}
    hold(viewer, clock, 0.6, **frown)
    assert session.current["browDownLeft"] > 0.2
    assert {"live browDownLeft", "live mouthFrownLeft"} <= viewer.gui.places.keys()
    place = viewer.gui.places["calibrate"]
    assert place
    viewer.context.live.calibrate()
    hold(viewer, clock, 1.2, **frown)
    assert viewer.messages.text == "This face is neutral now"
    assert session.current["browDownLeft"] == approx(0.0, abs=1e-6)
    click(viewer, "mirror live")
    hold(viewer, clock, 0.5, **{**frown, "mouthSmileLeft": 0.6})
    assert session.current["mouthSmileRight"] == approx(0.6, abs=1e-6)
    click(viewer, "listen")
    assert viewer.context.live.face is None
    assert session.current == session.values


def test_a_packet_wakes_an_idle_window(viewer):
    """The window sleeps without packets, and a packet wakes it at once."""
    face = listen(viewer)
    viewer.messages.text = ""
    assert until(viewer, lambda: viewer.schedule.is_idle)
    with Sender(LOOPBACK_ADDRESS, face.port, "Ada") as sender:
        sender.send({"jawOpen": 0.8})
        viewer.schedule.pause()
        viewer.frame()
        assert face.silence < 60.0
        assert not viewer.schedule.is_idle
