"""What `risorius bench capture` prints: frames a second of a film, and where its time goes.

The film is the face's script, as the mesh is and refined, side by side; of a head of one's own
refined alone. Stages are those of one process that waits for OpenGL after each of them, in frames
that are drawn: where the face is still, a film shows its last picture again.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from risorius.app.capture import Capture, CaptureOptions, capture, outputs, processes
from risorius.app.motion import scene_of
from risorius.app.performances import script_for
from risorius.app.refining.presets import STATIC, Refinement
from risorius.app.script import Script
from risorius.assets.fitting import FittedHead

from .report import processor, table

ROUNDS = 3
WARM_UP = 5  # frames that are not counted
REST, WITHIN = "read back, captions", ("refinement", "upload", "draw")
STAGES = ("simulate", *WITHIN, REST, "encode")


def report(size: tuple[int, int], seconds: float, head: FittedHead | None = None) -> str:
    """Make films of so many seconds of the script, of a head; the text to print."""
    whole = script_for(None, "face")
    script = replace(whole, duration=min(seconds, whole.duration), poses=whole.poses)
    beside = (Refinement(refiner=STATIC),) if head is None else ()
    options = CaptureOptions(size=size, beside=beside, camera=script.camera, head=head)
    frame_count = round(script.duration * options.frames_per_second) + 1
    milliseconds: dict[str, list[float]] = {stage: [] for stage in STAGES}
    with tempfile.TemporaryDirectory() as folder:
        film = Path(folder) / "film.mp4"
        wall, spent = np.median([_timed(script, options, film) for _ in range(ROUNDS)], axis=0)
        name, drawn_count = _time_stages(script, options, film, milliseconds)
    width, height = size
    stages = [(stage, float(np.median(each))) for stage, each in milliseconds.items()]
    return "\n".join(
        [
            f"A film of {frame_count} frames of {1 + len(beside)}, {width}x{height}, 4 samples,",
            f"{drawn_count} of them drawn, the others still, on",
            f"{name}, {os.cpu_count()} cores of {processor()};",
            f"median of {ROUNDS}; processor time with that of the encoder.",
            "",
            f"{frame_count / wall:.1f} frames/s by {processes.worthwhile(options, frame_count)} "
            f"process(es): {wall:.1f} s, and {spent:.1f} s of processor time",
            "",
            "Where the time of one process goes, in a frame that is drawn:",
            *table("stage:<20|ms a frame:11.2f", [*stages, ("all", sum(ms for _, ms in stages))]),
        ]
    )


def _timed(script: Script, options: CaptureOptions, film: Path) -> tuple[float, float]:
    """Wall and processor seconds of a film, from nothing: its processes start, too."""

    def used() -> float:
        """Processor time [s] of this process and those that it began and that ended."""
        times = os.times()
        return times.user + times.system + times.children_user + times.children_system

    begin, before = time.perf_counter(), used()
    capture(script, options, output=film, progress=False)
    return time.perf_counter() - begin, used() - before


def _time_stages(
    script: Script, options: CaptureOptions, film: Path, found: dict[str, list[float]]
) -> tuple[str, int]:
    """Note what the stages of each frame take [ms]; what draws, and how many frames it drew."""
    spent: dict[str, float] = defaultdict(float)
    drawn_count = 0

    with (
        Capture(scene_of(script, options.head), options) as studio,
        outputs.film(film, options.size, options.frames_per_second) as add,
    ):
        gl = studio.surface.gl

        @contextmanager
        def timed(stage: str) -> Iterator[None]:
            begin = time.perf_counter()
            yield
            if stage == "draw":
                gl.finish()
            spent[stage] += 1e3 * (time.perf_counter() - begin)

        studio.pipeline.draw = partial(studio.pipeline.draw, timer=timed)  # type: ignore[method-assign]
        frame, frames = None, studio.play(script, progress=False)
        while True:
            with timed("simulate"):
                if next(frames, None) is None:
                    break
            before = frame
            with timed("whole"):
                frame = studio.next_frame()
            with timed("encode"):
                add(frame.image)
            drawn_count += frame is not before
            if frame is not before and drawn_count > WARM_UP:
                spent[REST] = spent["whole"] - sum(spent[stage] for stage in WITHIN)
                for stage in STAGES:
                    found[stage].append(spent[stage])
            spent.clear()
        return str(gl.info["GL_RENDERER"]), drawn_count
