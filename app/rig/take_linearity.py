"""Errors of sums of shapes against the simulation of a take, with a tracker's weights.

The weights are the curves of ARKit's shapes that `risorius export -o take.csv` writes. So this is
the distance between an avatar and its face while both play a take.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from risorius.geometry.arrays import Floats32, Floats64
from risorius.geometry.normals import vertex_areas

from ..motion import play
from ..recordings.names import ARKIT
from ..scenes import FaceScene
from ..script import Script
from ..stopping import cleaned_up_if_stopped
from .curves import shape_curves
from .linearity import TRIED, Difference, Sums
from .poses import Pose, pose_of, rest_in

FRAMES_PER_SECOND = 15.0  # this share of a take is as good as all


@dataclass(frozen=True)
class PlayedTake:
    """A take on a face.

    title: that of the take. ways: displacements of the skin's vertices from rest in each frame
        [mm], (N, V, 3).
    curves: those of ARKit's shapes, (N, 52).
    """

    title: str
    ways: Floats32
    curves: Floats64


def played_take(scene: FaceScene, script: Script) -> PlayedTake:
    """Play a take on a face; raises UserError if the face lacks one of its controls."""
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


def worth_correcting_on(
    take: PlayedTake,
    scene: FaceScene,
    poses: Mapping[str, tuple[Pose, Pose]],
    count: int,
    *,
    progress: bool,
) -> list[tuple[str, str]]:
    """The pairs of ARKit's shapes, at most `count`, whose correctives bring sums nearest to a take.

    Only pairs that the take plays together on the same skin are simulated. The pair that reduces
    the remaining squares most is chosen, repeatedly, as long as one reduces them.
    """
    weights = dict(zip(ARKIT, take.curves.T, strict=True))
    sums = Sums(scene, {name: poses[name] for name in ARKIT})
    played = {
        pair: float((weights[pair[0]] * weights[pair[1]]).sum()) * sums.shared(*pair)
        for pair in sums.pairs
    }
    together = [pair for pair, share in played.items() if share > 0.0]
    tried = sorted(together, key=lambda pair: -played[pair])[: TRIED * count]
    if not tried:
        return []
    ways = []
    bar = tqdm(tried, "Pairs", unit="pair", disable=not progress or None, leave=False)
    with cleaned_up_if_stopped(bar.close):
        for pair in bar:
            way = rest_in(scene, dict.fromkeys(pair, 1.0)).skin - scene.rest_positions
            ways.append(way - sums.sum(dict.fromkeys(pair, 1.0)))
    shares = np.sqrt(vertex_areas(scene.rest_positions, scene.faces))[:, None]
    columns = np.stack([(shares * way).ravel() for way in ways], axis=1)
    products = np.stack([weights[first] * weights[second] for first, second in tried], axis=1)
    along = np.zeros(products.shape)  # remainder of each frame along each way
    for frame, way in enumerate(take.ways):
        at_once = {name: float(curve[frame]) for name, curve in weights.items()}
        along[frame] = (shares * (way - sums.sum(at_once))).ravel() @ columns
    return _greediest(tried, products, along, columns.T @ columns, count)


def _greediest(
    pairs: Sequence[tuple[str, str]],
    products: Floats64,
    along: Floats64,
    lengths: Floats64,
    count: int,
) -> list[tuple[str, str]]:
    """The pairs that reduce the squares most, one after another.

    products: weights of the pairs in each frame, (N, K). along: remainder of each frame along the
    way of each pair, (N, K). lengths: products of ways with each other, (K, K).
    """
    left = along.copy()
    found: list[tuple[str, str]] = []
    while len(found) < min(count, len(pairs)):
        taken = (2.0 * products * left - products**2 * np.diag(lengths)).sum(axis=0)
        taken[[pairs.index(pair) for pair in found]] = -np.inf
        best = int(taken.argmax())
        if taken[best] <= 0.0:
            break
        found.append(pairs[best])
        left -= products[:, best, None] * lengths[best]
    return found


def difference_on(
    take: PlayedTake,
    scene: FaceScene,
    poses: Mapping[str, tuple[Pose, Pose]],
    pairs: Sequence[tuple[str, str]] = (),
) -> Difference:
    """Errors of sums on a take: the largest, and the root mean square over frames and skin.

    poses: those of ARKit's shapes, and of the pairs whose correctives are added.
    """
    sums = Sums(scene, poses, pairs)
    areas = vertex_areas(scene.rest_positions, scene.faces)
    shares = areas / areas.sum()
    farthest = 0.0
    squares = []
    for frame, way in enumerate(take.ways):
        weights = dict(zip(ARKIT, take.curves[frame].tolist(), strict=True))
        off = np.linalg.norm(sums.sum(weights) - way, axis=1)
        farthest = max(farthest, float(off.max()))
        squares.append(float(shares @ off**2))
    return Difference((take.title,), farthest, float(np.sqrt(np.mean(squares))))
