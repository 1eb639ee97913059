"""Build all that a simulation needs from a mesh: lids, muscles, springs and contacts.

foundation.py checks the head and places the bones.

Source: Kähler et al. 2002, "Head shop": the model is fitted to a head only by landmarks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..geometry.arrays import Floats64, Integers64
from ..geometry.steps import smoothstep
from .contact import PAIR_GAP, Grip, pair_lips
from .eye_contact import watch_eyeballs
from .foundation import Foundation, foundation_of
from .landmarks import (
    INNER_CORNERS,
    LOWER_INNER_LIP,
    UPPER_INNER_LIP,
    mouth_line,
)
from .lids import Lids, place_lids
from .muscle_forces import MuscleForces, build_muscle_forces
from .muscles import place_muscles
from .polylines import polyline_distance
from .skin_model import SkinModel
from .substep import LONGEST_SUBSTEP, STEP_ROUNDING
from .surface import SkinSurface
from .teeth import watch_teeth
from .tissue import EdgeSprings, TissueSprings, masses_for_step
from .tongue import Tongue, place_tongue

SEAL_BROKEN_BY_JAW = 0.25  # jaw_open at which the lips no longer stick
SEAL_LOST_BY_THRUST = 0.15  # at full jaw_forward: lips slide, or the upper one turns inside out
NECK_LENGTH = 45.0  # mm below the chin over which the head's turn fades, or the throat folds
MOST_NECK_RISE = 0.3  # greatest slope of the base of the neck, which rises toward the nape
MEETING_FRACTION = 0.2  # share of the jaw's motion at which both lips meet over an open jaw
WHOLE_LIP_REACH = 7.0  # mm from the mouth line up to which skin follows fully
LIP_END_REACH = 32.0  # mm from the mouth line beyond which skin stays
STEP_MARGIN = 1.0 + STEP_ROUNDING  # factor by which a substep may exceed LONGEST_SUBSTEP


@dataclass(frozen=True, eq=False)
class FaceModel(Foundation):
    """A face at rest: nothing here changes while it is simulated."""

    muscles: MuscleForces
    lids: Lids | None
    skin: SkinModel
    tongue: Tongue | None
    turns: Floats64  # (V, 1) share of the head's pose: 1, fading to 0 down the neck
    passive_hold: Floats64  # (V,)
    closed_weight: Floats64  # (V,) of the mandible while the lips are kept closed over an open jaw

    def grip(self, activation: Floats64, jaw: tuple[float, ...], closed: float) -> Grip:
        """Return how firmly the lips stick together; the jaw and some muscles part them.

        activation: one value for each muscle, shape (M,); jaw: values open, forward, sideways;
        closed: how far the lips are kept together over an open jaw, 0..1.
        """
        if not len(self.skin.lips.vertex):
            return Grip(0.0, 0.0, 0.0)
        muscles = self.muscles
        strength = max(0.0, 1.0 - (1.0 - closed) * jaw[0] / SEAL_BROKEN_BY_JAW)
        if strength == 0.0:
            return Grip(0.0, 0.0, 0.0)
        strength *= float((1.0 - activation * muscles.opens_lips).prod())
        slid = 1.0 - SEAL_LOST_BY_THRUST * max(jaw[1], 0.0)
        slid *= float((1.0 - activation * muscles.slides_lips).prod())
        activity = float((activation * muscles.reaches_lips).max(initial=max(map(abs, jaw))))
        return Grip.from_seal(strength, activity, slid)


def build_face_model(head: Any) -> FaceModel:
    """Build a face from a head; raises ValueError, which names the wrong attribute."""
    foundation = foundation_of(head)
    if foundation.landmark_indices is None:
        return build_plain(foundation)
    return build_face(foundation, foundation.landmark_indices)


def build_plain(foundation: Foundation) -> FaceModel:
    """A spring mesh that may have a jaw and eyeballs, but no lids, no tongue and no fixed neck."""
    count = foundation.surface.vertex_count
    return _assembled_model(
        foundation,
        lids=None,
        tongue=None,
        corners=np.zeros((0, 3)),
        turns=np.ones((count, 1)),
        closed_weight=foundation.skull.mandible_weight.copy(),
    )


def build_face(foundation: Foundation, landmark_indices: Integers64) -> FaceModel:
    """Build a face with lips, and with lids over its eyeballs.

    landmark_indices: vertex indices of the landmarks, shape (68,).
    """
    surface = foundation.surface
    landmarks = foundation.landmarks
    eyeballs = foundation.skull.eyeballs
    lids = None
    if eyeballs:
        names = [control.name for control in foundation.controls]
        lids = place_lids(foundation.rig, surface, landmarks, eyeballs, names)
    return _assembled_model(
        foundation,
        lids=lids,
        tongue=place_tongue(foundation.parts, foundation.space, landmark_indices),
        corners=landmarks[list(INNER_CORNERS)],
        turns=_head_weight(surface, landmarks),
        closed_weight=_closed_weight(surface, landmarks, foundation.skull.mandible_weight),
    )


def _assembled_model(
    foundation: Foundation,
    *,
    lids: Lids | None,
    tongue: Tongue | None,
    corners: Floats64,
    turns: Floats64,
    closed_weight: Floats64,
) -> FaceModel:
    """Muscles, springs and contacts; corners: eye corners, where edges differ, (n, 3) [mm]."""
    rig = foundation.rig
    surface = foundation.surface
    landmarks = foundation.landmarks
    side = foundation.lip_side
    skull = foundation.skull
    placed = place_muscles(rig, surface, landmarks, side)
    seal = rig.tissue.lip_seal * rig.tissue.stiffness_scale
    lips = pair_lips(surface, landmarks, side, seal)
    muscles = build_muscle_forces(
        placed, rig, surface, skull.mandible_weight, lips.members, landmarks, side
    )
    nose = [30, 33]  # its tip and its base
    septum = np.zeros((0, 3)) if landmarks is None else landmarks[nose]
    springs = TissueSprings.under(surface, rig.tissue, septum)
    edges = EdgeSprings.along(surface, rig.tissue, corners)
    passive, greatest = _stiffnesses(muscles, lids, surface.vertex_count)
    skin = SkinModel(
        rest=surface.positions,
        mass=_masses(surface, springs, edges, greatest),
        tissue=springs,
        edges=edges,
        lips=lips,
        eyes=watch_eyeballs(surface, skull.eyeballs),
        teeth=watch_teeth(foundation.parts, surface, foundation.space),
    )
    return FaceModel(
        **vars(foundation),
        muscles=muscles,
        lids=lids,
        skin=skin,
        tongue=tongue,
        passive_hold=passive,
        turns=turns,
        closed_weight=closed_weight,
    )


def _masses(
    surface: SkinSurface, springs: TissueSprings, edges: EdgeSprings, greatest: Floats64
) -> Floats64:
    """Mass of each vertex; `greatest`: stiffness there of fully active muscles, shape (V,)."""
    bound = edges.row_bound(surface.vertex_count)
    bound += np.maximum(springs.tangential, springs.normal) + greatest
    return masses_for_step(surface.areas, bound, LONGEST_SUBSTEP * STEP_MARGIN)


def _stiffnesses(muscles: MuscleForces, lids: Lids | None, count: int) -> tuple[Floats64, Floats64]:
    """Stiffness of relaxed and of fully active muscles, lids included, per vertex."""
    greatest = muscles.hold_of(np.ones_like(muscles.skin.passive), count)
    passive = muscles.hold_of(muscles.skin.passive, count)
    if lids is not None:
        for hold in (passive, greatest):
            np.add.at(hold, lids.vertices.vertex, lids.hold)
        moved = lids.vertices.fold_hold + lids.vertices.shut_hold
        np.add.at(greatest, lids.vertices.vertex, moved)
    return passive, greatest


def _head_weight(surface: SkinSurface, landmarks: Floats64) -> Floats64:
    """Return how far skin follows the head's pose, shape (V, 1); 0 at the base of the neck.

    Where the mesh ends at the nape, the base rises toward it, so that the end does not move.
    """
    chin = landmarks[8]
    ears = landmarks[[0, 16], 2].mean()
    below = chin[1] - surface.positions[:, 1]
    behind = np.maximum(chin[2] - surface.positions[:, 2], 0.0)
    border = surface.graph.border
    is_nape = (below[border] > 0.0) & (surface.positions[border, 2] < ears)
    nape = border[is_nape]
    needed = (NECK_LENGTH - below[nape]) / np.maximum(behind[nape], 1.0)
    rise = min(needed.max(initial=0.0), MOST_NECK_RISE)
    head_weight: Floats64 = np.clip(1.0 - (below + rise * behind) / NECK_LENGTH, 0.0, 1.0)[:, None]
    return head_weight


def _closed_weight(surface: SkinSurface, landmarks: Floats64, weight: Floats64) -> Floats64:
    """Return the mandible's weight that keeps lips as at rest over an open jaw, shape (V,)."""
    distance = polyline_distance(surface.positions, mouth_line(landmarks))
    upper, lower = (landmarks[list(lip)] for lip in (UPPER_INNER_LIP, LOWER_INNER_LIP))
    if np.linalg.norm(upper - lower, axis=1).max() > PAIR_GAP:  # open at rest
        lips = [polyline_distance(surface.positions, lip) for lip in (upper, lower)]
        distance = np.minimum(*lips)
    reach = (LIP_END_REACH - distance) / (LIP_END_REACH - WHOLE_LIP_REACH)
    return weight + smoothstep(reach) * (MEETING_FRACTION - weight)
