"""How far sums of shapes are from the simulation while a take plays, as a tracker would weigh them.

The weights are the curves of ARKit's shapes, those that `risorius export -o take.csv` writes. So
this is the distance of an avatar that plays a take from the face that it was made of.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from risorius.geometry.arrays import Floats32, Floats64
from risorius.geometry.normals import vertex_areas

from ..motion import play
from ..recordings.names import ARKIT
from ..scenes import FaceScene
from ..script import Script
from .curves import shape_curves
from .linearity import Difference
from .poses import Pose, pose_of

FRAMES_PER_SECOND = 15.0  # few of a take are as good as all


@dataclass(frozen=True)
class PlayedTake:
    """A take on a face.

    title: of it. ways: how far the skin's vertices are from rest in each frame [mm], (N, V, 3).
    curves: of ARKit's shapes, (N, 52).
    """

    title: str
    ways: Floats32
    curves: Floats64


def played_take(scene: FaceScene, script: Script) -> PlayedTake:
    """Play a take on a face; UserError where the face lacks a control of it."""
    script.check(scene.limits)
    moved = scene.simulation.controls
    times = []
    sums = []
    controls = []
    ways = []
    for time in play(scene, script, FRAMES_PER_SECOND, progress=False):
        times.append(time)
        sums.append(np.array(moved.wanted))
        controls.append(scene.values.numbers)
        ways.append((pose_of(scene).skin - scene.rest_positions).astype(np.float32))
    curves = shape_curves(
        scene,
        np.array(times),
        dict(zip(moved.lowest, np.stack(sums, axis=1), strict=True)),
        dict(zip(scene.values, np.stack(controls, axis=1), strict=True)),
    )
    return PlayedTake(script.title or script.source, np.stack(ways), curves)


def difference_on(
    take: PlayedTake,
    scene: FaceScene,
    poses: Mapping[str, tuple[Pose, Pose]],
    pairs: Sequence[tuple[str, str]] = (),
) -> Difference:
    """How far sums are from a take: at most, and the root mean square over frames and skin.

    poses: of ARKit's shapes, and of the pairs whose correctives are added.
    """
    ways = {name: poses[name][0].skin - poses[name][1].skin for name in ARKIT}
    weights = dict(zip(ARKIT, take.curves.T, strict=True))
    for first, second in pairs:
        name = f"{first}_{second}"
        pose, rest = poses[name]
        ways[name] = pose.skin - rest.skin - ways[first] - ways[second]
        weights[name] = weights[first] * weights[second]
    areas = vertex_areas(scene.rest_positions, scene.faces)
    shares = areas / areas.sum()
    farthest = 0.0
    squares = []
    for frame, way in enumerate(take.ways):
        summed = sum(weights[name][frame] * each for name, each in ways.items())
        off = np.linalg.norm(summed - way, axis=1)
        farthest = max(farthest, float(off.max()))
        squares.append(float(shares @ off**2))
    return Difference((take.title,), farthest, float(np.sqrt(np.mean(squares))))
