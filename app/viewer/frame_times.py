"""How long the parts of a frame take, for the window and for `risorius bench`."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager

PHASES = ("simulation", "refinement", "upload", "draw")
KEPT_FRAMES = 60
SMOOTHING = 0.9  # of the frame rate, from frame to frame


class FrameTimes:
    """Milliseconds by phase of the paper's Figure 1 and by frame, and the rate of frames."""

    def __init__(self) -> None:
        self.milliseconds = {name: deque([0.0] * KEPT_FRAMES, KEPT_FRAMES) for name in PHASES}
        self.frames_per_second = 0.0

    @contextmanager
    def timed(self, phase: str) -> Iterator[None]:
        """Add the time that the block takes to the present frame's."""
        start = time.perf_counter()
        yield
        self.milliseconds[phase][-1] += 1e3 * (time.perf_counter() - start)

    def next_frame(self) -> None:
        """Begin with the next frame."""
        for column in self.milliseconds.values():
            column.append(0.0)

    def note_frame(self, elapsed: float) -> None:
        """A frame has begun `elapsed` seconds after the one before it; 0 where nothing moves."""
        # The mean of times, not of rates: a few quick frames must not outweigh the slow ones.
        mean = 1.0 / self.frames_per_second if self.frames_per_second else elapsed
        smooth = SMOOTHING * mean + (1.0 - SMOOTHING) * elapsed
        self.frames_per_second = 1.0 / smooth if elapsed > 0.0 else 0.0
