"""A live face: the conversion of packets to controls, and the weight of these controls.

    packets -> channels -> calibration -> mapping -> controls, with a presence of 0 to 1

Only the newest frame is used. While frames arrive, the presence grows to 1. When they stop, or when
the sender sees no face, the presence falls to 0, and the simulated face returns smoothly to its
other values. Other motion, such as idle life, has the weight 1 - presence.
"""

from __future__ import annotations

import enum
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..recordings.calibration import Calibration, gains_of, neutral_now
from ..recordings.mapping import controls_of
from ..recordings.names import ARKIT_SHAPES, EYE_ANGLES, HEAD_ANGLES, VISEME_NAMES
from .frame import LiveFrame
from .protocols import Listening
from .receiver import Receiver

LOST_AFTER = 0.4  # [s] without a frame, so a network may lose ten frames at 30 a second
EASING_IN = 0.25  # [s]
EASING_OUT = 0.6
CALIBRATION_TIME = 0.5  # [s] of a neutral face
# Channels that a sender may use.
LIVE_CHANNELS = (*ARKIT_SHAPES, *HEAD_ANGLES, *EYE_ANGLES, *VISEME_NAMES)


class SenderState(enum.Enum):
    """The state of the sender."""

    WAITING = "waiting"  # no frame has come yet
    RECEIVING = "receiving"
    NO_FACE = "no face"  # the sender sees nobody
    LOST = "lost"  # frames came, and have stopped


class LiveFace(Receiver):
    """A receiver that converts frames to controls.

    calibration: calibration of the channels; a caller may replace it at any time.
    channels: the newest value of each channel, before calibration.
    subject: the name of the person, or "".
    presence: weight of the live face against other motion, 0 to 1.
    """

    def __init__(
        self,
        listening: Listening,
        *,
        wake: Callable[[], None] = lambda: None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Start to listen; raises UserError if this fails. wake: see `Receiver`."""
        listening.protocol.check()
        gains, default = gains_of(listening.gains, LIVE_CHANNELS)
        super().__init__(listening, wake, clock)
        self.calibration = Calibration({}, gains, default, listening.mirror)
        self.channels: dict[str, float] = {}
        self.subject = ""
        self.has_news = False  # whether the last `advance` took a frame
        self._pending: dict[str, float] = {}
        self._share = 0.0
        self._has_face = True
        self._last: float | None = None  # time of the newest frame
        most_rated = 1000  # frames
        self._times: deque[float] = deque(maxlen=most_rated)
        self._neutral: list[dict[str, float]] = []
        self._neutral_until: float | None = None

    # State

    @property
    def silence(self) -> float:
        """Time since the newest frame [s]; infinite before the first."""
        return float("inf") if self._last is None else max(self._clock() - self._last, 0.0)

    @property
    def rate(self) -> float:
        """Frames in the last second."""
        now = self._clock()
        rated_time = 1.0  # [s] over which frames are counted
        return sum(1 for each in self._times if now - each < rated_time) / rated_time

    @property
    def state(self) -> SenderState:
        """The state of the sender."""
        if self._last is None:
            return SenderState.WAITING
        if self.silence > LOST_AFTER:
            return SenderState.LOST
        return SenderState.RECEIVING if self._has_face else SenderState.NO_FACE

    @property
    def presence(self) -> float:
        """Weight of the live face, 0 to 1, which changes smoothly in both directions."""
        return self._share * self._share * (3.0 - 2.0 * self._share)

    @property
    def is_easing(self) -> bool:
        """Whether the presence is about to change."""
        return self._share != (1.0 if self.state is SenderState.RECEIVING else 0.0)

    @property
    def is_calibrating(self) -> bool:
        """Whether the neutral face is being learned."""
        return self._neutral_until is not None

    # Commands

    def advance(self, seconds: float) -> None:
        """Process the frames that have arrived; `seconds` have passed since the last call."""
        self.has_news = False
        for at, frame in self.new_frames():
            self._process(frame, at)
        if self.state is SenderState.RECEIVING:
            self._share = min(self._share + seconds / EASING_IN, 1.0)
        else:
            self._share = max(self._share - seconds / EASING_OUT, 0.0)
        if self._neutral_until is not None and self._clock() >= self._neutral_until:
            self._end_calibration()

    def _process(self, frame: LiveFrame, at: float) -> None:
        self._pending.update(frame.channels)
        if not frame.is_complete:
            return
        self.channels.update(self._pending)
        self._pending.clear()
        self.subject = frame.subject or self.subject
        self._has_face = frame.has_face
        self._last = at
        self.has_news = True
        self._times.append(at)
        if self.is_calibrating and frame.has_face:
            self._neutral.append(dict(self.channels))

    def controls(self) -> dict[str, float]:
        """Return values of controls from the live face, not yet cut off at their limits."""
        return controls_of(self.calibration.apply(self.channels))

    def calibrate(self) -> None:
        """Take the face of the next half second as neutral."""
        self._neutral = []
        self._neutral_until = self._clock() + CALIBRATION_TIME

    def _end_calibration(self) -> None:
        """Take the median of each channel as neutral; a blink does not change a median."""
        if self._neutral:
            median = {}
            for name in self._neutral[-1]:
                values = [each[name] for each in self._neutral if name in each]
                median[name] = float(np.median(values))
            self.calibration = replace(self.calibration, neutral=neutral_now(median))
        self._neutral = []
        self._neutral_until = None
