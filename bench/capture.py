"""What `risorius bench capture` prints: frames a second of a film, and where its time goes.

The film is the face's script, as the mesh is and refined, side by side. It is made by one process
and by as many as `capture` takes here, in turn: on a shared machine only cases of one run can be
compared. Stages are those of one process that waits for OpenGL after each of them, in frames that
are drawn: where the face is still, a film shows its last picture again.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from risorius.app.capture import Capture, CaptureOptions, capture, outputs, processes
from risorius.app.motion import scene_of
from risorius.app.performances import script_for
from risorius.app.refining.presets import STATIC, Refinement
from risorius.app.script import Script

from .report import processor, table

ROUNDS = 3
WARM_UP = 5  # frames that are not counted
STAGES = ("simulate", "refine", "upload", "draw", "read back", "captions", "encode")


def report(size: tuple[int, int], seconds: float) -> str:
    """Make films of so many seconds of the script; the text to print."""
    whole = script_for(None, "face")
    script = replace(whole, duration=min(seconds, whole.duration), poses=whole.poses)
    options = CaptureOptions(size=size, beside=(Refinement(refiner=STATIC),), camera=script.camera)
    frame_count = round(script.duration * options.frames_per_second) + 1
    usual = processes.worthwhile(options, frame_count)
    counts = sorted({1, usual})
    walls: dict[int, list[float]] = {count: [] for count in counts}
    used: dict[int, list[float]] = {count: [] for count in counts}
    milliseconds: dict[str, list[float]] = {stage: [] for stage in STAGES}
    with tempfile.TemporaryDirectory() as folder:
        film = Path(folder) / "film.mp4"
        for turn in range(ROUNDS):
            for count in counts if turn % 2 == 0 else reversed(counts):
                with mock.patch.object(processes, "worthwhile", lambda *_, n=count: n):
                    wall, processor_time = _timed(script, options, film)
                walls[count].append(wall)
                used[count].append(processor_time)
        name, drawn_count = _time_stages(script, options, film, milliseconds)
    width, height = size
    rows = [
        (
            f"{count} process" + ("es" if count > 1 else ""),
            frame_count / float(np.median(walls[count])),
            float(np.median(walls[count])),
            float(np.median(used[count])),
        )
        for count in counts
    ]
    stages = [(stage, float(np.median(each))) for stage, each in milliseconds.items()]
    return "\n".join(
        [
            f"A film of {frame_count} frames of two heads, {width}x{height}, 4 samples,",
            f"{drawn_count} of them drawn, the others still, on",
            f"{name}, {os.cpu_count()} cores of {processor()};",
            f"{ROUNDS} interleaved rounds, medians; processor time with that of the encoder.",
            "",
            *table("drawn by:<16|frames/s:9.1f|wall [s]:9.1f|processor [s]:14.1f", rows),
            "",
            "Where the time of one process goes, in a frame that is drawn:",
            *table("stage:<16|ms a frame:11.2f", [*stages, ("all", sum(ms for _, ms in stages))]),
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

    def timed(stage: str, call: Callable[..., Any], *outer: str) -> Callable[..., Any]:
        """The same call; its time is its stage's, and no longer that of those it is part of."""

        def measured(*arguments: Any, **options: Any) -> Any:
            """Call, and note the time."""
            begin = time.perf_counter()
            result = call(*arguments, **options)
            elapsed = 1e3 * (time.perf_counter() - begin)
            spent[stage] += elapsed
            for each in outer:
                spent[each] -= elapsed
            return result

        return measured

    with (
        Capture(scene_of(script), options) as studio,
        outputs.film(film, options.size, options.frames_per_second) as add,
    ):
        pipeline, surface, end = studio.pipeline, studio.surface, studio.surface.end

        def end_and_wait() -> None:
            """Have everything drawn."""
            end()
            surface.gl.finish()

        changed: list[tuple[Any, str, Callable[..., Any]]] = [
            (pipeline, "step", timed("simulate", pipeline.step)),
            (pipeline, "draw", timed("draw", pipeline.draw, "captions")),
            (surface, "end", timed("draw", end_and_wait, "captions")),
            (surface, "read_scene", timed("read back", surface.read_scene, "captions")),
        ]
        for drawn, *_ in studio.viewports:
            changed.append((drawn, "refine", timed("refine", drawn.refine, "draw")))
            changed.append((drawn, "upload", timed("upload", drawn.upload, "draw")))
        for thing, attribute, call in changed:
            setattr(thing, attribute, call)
        draw, write = timed("captions", studio.next_frame), timed("encode", add)
        frame = None
        for _ in studio.play(script, progress=False):
            before, frame = frame, draw()
            write(frame.image)
            drawn_count += frame is not before
            if frame is not before and drawn_count > WARM_UP:
                for stage in STAGES:
                    found[stage].append(spent[stage])
            spent.clear()
        return str(surface.gl.info["GL_RENDERER"]), drawn_count
