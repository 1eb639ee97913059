"""Measure errors of sums of shapes against the simulation of a take, such as a performance.

The weights are the curves of ARKit's shapes that `risorius export -o take.csv` writes. So the error
is the distance between an avatar and the simulated face while both play the take.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from risorius.geometry.arrays import Floats32, Floats64
from risorius.geometry.normals import vertex_areas

from ..motion import play
from ..recordings.names import ARKIT_SHAPES
from ..scenes import FaceScene
from ..script import Script
from ..stopping import cleaned_up_if_stopped
from .curves import shape_curves
from .linearity import CANDIDATE_COUNT, Difference, Sums
from .poses import FacePose, pose_of, rest_in

FRAMES_PER_SECOND = 15.0  # rate at which the take is sampled


@dataclass(frozen=True)
class PlayedTake:
    """A take that a simulated face has played.

    title: title of the take.
    displacements: displacements of the skin's vertices from rest in each frame [mm], (N, V, 3).
    curves: weights of ARKit's shapes in each frame, (N, 52).
    """

    title: str
    displacements: Floats32
    curves: Floats64


def played_take(scene: FaceScene, script: Script) -> PlayedTake:
    """Play a take on a face; a control that the face lacks raises UserError."""
    script.check(scene.limits)
    moved = scene.simulation.controls
    times = []
    sums = []
    controls = []
    displacements = []
    for time in play(scene, script, FRAMES_PER_SECOND, progress=False):
        times.append(time)
        sums.append(np.array(moved.wanted))
        controls.append(scene.values.numbers)
        displacements.append((pose_of(scene).skin - scene.rest_positions).astype(np.float32))
    curves = shape_curves(
        scene,
        np.array(times),
        dict(zip(moved.lowest, np.stack(sums, axis=1), strict=True)),
        dict(zip(scene.values, np.stack(controls, axis=1), strict=True)),
    )
    return PlayedTake(script.title or script.source, np.stack(displacements), curves)


def worth_correcting_on(
    take: PlayedTake,
    scene: FaceScene,
    poses: Mapping[str, tuple[FacePose, FacePose]],
    count: int,
    *,
    progress: bool,
) -> list[tuple[str, str]]:
    """Return at most `count` pairs of ARKit's shapes whose correctives improve a take most.

    Only pairs that the take plays together on the same skin are simulated. Pairs are chosen one
    after another; each reduces the squared error most. If no pair reduces it, the choice ends.
    """
    weights = dict(zip(ARKIT_SHAPES, take.curves.T, strict=True))
    sums = Sums(scene, {name: poses[name] for name in ARKIT_SHAPES})
    played = {
        pair: float((weights[pair[0]] * weights[pair[1]]).sum()) * sums.shared(*pair)
        for pair in sums.pairs
    }
    together = [pair for pair, share in played.items() if share > 0.0]
    tried = sorted(together, key=lambda pair: -played[pair])[: CANDIDATE_COUNT * count]
    if not tried:
        return []
    displacements = []
    bar = tqdm(tried, "Pairs", unit="pair", disable=not progress or None, leave=False)
    with cleaned_up_if_stopped(bar.close):
        for pair in bar:
            both = dict.fromkeys(pair, 1.0)
            displacement = rest_in(scene, both).skin - scene.rest_positions
            displacements.append(displacement - sums.sum(both))
    area_weights = np.sqrt(vertex_areas(scene.rest_positions, scene.faces))[:, None]
    weighted = [(area_weights * displacement).ravel() for displacement in displacements]
    columns = np.stack(weighted, axis=1)
    products = np.stack([weights[first] * weights[second] for first, second in tried], axis=1)
    along = np.zeros(products.shape)  # scalar products of each frame's error and each corrective
    for frame, displacement in enumerate(take.displacements):
        at_once = {name: float(curve[frame]) for name, curve in weights.items()}
        error = displacement - sums.sum(at_once)
        along[frame] = (area_weights * error).ravel() @ columns
    return _choose_greedily(tried, products, along, columns.T @ columns, count)


def _choose_greedily(
    pairs: Sequence[tuple[str, str]],
    products: Floats64,
    along: Floats64,
    lengths: Floats64,
    count: int,
) -> list[tuple[str, str]]:
    """Choose the pairs greedily, by the reduction of the squared error.

    products: weights of the correctives in each frame, (N, K). along: scalar products of each
    frame's error with each corrective, (N, K). lengths: scalar products of correctives, (K, K).
    """
    left = along.copy()
    found: list[tuple[str, str]] = []
    while len(found) < min(count, len(pairs)):
        reductions = 2.0 * products * left - products**2 * np.diag(lengths)  # in each frame
        taken = reductions.sum(axis=0)
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
    poses: Mapping[str, tuple[FacePose, FacePose]],
    pairs: Sequence[tuple[str, str]] = (),
) -> Difference:
    """Return the errors of sums on a take: the greatest, and the RMS over frames and skin.

    poses: poses of ARKit's shapes, and of the pairs whose correctives are added.
    """
    sums = Sums(scene, poses, pairs)
    areas = vertex_areas(scene.rest_positions, scene.faces)
    area_weights = areas / areas.sum()
    farthest = 0.0
    squares = []
    for frame, displacement in enumerate(take.displacements):
        weights = dict(zip(ARKIT_SHAPES, take.curves[frame].tolist(), strict=True))
        off = np.linalg.norm(sums.sum(weights) - displacement, axis=1)
        farthest = max(farthest, float(off.max()))
        squares.append(float(area_weights @ off**2))
    return Difference((take.title,), farthest, float(np.sqrt(np.mean(squares))))
