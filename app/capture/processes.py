"""Processes that draw a film together, each its share of the frames.

Software OpenGL keeps only one core busy all the time. The simulation is cheap and gives the same
bytes in every process, so each of them plays the whole script and draws every n-th frame. What they
draw comes through pipes, in order, while they go on with the next frames.
"""

from __future__ import annotations

import contextlib
import logging
import logging.handlers
import os
import pickle
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from queue import Queue

from risorius import render

from ..errors import UserError
from ..motion import counted_frames, scene_of
from ..script import Script
from ..stopping import cleaned_up_if_stopped
from ..workers.child import Child, DiedError, share_of_cores, streams
from .drawing import Capture, CaptureOptions, Frame

SAMPLES_EACH = 1e8  # 27 frames of 1280 x 720: fewer are not worth a start of three seconds
MOST = 8  # more of them than one encoder can follow
AHEAD = 32e6  # [bytes] of pictures that a process draws ahead of the film, or two pictures
COMPILER = "risorius.jit"  # the log that tells of code that is compiled
STILL = "still"  # handed over in place of a frame that is the one before it


@dataclass(frozen=True)
class Share:
    """What one process draws of the frames up to a time [s]: number `first`, and every n-th."""

    script: Script
    options: CaptureOptions
    until: float
    first: int
    every: int


def worthwhile(options: CaptureOptions, frame_count: int) -> int:
    """How many processes should draw so many frames: 1 where a GPU does, or a core is all."""
    width, height = options.size
    samples = width * height * max(options.samples, 1) * frame_count
    count = min(share_of_cores(), MOST, int(samples / SAMPLES_EACH))
    if count < 2:
        return 1
    with render.open_offscreen((1, 1), samples=0) as surface:
        return count if surface.is_software else 1


@contextlib.contextmanager
def drawing(
    script: Script, options: CaptureOptions, until: float, count: int, *, progress: bool
) -> Iterator[Iterator[tuple[float, Callable[[], Frame]]]]:
    """Let `count` processes play a script; yield each frame's time [s] and what hands it over.

    Each frame of the span has to be taken. What goes wrong in a process is raised there.
    """
    drawers: list[Child] = []

    def stop() -> None:
        """End them all; they have nothing to clean up."""
        for drawer in drawers:
            drawer.process.kill()

    def frames() -> Iterator[tuple[float, Callable[[], Frame]]]:
        """All frames, from one process after the other."""
        rate, shown = options.frames_per_second, list[Frame]()

        def take(drawer: Child) -> Frame:
            """The next frame: of this process, or the last one again."""
            if (frame := _next_of(drawer)) is not None:
                shown[:] = [frame]
            return shown[0]

        for index in counted_frames(until, rate, progress=progress):
            yield index / rate, partial(take, drawers[index % count])

    environment = {**os.environ, "LP_NUM_THREADS": "0"}  # no threads beside it
    with cleaned_up_if_stopped(stop):
        try:
            for first in range(count):
                drawers.append(Child(__name__, environment))
                with contextlib.suppress(DiedError):  # told where its first frame is taken
                    drawers[-1].send(Share(script, options, until, first, count))
            yield frames()
        finally:
            stop()
            for drawer in drawers:
                drawer.close()


def _next_of(drawer: Child) -> Frame | None:
    """The next frame of a process, None where it is the one before it.

    Raises what it raised, UserError where it died.
    """
    while True:
        try:
            found = drawer.receive()
        except DiedError as why:
            raise UserError(
                f"a process that draws the film ended ({why}); try again, and where memory is "
                "short, take a smaller --size"
            ) from None
        if isinstance(found, Frame) or found == STILL:
            return found if isinstance(found, Frame) else None
        if isinstance(found, Exception):
            raise found
        logging.getLogger(COMPILER).handle(found)


class _LogForwarder(logging.handlers.QueueHandler):
    """Has the process that asked say what is compiled here."""

    queue: Queue[object]

    def enqueue(self, record: logging.LogRecord) -> None:
        """Hand a line over, where frames wait, too."""
        self.queue.put(record)


def serve() -> None:
    """Draw the share that the standard input tells, onto the standard output."""
    requests, results = streams()
    try:
        share: Share = pickle.load(requests)
    except (EOFError, pickle.UnpicklingError):  # whoever began this process was stopped
        return
    width, height = share.options.size
    room = max(int(AHEAD / (4 * width * height)), 2)
    drawn: Queue[object] = Queue(room)
    log = logging.getLogger(COMPILER)
    log.addHandler(_LogForwarder(drawn))
    log.setLevel(logging.INFO)
    log.propagate = False

    def hand_over() -> None:
        """Write what is drawn while the next is; where nobody reads, the process is over."""
        try:
            while (item := drawn.get()) is not None:
                pickle.dump(item, results, pickle.HIGHEST_PROTOCOL)
                results.flush()
        except BrokenPipeError:
            os._exit(1)

    writer = threading.Thread(target=hand_over)
    writer.start()
    try:
        _draw(share, drawn.put)
    except Exception as error:
        drawn.put(error)
    finally:
        drawn.put(None)
        writer.join()


def _draw(share: Share, hand_over: Callable[[object], None]) -> None:
    options = share.options
    first = 0 if options.span is None else round(options.span[0] * options.frames_per_second)
    with Capture(scene_of(share.script, options.head), options) as capture:
        playing = capture.play(share.script, until=share.until, progress=False)
        for index, _ in enumerate(playing):
            is_mine = index >= first and index % share.every == share.first
            is_still = index >= first and capture.is_still()
            if is_mine and not is_still:
                hand_over(capture.draw_frame())
                continue
            capture.refine()
            if is_mine:
                hand_over(STILL)
