"""Another jaw and other lids for a face: what moves skin from below, beside the muscles.

Source: sim/skull.py and sim/lids.py, whose parts are put together here for any numbers of a rig.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.sim.anatomy import Anatomy
from risorius.sim.lids import place_lids, turn_lids
from risorius.sim.rig import LidMuscle, Rig
from risorius.sim.skull import condyles_from_landmarks, mandible_weight_from_landmarks
from risorius.sim.state import State
from risorius.sim.tissue import carry

Array = npt.NDArray[np.float64]

JAW = ("jaw_open", "jaw_forward", "jaw_sideways")


class Carried(NamedTuple):
    """How bones and lids move the far ends of the tissue's springs."""

    by: Array  # (V, 3) mm
    hold: Array  # (V,) stiffness of moved folds


def framed(anatomy: Anatomy, rig: Rig) -> Anatomy:
    """The same face with jaw and lids of another rig, by its landmarks alone."""
    surface, landmarks, skull = anatomy.surface, anatomy.landmarks, anatomy.skull
    if rig.jaw != skull.jaw:
        weight = mandible_weight_from_landmarks(surface, landmarks, rig.jaw, anatomy.lip_side)
        weight = np.clip(surface.smoothed(weight, rig.jaw.softness), 0.0, 1.0)
        condyles = condyles_from_landmarks(landmarks, rig.jaw)
        skull = replace(skull, jaw=rig.jaw, condyles=condyles, mandible_weight=weight)
    lids, known = anatomy.lids, anatomy.rig
    if (rig.eyes, _lid_muscles(rig)) != (known.eyes, _lid_muscles(known)):
        names = [control.name for control in anatomy.controls]
        lids = place_lids(rig, surface, landmarks, skull.eyeballs, names)
        skull = replace(skull, eyes=rig.eyes)
    return replace(anatomy, rig=rig, skull=skull, lids=lids)


def _lid_muscles(rig: Rig) -> list[LidMuscle]:
    return [each for each in rig.muscles if isinstance(each, LidMuscle)]


def carried(anatomy: Anatomy, control: str, value: float) -> Carried:
    """What one control of the jaw or of a lid does."""
    surface, state = anatomy.surface, State.at_rest(anatomy.surface)
    mandible = anatomy.skull.mandible_motion(*(value * (control == name) for name in JAW))
    carry(state, surface.positions, surface.normals, anatomy.skull.mandible_weight, mandible)
    if anatomy.lids is not None:
        active = np.array([value * (control == each.name) for each in anatomy.controls])
        gaze = np.zeros((len(anatomy.skull.eyeballs), 2))
        turn_lids(state, surface.positions, anatomy.lids.vertices, anatomy.lids.drive(active), gaze)
    return Carried(state.carried - surface.positions, state.hold)
