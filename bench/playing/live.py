"""What `risorius bench live` prints: milliseconds from a packet to the skin that has been stepped.

Another process sends a moving face sixty times a second, as phones do, to this one over loopback.
Each frame carries its number in the turn of the head, and the sender says when it sent which. What
is driven here are the parts of the window without its pictures; with `window` also the window
itself, where a frame begins with a packet unless the one before it is still being drawn.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from risorius.app.live import LOOPBACK, PROTOCOLS, Listening, LiveFace
from risorius.app.performances import script_for
from risorius.app.scenes import build_scene
from risorius.app.viewer import Viewer
from risorius.app.viewer.frame_times import FrameTimes
from risorius.app.viewer.physics import STEP, Life, Physics
from risorius.app.viewer.session import Session
from risorius.app.viewer.settings import Display

from ..report import Target, at_most, processor, table
from .live_sender import DEGREES, RATE, SETTLING, sending

PROMISED = 8.0  # [ms] median on a quiet machine
ROUNDS = 3  # of all protocols in turn
SIZE = (1280, 720)


@dataclass
class _Case:
    """A protocol, and milliseconds of each stage for every frame."""

    kind: str
    name: str
    stages: list[tuple[float, ...]] = field(default_factory=list)  # way, read, map, step
    skipped: int = 0  # as a newer one was there already


class _NotingPhysics(Physics):
    """Notes when each frame of a live face was in the skin."""

    def __init__(self, session: Session, times: FrameTimes, face: LiveFace) -> None:
        super().__init__(session, times)
        self._face = face
        self.done: dict[int, tuple[float, ...]] = {}

    def advance(
        self,
        seconds: float,
        *,
        is_skin_dragged: bool,
        is_urgent: bool = False,
        life: Life | None = None,
    ) -> None:
        """Step, and note what that was of."""
        super().advance(seconds, is_skin_dragged=is_skin_dragged, is_urgent=is_urgent, life=life)
        if self.has_stepped:
            self.done.setdefault(_number(self._face), (time.perf_counter(),))


class Chain:
    """The way of a packet through the parts of the window, without the window."""

    def __init__(self, kind: str, session: Session) -> None:
        self._woken = threading.Event()
        self.face = LiveFace(Listening(kind, port=0), wake=self._woken.set)
        self._session = session

    def turn(self) -> tuple[int, tuple[float, ...]] | None:
        """Wait for a frame and follow it: its number, and when it came and each stage ended.

        None where none came.
        """
        self._woken.wait(STEP)
        self._woken.clear()
        woken = time.perf_counter()
        self.face.advance(STEP)
        self._session.live.take(self.face.controls(), self.face.presence)
        mapped = time.perf_counter()
        self._session.advance(STEP)
        times = (self.face.came_at or 0.0, woken, mapped, time.perf_counter())
        return (_number(self.face), times) if self.face.has_news else None


def report(seconds: float, *, with_window: bool) -> tuple[str, Target]:
    """Time each protocol for so many seconds; the text to print, and what is promised."""
    cases = [_Case(kind, protocol.title) for kind, protocol in PROTOCOLS.items()]
    session = Session(build_scene("face"), script_for(None, "face"))
    for turn in range(ROUNDS):
        for case in cases if turn % 2 == 0 else reversed(cases):
            _time_chain(case, session, seconds / ROUNDS)
    lines = [
        f"{os.cpu_count()} cores of {processor()}; {ROUNDS} interleaved rounds, "
        f"{RATE:.0f} frames a second over loopback.",
        "",
        *table(
            "protocol:<18|frames:6d|skipped:7d|:>7|way:6.2f|read:6.2f|map:6.2f|step:6.2f|all:7.2f",
            (row for case in cases for row in _rows(case)),
            empty="",
        ),
        "",
        "Times in ms: of a frame's last packet to the socket's thread, reading it there and",
        "waking, calibration and mapping, pose and step of the simulation; and all of it.",
    ]
    medians = [_total(case) for case in cases]
    if with_window:
        lines += ["", *_window_lines(seconds)]
    return "\n".join(lines), at_most("slowest median", max(medians), PROMISED, " ms")


def _time_chain(case: _Case, session: Session, seconds: float) -> None:
    chain = Chain(case.kind, session)
    done: dict[int, tuple[float, ...]] = {}
    try:
        with sending(case.kind, chain.face.port, seconds) as sent:
            while not sent.is_over:
                followed = chain.turn()
                if followed is not None:
                    done[followed[0]] = followed[1]
    finally:
        chain.face.close()
    _collect(case, sent.times, done)


def _window_lines(seconds: float) -> list[str]:
    """The same in the window, which also draws."""
    cases = [_Case(kind, protocol.title) for kind, protocol in PROTOCOLS.items()]
    with Viewer(script_for(None, "face"), SIZE, Display()) as viewer:
        frames: list[float] = []
        for case in cases:
            frames += _time_window(case, viewer, seconds / ROUNDS)
        name = viewer.surface.gl.info["GL_RENDERER"]
    return [
        f"In the window at {SIZE[0]}x{SIZE[1]} on {name}, {1.0 / np.median(frames):.0f} frames a "
        "second:",
        *table(
            "protocol:<18|frames:6d|median:7.2f|95 %:7.2f",
            ([case.name, len(case.stages), _total(case), _total(case, 95.0)] for case in cases),
        ),
        "A packet that comes while a picture is drawn waits for its end.",
    ]


def _time_window(case: _Case, viewer: Viewer, seconds: float) -> list[float]:
    """Let the window follow one protocol; how long its frames took [s]."""
    viewer.live.start(Listening(case.kind, LOOPBACK, port=0))
    face = viewer.live.face
    assert face is not None
    viewer.physics = noting = _NotingPhysics(viewer.session, viewer.times, face)
    taken = []
    with sending(case.kind, face.port, seconds) as sent:
        while not sent.is_over:
            begin = time.perf_counter()
            viewer.frame()
            viewer.pause()
            taken.append(time.perf_counter() - begin)
    viewer.live.stop()
    _collect(case, sent.times, noting.done)
    return taken


def _collect(case: _Case, sent: dict[int, float], done: dict[int, tuple[float, ...]]) -> None:
    """What each frame took that was sent after settling."""
    begin = min(sent.values()) + SETTLING
    counted = {number: at for number, at in sent.items() if at >= begin}
    case.skipped += len(counted.keys() - done.keys())
    for number, at in counted.items():
        if number in done:
            case.stages.append(tuple(1e3 * np.diff((at, *done[number]))))


def _rows(case: _Case) -> Iterator[list[object]]:
    """Two rows of a case: medians, and what 95 of 100 frames stay below."""
    counts: list[object] = [case.name, len(case.stages), case.skipped]
    for title, percentile in (("median", 50.0), ("95 %", 95.0)):
        stages = np.percentile(np.array(case.stages), percentile, axis=0)
        yield [*counts, title, *stages, _total(case, percentile)]
        counts = [None, None, None]


def _total(case: _Case, percentile: float = 50.0) -> float:
    return float(np.percentile(np.sum(case.stages, axis=1), percentile))


def _number(face: LiveFace) -> int:
    """The number that the sender gave to the newest frame."""
    return round(face.channels.get("head_yaw", 0.0) / DEGREES)
