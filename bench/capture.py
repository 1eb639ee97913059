"""The report of `risorius bench capture`: the number of film frames made per second.

The film plays the face's script, unrefined and refined side by side. While the face is still, the
last picture is repeated. `bench window` reports the time of each stage of a frame in the same
pipeline.
"""

from __future__ import annotations

import os
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from risorius.app.capture import CaptureOptions, capture, processes
from risorius.app.performances import script_for
from risorius.app.refining.presets import STATIC_REFINER, Refinement
from risorius.app.script import Script

from .canvas import Canvas
from .report import processor


def report(size: tuple[int, int], seconds: float) -> str:
    """Make films of `seconds` of the script; return the text to print."""
    whole = script_for(None, "face")
    script = replace(whole, duration=min(seconds, whole.duration), poses=whole.poses)
    beside = (Refinement(refiner=STATIC_REFINER),)
    options = CaptureOptions(size=size, beside=beside, camera=script.camera)
    frame_count = round(script.duration * options.frames_per_second) + 1
    with Canvas((16, 16)) as canvas:
        driver = canvas.surface.gl.info["GL_RENDERER"]
    rounds = 3
    with tempfile.TemporaryDirectory() as folder:
        film = Path(folder) / "film.mp4"
        wall, spent = np.median([_timed(script, options, film) for _ in range(rounds)], axis=0)
    width, height = size
    return "\n".join(
        [
            f"A film of {frame_count} frames of two, {width}x{height}, 4 samples, on",
            f"{driver}, {os.cpu_count()} cores of {processor()};",
            f"median of {rounds}; processor time with that of the encoder.",
            "",
            f"{frame_count / wall:.1f} frames/s by {processes.process_count(options, frame_count)} "
            f"process(es): {wall:.1f} s, and {spent:.1f} s of processor time",
        ]
    )


def _timed(script: Script, options: CaptureOptions, film: Path) -> tuple[float, float]:
    """Wall and processor seconds of a film, including the start of its processes."""

    def used() -> float:
        """Processor time [s] of this process and of its ended children."""
        times = os.times()
        return times.user + times.system + times.children_user + times.children_system

    begin = time.perf_counter()
    before = used()
    capture(script, options, output=film, progress=False)
    return time.perf_counter() - begin, used() - before
