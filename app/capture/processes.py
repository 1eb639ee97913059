"""Processes that draw a film together; each draws a subset of the frames.

Software OpenGL uses only one core well. The simulation is cheap and gives the same bytes in every
process, so each process plays the whole script and draws every n-th frame. The pictures arrive
through pipes, in order, while the processes draw the next frames.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from functools import partial

from risorius import render

from ..compiling_note import announce_compiling
from ..errors import UserError
from ..motion import counted_frames, scene_of
from ..script import Script
from ..stopping import cleaned_up_if_stopped
from ..workers import DiedError, Send, Worker, share_of_cores
from .drawing import Capture, CaptureOptions, DrawnFrame


@dataclass(frozen=True)
class FrameSubset:
    """The frames that one process draws: first, first + every, ..., up to the time `until` [s]."""

    script: Script
    options: CaptureOptions
    until: float
    first: int
    every: int


def process_count(options: CaptureOptions, frame_count: int) -> int:
    """Return the number of processes for a film: 1 if a GPU draws, or if there is one core."""
    width, height = options.size
    samples = width * height * max(options.samples, 1) * frame_count
    least_samples = 1e8  # 27 frames of 1280 x 720, which justify a process's start of 3 s
    most_processes = 8  # one encoder is too slow for more
    count = min(share_of_cores(), most_processes, int(samples / least_samples))
    if count < 2:
        return 1
    with render.open_offscreen((1, 1), samples=0) as surface:
        return count if surface.is_software else 1


def drawing(
    script: Script, options: CaptureOptions, until: float, count: int, *, progress: bool
) -> Generator[tuple[float, Callable[[], DrawnFrame]]]:
    """Let `count` processes play a script; yield the time [s] of each frame, and a getter.

    The getter returns the frame, or raises the error of a process. The caller must call it for
    each frame of the span.
    """
    drawers: list[Worker] = []
    shown: list[DrawnFrame] = []

    def stop() -> None:
        """End all processes, which have nothing to clean up."""
        for drawer in drawers:
            drawer.process.kill()

    def next_frame(messages: Iterator[DrawnFrame | None]) -> DrawnFrame:
        """Return the next frame of a process; for None return the last frame again."""
        try:
            frame = next(messages)
        except DiedError as why:
            raise UserError(
                f"a process that draws the film ended ({why}); try again; if memory is "
                "short, choose a smaller --size"
            ) from None
        if frame is not None:
            shown[:] = [frame]
        return shown[0]

    rate = options.frames_per_second
    with cleaned_up_if_stopped(stop):
        try:
            for first in range(count):
                drawers.append(Worker(_draw, FrameSubset(script, options, until, first, count)))
            drawn = [drawer.messages() for drawer in drawers]
            for index in counted_frames(until, rate, progress=progress):
                yield index / rate, partial(next_frame, drawn[index % count])
        finally:
            stop()
            for drawer in drawers:
                drawer.close()


def _draw(subset: FrameSubset, send: Send) -> None:
    """Draw and send the frames of a subset; send None for a frame equal to the last one."""
    options = subset.options
    if subset.first == 0:
        announce_compiling()
    first = 0 if options.span is None else round(options.span[0] * options.frames_per_second)
    with Capture(scene_of(subset.script, options.head), options) as capture:
        playing = capture.play(subset.script, until=subset.until, progress=False)
        for index, _ in enumerate(playing):
            is_mine = index >= first and index % subset.every == subset.first
            is_still = index >= first and capture.is_still()
            if is_mine and not is_still:
                send(capture.draw_frame())
                continue
            capture.refine()
            if is_mine:
                send(None)
