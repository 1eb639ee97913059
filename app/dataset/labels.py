"""Compute the labels of a sample's face, including all labels of `capture --passes`.

docs/dataset.md has the unit and the convention of each field.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from risorius import render

from ..motion.curves import ACTION_UNIT_LAYER, ARKIT_LAYER, solved
from ..passes.labels import labels_of
from ..scenes import FaceScene
from .openings import apertures

LABEL_DECIMALS = 5  # decimal places of labels


def labels_of_face(
    scene: FaceScene,
    camera: render.OrbitCamera,
    size: tuple[int, int],
    depth: Any,
    covered: Any = None,
) -> dict[str, Any]:
    """Return all labels of a face in its current state.

    size: width and height of the picture [pixels]. depth: depth map of the picture, (H, W).
    covered: flags of pixels where a mask hides landmarks, (H, W); None: no mask.
    """
    arkit = solved(scene, ARKIT_LAYER, _in_one_frame(scene.simulation.controls.sums))
    labels = labels_of(scene, camera, size, depth, covered)
    pixels = np.array(labels["landmarks"]["pixels"])[:68]
    # Positions without the rotation of the head.
    positions = scene.positions @ scene.bone_transforms()["cranium"][:3, :3]
    low, high = (np.clip(each, 0.0, size) for each in (pixels.min(axis=0), pixels.max(axis=0)))
    return {
        "action_units": action_units(scene),
        "arkit": {name: round(float(value[0]), LABEL_DECIMALS) for name, value in arkit.items()},
        "apertures": apertures(positions, scene.faces, positions[scene.landmarks]),
        "face_box": np.concatenate([low, high - low]).round(3).tolist(),
        **labels,
    }


def action_units(scene: FaceScene) -> dict[str, float]:
    """Return the values of all action units of a face, 0 to 1: AU12_left, AU12_right, AU12 etc.

    A unit whose control is set has this value. Other controls (visemes, head and gaze) are
    expressed by units as well as possible. A unit without a side has the value of its stronger
    side, because FACS scores it without regard to sides.
    """
    sums = _in_one_frame(scene.simulation.controls.sums)
    found = solved(scene, ACTION_UNIT_LAYER, sums, _in_one_frame(scene.values))
    units = {}
    for name in sorted(scene.simulation.controls.layers[ACTION_UNIT_LAYER], key=by_number):
        names = (name, f"{name}_left", f"{name}_right")
        largest = max(float(found[each][0]) for each in names if each in found)
        units[name] = round(largest, LABEL_DECIMALS)
    return units


def by_number(unit: str) -> tuple[int, str]:
    """Return the sort key of a unit: AU2 comes before AU12, and AU12 before AU12_left."""
    number, _, side = unit.removeprefix("AU").partition("_")
    return int(number), side


def _in_one_frame(values: Mapping[str, float]) -> dict[str, Any]:
    return {name: np.array([value]) for name, value in values.items()}
