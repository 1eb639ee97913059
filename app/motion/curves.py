"""Conversion of muscle activations to the controls of a layer: action units, ARKit's shapes.

`solved(scene, ACTION_UNITS, activations)` is the inverse of the tables of sim/layers.py. A
layer's controls add up, so it is a bounded least squares problem in each frame:

    minimise |weights x - activations|^2,    0 <= x <= the controls' limits

Source: Stark and Parker 1995, "Bounded-variable least-squares", as implemented in scipy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from risorius.geometry.arrays import Floats64
from risorius.geometry.directions import unit_vectors
from risorius.sim.controls import Controls
from risorius.sim.layers import LEAST_WHOLE, SIDE_ENDINGS, Layers, fraction_of_whole

from ..errors import UserError
from ..scenes import Scene

ACTION_UNIT_LAYER = "Action units"  # title of a layer
ARKIT_LAYER = "ARKit shapes"  # title of a layer


def solved(
    scene: Scene,
    layer: str,
    activations: Mapping[str, Floats64],
    controls: Mapping[str, Floats64] | None = None,
) -> dict[str, Floats64]:
    """Solve for the values of a layer's controls that fit these activations best, by name.

    layer: title of the layer. activations: sum of each lowest control in N frames, shape (N,), as
    in `Controls.sums` and `Clip.activations`. controls: values that were set, shape (N,) each. Set
    values of this layer are kept, and the solution explains only the remaining activations.

    A control with sides (AU12) is returned as only its sides (AU12_left, AU12_right). Raises
    UserError for a scene without muscles, or without the layer.
    """
    names = sided(scene, layer)
    moved = _muscles_of(scene, layer)
    tables = moved.tables
    frames = np.stack([activations[name] for name in moved.lowest], axis=1)
    weights = np.stack([tables.shares[name] for name in names])
    highest = np.array([scene.limits[name][1] for name in names])
    known = _set_values(names, tables, controls or {}, len(frames), highest)
    rest = frames - _sums(known, weights, np.stack([tables.floors[name] for name in names]))
    found, where = np.unique(rest.round(9), axis=0, return_inverse=True)
    values = _fitted_values(weights, highest, found)[where.ravel()]
    counted = dict(zip(names, np.clip(known + values, 0.0, highest).T, strict=True))
    return {name: _as_set(name, counted, tables) for name in names}


def sided(scene: Scene, layer: str) -> tuple[str, ...]:
    """Return the controls of a layer; a paired control (AU12) is replaced by both sides.

    For example, AU12_left and AU12_right are returned, but not AU12.

    Raises UserError for a head without such controls.
    """
    names = _muscles_of(scene, layer).layers.get(layer, ())
    if not names:
        raise UserError(f"{layer}: this head has no such controls; use the built-in head")
    return tuple(name for name in names if name + SIDE_ENDINGS[0] not in names)


def _muscles_of(scene: Scene, layer: str) -> Controls:
    """Return the controls of a scene's muscles; raise UserError if the scene has no muscles."""
    if scene.face is None:
        raise UserError(f"{layer}: the scene '{scene.name}' has no muscles; use the scene face")
    return scene.face.simulation.controls


def _set_values(
    names: Sequence[str],
    tables: Layers,
    controls: Mapping[str, Floats64],
    count: int,
    highest: Floats64,
) -> Floats64:
    """Return the values that were set for a layer's controls, cut off, shape (N, L)."""
    set_to = {
        name: controls.get(name, np.zeros(count)) + controls.get(_without_side(name), 0.0)
        for name in names
    }
    for name, whole in tables.share_of.items():
        if name in set_to:
            pairs = zip(set_to[name], controls.get(whole, np.zeros(count)), strict=True)
            set_to[name] = np.array([fraction_of_whole(value, of) for value, of in pairs])
    return np.clip(np.stack(list(set_to.values()), axis=1), 0.0, highest)


def _without_side(name: str) -> str:
    """Return AU12 for AU12_left, and "" for a name without a side."""
    for ending in SIDE_ENDINGS:
        if name.endswith(ending):
            return name.removesuffix(ending)
    return ""


def _sums(values: Floats64, weights: Floats64, floors: Floats64) -> Floats64:
    """Return the sums of the layer's values, shape (N, C), added up as in sim/controls.py."""
    least = np.zeros((len(values), floors.shape[1]))
    for value, floor in zip(values.T, floors, strict=True):
        np.maximum(least, np.outer(value, floor), out=least)
    sums = values @ weights
    return np.where(least > 0.0, np.maximum(sums, least), sums)


def _fitted_values(weights: Floats64, highest: Floats64, frames: Floats64) -> Floats64:
    """Return the values (N, L) whose sums are nearest to the frames (N, C)."""
    rays = _parallel_groups(weights)
    strengths = np.linalg.norm(weights, axis=1)
    reach = np.array([(strengths[ray] * highest[ray]).sum() for ray in rays])
    directions = unit_vectors(np.stack([weights[ray].sum(axis=0) for ray in rays]))
    # A small penalty on values chooses a middle one among solutions that fit equally well.
    matrix = np.vstack([directions.T, 1e-3 * np.eye(len(rays))])
    values = np.zeros((len(frames), len(weights)))
    for row, frame in zip(values, frames, strict=True):
        wanted = np.concatenate([frame, np.zeros(len(rays))])
        lengths = scipy.optimize.lsq_linear(matrix, wanted, (0.0, reach), method="bvls").x
        for ray, length in zip(rays, lengths, strict=True):
            for control in ray:  # the weakest first: a jaw drops (AU26) before it stretches (AU27)
                row[control] = min(length / strengths[control], highest[control])
                length -= row[control] * strengths[control]
    return values


def _parallel_groups(weights: Floats64) -> list[list[int]]:
    """Group controls with parallel weights (L, C), each group in order from weak to strong."""
    strengths = np.linalg.norm(weights, axis=1)
    lengths = np.maximum(np.outer(strengths, strengths), 1e-30)
    does_the_same = weights @ weights.T / lengths > 1.0 - 1e-9  # apart from their strength
    rays: list[list[int]] = []
    for control in np.argsort(strengths, kind="stable").tolist():
        for ray in rays:
            if does_the_same[control, ray[0]]:
                ray.append(control)
                break
        else:
            if strengths[control] > 0.0:
                rays.append([control])
    return rays


def _as_set(name: str, counted: Mapping[str, Floats64], tables: Layers) -> Floats64:
    """Convert an effective value to the value to set; see `share_of` in sim/layers.py."""
    whole = tables.share_of.get(name)
    if whole is None:
        return counted[name]
    of = counted.get(whole, np.zeros_like(counted[name]))
    return np.minimum(counted[name] * np.maximum(of, LEAST_WHOLE), of)
