"""A face that somebody sends: from packets to the controls of our face, and how far it overrides.

    packets -> channels -> calibration -> mapping -> controls, with a presence of 0 to 1

The newest frame counts. While frames come the presence grows to 1; when they stop, or when the
sender sees no face, it falls to 0, and our face eases to its values without them. Other motion,
such as idle life, gets the rest of the weight, 1 less the presence.
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
from ..recordings.names import ARKIT, EYE_ANGLES, HEAD_ANGLES, VISEMES
from .frame import LiveFrame
from .protocols import Listening
from .receiver import Receiver

LOST_AFTER = 0.4  # [s] without a frame; at 30 a second a network may swallow ten
EASING_IN = 0.25  # [s]
EASING_OUT = 0.6
CALIBRATING = 0.5  # [s] of a neutral face
CHANNELS = (*ARKIT, *HEAD_ANGLES, *EYE_ANGLES, *VISEMES)  # that may come


class State(enum.Enum):
    """The state of the sender."""

    WAITING = "waiting"  # nothing has come yet
    RECEIVING = "receiving"
    NO_FACE = "no face"  # the sender sees nobody
    LOST = "lost"  # frames came, and do no longer


class LiveFace(Receiver):
    """The received frames, as a face.

    calibration: of the channels; may be replaced at any time.
    channels: the newest value of each channel, before calibration.
    subject: the name of the person, "" if the sender has none.
    presence: how far it overrides our face, 0 to 1.
    """

    def __init__(
        self,
        listening: Listening,
        *,
        wake: Callable[[], None] = lambda: None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Listen from now on; raises UserError if that cannot be. wake: see `Receiver`."""
        listening.protocol.check()
        gains, default = gains_of(listening.gains, CHANNELS)
        super().__init__(listening, wake, clock)
        self.calibration = Calibration({}, gains, default, listening.mirror)
        self.channels: dict[str, float] = {}
        self.subject = ""
        self.has_news = False  # a frame was taken in by the last `advance`
        self._pending: dict[str, float] = {}
        self._share = 0.0
        self._has_face = True
        self._last: float | None = None  # when the newest frame came
        most_rated = 1000  # frames
        self._times: deque[float] = deque(maxlen=most_rated)
        self._neutral: list[dict[str, float]] = []
        self._neutral_until: float | None = None

    # Its state

    @property
    def silence(self) -> float:
        """How long ago the newest frame came [s]; infinite before the first."""
        return float("inf") if self._last is None else max(self._clock() - self._last, 0.0)

    @property
    def rate(self) -> float:
        """Frames in the last second."""
        now = self._clock()
        rated_time = 1.0  # [s] over which frames are counted
        return sum(1 for each in self._times if now - each < rated_time) / rated_time

    @property
    def state(self) -> State:
        """The state of the sender."""
        if self._last is None:
            return State.WAITING
        if self.silence > LOST_AFTER:
            return State.LOST
        return State.RECEIVING if self._has_face else State.NO_FACE

    @property
    def presence(self) -> float:
        """How far it overrides ours, 0 to 1: smoothly in both directions."""
        return self._share * self._share * (3.0 - 2.0 * self._share)

    @property
    def is_easing(self) -> bool:
        """Whether the presence is about to change."""
        return self._share != (1.0 if self.state is State.RECEIVING else 0.0)

    @property
    def is_calibrating(self) -> bool:
        """Whether the neutral face is being learned."""
        return self._neutral_until is not None

    # Its commands

    def advance(self, seconds: float) -> None:
        """Take in the frames that have come; `seconds` have passed since the last call."""
        self.has_news = False
        for at, frame in self.take():
            self._take_in(frame, at)
        if self.state is State.RECEIVING:
            self._share = min(self._share + seconds / EASING_IN, 1.0)
        else:
            self._share = max(self._share - seconds / EASING_OUT, 0.0)
        if self._neutral_until is not None and self._clock() >= self._neutral_until:
            self._end_calibration()

    def _take_in(self, frame: LiveFrame, at: float) -> None:
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
        """Our controls as the face has them, not yet cut off at their limits."""
        return controls_of(self.calibration.apply(self.channels))

    def calibrate(self) -> None:
        """Take the face of the next half second as neutral."""
        self._neutral, self._neutral_until = [], self._clock() + CALIBRATING

    def _end_calibration(self) -> None:
        """Take the median, which a blink does not move, of each channel."""
        if self._neutral:
            median = {
                name: float(np.median([each[name] for each in self._neutral if name in each]))
                for name in self._neutral[-1]
            }
            self.calibration = replace(self.calibration, neutral=neutral_now(median))
        self._neutral = []
        self._neutral_until = None
