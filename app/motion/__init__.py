"""Playback of a script in a scene, frame by frame, for every output; idle life is in life.py."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from tqdm import tqdm

from risorius.assets.fitting import FittedHead
from risorius.geometry.arrays import Floats64

from ..control_names.limits import ControlValues
from ..scenes import Scene, build_scene
from ..script import Script
from ..stopping import cleaned_up_if_stopped
from ..tally import tally
from .life import Idle

SETTLING_TIME = 1.0  # [s] after which the face rests in a pose


def scene_of(script: Script, head: FittedHead | None = None) -> Scene:
    """Build the scene of a script; raise UserError if the script does not fit the scene."""
    scene = build_scene(script.scene, head)
    script.check(scene.limits)
    return scene


def play(
    scene: Scene,
    script: Script,
    frames_per_second: float,
    *,
    until: float | None = None,
    viewer: Floats64 | None = None,
    step: Callable[[float], None] | None = None,
    progress: bool = True,
) -> Iterator[float]:
    """Play a script: move the scene to each frame, and yield the frame's time [s].

    The scene begins at rest in the script's first pose.

    until: time of the last frame [s]; None takes the script's end. viewer: position of a viewer
    [mm], shape (3,); the face looks there, and idle life moves controls that the script does not
    name. None: no idle life. step: function that simulates some seconds; None takes the scene's.
    """
    step = scene.step if step is None else step
    idle = None if viewer is None else Idle(scene)
    moved = frozenset[str]().union(*map(scene.moved_by, script.names))

    def pose(time: float) -> None:
        """Set the values of the script at a time [s], and of idle life for other controls."""
        values = script.values(time, scene.limits)
        if idle is not None and viewer is not None:
            opening = opening_of_jaw(scene, values)
            living = idle.amounts(moved, viewer, time, opening=opening)
            values = scene.limits.pose(living, over=values)
        scene.set_controls(values)

    scene.reset()
    pose(0.0)
    if any(scene.values.values()):
        step(SETTLING_TIME)
    until = script.duration if until is None else until
    for index in counted_frames(until, frames_per_second, progress=progress):
        pose(index / frames_per_second)
        if index:
            step(1.0 / frames_per_second)
        yield index / frames_per_second


def opening_of_jaw(scene: Scene, values: ControlValues) -> float:
    """Return how far a pose opens the jaw, 0 to 1; 0 in a scene without a face."""
    if scene.face is None:
        return 0.0
    controls = scene.face.simulation.controls
    sums = dict(zip(controls.lowest, controls.sums_of(values.numbers), strict=True))
    return float(max(sums.get("jaw_open", 0.0), 0.0))


def counted_frames(until: float, frames_per_second: float, *, progress: bool) -> Iterator[int]:
    """Count the frames up to a time [s], with a progress bar."""
    frames = range(round(until * frames_per_second) + 1)
    bar = tqdm(frames, unit="frame", disable=not progress or None, leave=False)
    with cleaned_up_if_stopped(bar.close):
        for index in bar:
            tally.frames += 1
            yield index
