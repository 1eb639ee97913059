"""Measure the window's frames per second while a smile plays, and its load while idle.

The real window runs as fast as possible; it only waits for the screen. Each round plays all cases,
in alternating order, because on a shared machine only cases of one run can be compared. A case
begins like a new window, with one untimed second in which the window chooses its level of detail.
"""

from __future__ import annotations

import os
import time
from dataclasses import replace

import numpy as np

from risorius.app.performances import script_for
from risorius.app.script import Pose, Script
from risorius.app.viewer import Viewer
from risorius.app.viewer.picture.stage import LevelOfDetail
from risorius.app.viewer.session.physics import PHASE_NAMES
from risorius.app.viewer.settings import Display
from risorius.assets.fitting import FittedHead
from risorius.geometry.arrays import Floats64

from .report import Target, at_least, processor, table

WARM_UP = 1.0  # [s]
IDLE_SECONDS = 8.0

FrameRows = list[list[float]]
"""For each frame: seconds, seconds of processor time, milliseconds of the stages."""


def measure(
    seconds: float, size: tuple[int, int], head: FittedHead | None = None
) -> tuple[str, list[Target]]:
    """Time the window: `seconds` for each case, after a second of warming up.

    `head`: replaces the built-in head; no speed is promised for it. Returns the text to print, and
    the window's targets for software OpenGL.
    """
    cases = {
        "smile": Display(),
        "smile, unrefined": Display(is_refined=False),
        "smile, wipe": Display(compare="wipe"),
        "smile, side by side": Display(compare="side by side"),
        "smile, muscles": Display(overlays=["muscles"]),
    }
    seen: dict[str, FrameRows] = {name: [] for name in cases}
    rounds = 3
    with Viewer(_smile(), size, Display(), head=head) as viewer:
        triangle_count = len(viewer.session.scene.faces)
        viewer.session.is_looping = True
        for turn in range(rounds):
            for name in cases if turn % 2 == 0 else reversed(cases):
                seen[name] += _play(viewer, cases[name], seconds / rounds)
        idle, alive = (_idle_load(viewer, is_alive=each) for each in (False, True))
        is_software = viewer.surface.is_software
        driver = viewer.surface.gl.info["GL_RENDERER"]
        width, height = viewer.surface.size
    lines = [
        f"The window at {width}x{height} on {driver}, {triangle_count} triangles,",
        f"{os.cpu_count()} cores of {processor()}; {rounds} interleaved rounds.",
        "",
        *table(
            "case:<30|frames/s:8.1f|median:7.1f|95 %:7.1f|best:7.1f|processor:9.1f|"
            f"{PHASE_NAMES[0]}:12.1f|{'|'.join(f'{stage}:10.1f' for stage in PHASE_NAMES[1:])}|"
            "the rest:9.1f",
            [_cells(name, np.array(frames)) for name, frames in seen.items()],
        ),
        "",
        "Times in ms of a frame; processor: its time on all cores, which other programs",
        "disturb least; on the right, medians of its stages; the rest is events, panels, and",
        "handing the picture over.",
        f"Nothing moves: {100.0 * idle:.1f} % of a core; the face lives: {100.0 * alive:.0f} %.",
    ]
    promised_rate = 20.0  # frames a second at 1280x720 with software OpenGL on 2 cores
    targets = []
    if is_software and head is None:
        for name in cases:
            if name != "smile, muscles":
                rate = _rate(np.array(seen[name]))
                targets.append(at_least(name, rate, promised_rate, " frames/s"))
    return "\n".join(lines), targets


def _smile() -> Script:
    strengths = {0.0: 0.0, 0.6: 1.0, 1.2: 1.0, 1.8: 0.0}
    poses = tuple(Pose(time, {"joy": strength}) for time, strength in strengths.items())
    return replace(script_for(None, "face"), title="smile", duration=2.0, poses=poses)


def _play(viewer: Viewer, display: Display, seconds: float) -> FrameRows:
    """Let the window play for some time; return the times of its frames."""
    viewer.settings.display = replace(display)
    viewer.face.painter.level_of_detail = LevelOfDetail(is_software=viewer.surface.is_software)
    if not viewer.session.is_playing:
        viewer.session.toggle_playing()
    _run(viewer, WARM_UP)
    return _run(viewer, seconds)


def _run(viewer: Viewer, seconds: float) -> FrameRows:
    frames = []
    last = time.perf_counter()
    used = time.process_time()
    end = last + seconds
    while last < end:
        viewer.frame()
        now = time.perf_counter()
        spent = time.process_time()
        stages = [viewer.context.times.milliseconds[stage][-1] for stage in PHASE_NAMES]
        frames.append([now - last, spent - used, *stages])
        last = now
        used = spent
    return frames


def _idle_load(viewer: Viewer, *, is_alive: bool) -> float:
    """Fraction of one core that the window uses while nothing happens, or during idle motion."""
    viewer.session.neutral()
    viewer.settings.is_alive = is_alive
    while not (viewer.schedule.is_idling if is_alive else viewer.schedule.is_idle):
        viewer.frame()
    begin = time.perf_counter()
    used = time.process_time()
    while time.perf_counter() - begin < IDLE_SECONDS:
        viewer.schedule.pause()
        viewer.frame()
    return (time.process_time() - used) / (time.perf_counter() - begin)


def _rate(frames: Floats64) -> float:
    return len(frames) / float(frames[:, 0].sum())


def _cells(name: str, frames: Floats64) -> list[object]:
    """The row of a case."""
    elapsed = 1e3 * frames[:, 0]
    stages = frames[:, 2:]
    rest = np.median(elapsed - stages.sum(axis=1))
    times = [np.median(elapsed), np.percentile(elapsed, 95), elapsed.min()]
    times.append(1e3 * np.median(frames[:, 1]))
    return [name, _rate(frames), *times, *np.median(stages, axis=0), rest]
