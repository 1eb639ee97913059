"""The compiled motion of the lids: the far ends of their tissue springs turn about the eyeballs.

lids.py explains the motion, and finds the vertices that move.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64, Integers32
from ..jit import njit
from .rig import LID_ACTIONS
from .state import State
from .surface import SkinSurface


class LidVertices(NamedTuple):
    """All lid vertices of a face, for the kernel."""

    vertex: Integers32  # (L,)
    eye: Integers32  # (L,) row of the arrays per eye below
    upper: Flags  # (L,) upper or lower lid
    closing: Floats64  # (L,) rad, turn to where closed lids meet, without overlap
    overlap: Floats64  # (L,) rad by which closed lids overlap there
    sink: Floats64  # (L,) mm nearer to the eyeball when closed
    fold: Floats64  # (L,) share of the turn of the open lid
    opening: Floats64  # (L,) rad, height of the opening in the vertex's column
    aperture: Floats64  # (eyes,) rad, greatest height of the opening
    along: Floats64  # (L,) share of the slide: 1 in the middle of the margin .. 0 around the eye
    fold_hold: Floats64  # (L,) stiffness that holds the fold while it is moved
    shut_hold: Floats64  # (L,) stiffness by which the muscle presses a shut upper lid down
    centres: Floats64  # (eyes, 3)
    radii: Floats64  # (eyes,)
    gaze_fraction: Floats64  # (eyes,) share of the gaze that lids follow
    up: Floats64  # (eyes, 3) unit, across the lid axis
    forward: Floats64  # (eyes, 3) unit
    inward: Floats64  # (eyes, 3) unit, from the outer to the inner corner
    slide: tuple[float, float]  # mm inward when closed: upper, lower lid
    raise_slide: float  # mm inward when raised
    upper_follows: tuple[float, float]  # share of the vertical gaze: up, down
    lower_follows: float
    sideways_follow: float  # share of the horizontal gaze


@njit
def turn_lids(
    state: State, rest: Floats64, lids: LidVertices, drive: Floats64, gaze: Floats64
) -> None:
    """Turn the far ends of the tissue springs of all lid vertices, and their normals.

    Adds the stiffness that holds moved folds to `state.hold`. drive: see Lids.drive; gaze: angles
    of each eye that its lids follow, to the subject's left and up [rad], shape (eyes, 2).
    """
    carried = state.carried
    normals = state.normals
    centres = lids.centres
    up = lids.up
    forward = lids.forward
    steepest_slope = 0.45  # of its way up that the fold moves back at most: it slides on the orbit
    firm_fold_turn = 0.12  # rad of turn from which the fold is held in full
    for row in range(len(lids.vertex)):
        i = lids.vertex[row]
        e = lids.eye[row]
        alpha = lids.opening[row]
        fold = lids.fold[row]
        close = min(drive[e, 0], 1.0)
        free = fold * min(alpha * drive[e, 1] + lids.lower_follows * gaze[e, 1], alpha)
        inward = max(close, drive[e, 1]) * lids.slide[1]
        angle = lids.closing[row] * close
        if lids.upper[row]:
            follows = lids.upper_follows[0 if gaze[e, 1] > 0.0 else 1]
            low = free - alpha
            free = max(fold * (lids.aperture[e] * drive[e, 2] + follows * gaze[e, 1]), low)
            inward = close * lids.slide[0] + (1.0 - close) * drive[e, 2] * lids.raise_slide
            angle -= close**8 * lids.overlap[row]  # only shut lids overlap
        free *= 1.0 - close
        angle += free
        state.hold[i] += lids.fold_hold[row] * min(abs(free) / firm_fold_turn, 1.0)
        state.hold[i] += lids.shut_hold[row] * close
        aside = gaze[e, 0] * lids.inward[e, 0] * lids.radii[e]
        inward = lids.along[row] * (inward + lids.sideways_follow * aside)
        c = np.cos(angle) - 1.0
        s = np.sin(angle)
        high = 0.0
        far = 0.0
        normal_high = 0.0
        normal_far = 0.0
        for k in range(3):
            high += (rest[i, k] - centres[e, k]) * up[e, k]
            far += (rest[i, k] - centres[e, k]) * forward[e, k]
            normal_high += normals[i, k] * up[e, k]
            normal_far += normals[i, k] * forward[e, k]
        if free > 0.0:
            high = min(high, steepest_slope * far)
        nearer = close * lids.sink[row] / max(np.sqrt(high * high + far * far), 1.0)
        for k in range(3):
            u = up[e, k]
            f = forward[e, k]
            carried[i, k] += (high * c + far * s) * u + (far * c - high * s) * f
            carried[i, k] -= nearer * ((high * (c + 1.0) + far * s) * u)
            carried[i, k] -= nearer * ((far * (c + 1.0) - high * s) * f)
            normals[i, k] += (normal_high * c + normal_far * s) * u
            normals[i, k] += (normal_far * c - normal_high * s) * f
        if inward != 0.0:
            slide_lid(carried, lids, row, inward)


@njit
def slide_lid(carried: Floats64, lids: LidVertices, row: int, inward: float) -> None:
    """Slide the far end of a lid vertex around its eyeball, `inward` mm toward the nose."""
    i = lids.vertex[row]
    e = lids.eye[row]
    deepening_share = 0.2  # of the way back: skin beside the inner corner hangs on a ligament
    side = 0.0
    far = 0.0
    for k in range(3):
        side += (carried[i, k] - lids.centres[e, k]) * lids.inward[e, k]
        far += (carried[i, k] - lids.centres[e, k]) * lids.forward[e, k]
    angle = inward / np.sqrt(side * side + far * far)
    c = np.cos(angle) - 1.0
    s = np.sin(angle)
    deeper = far * c - side * s
    if deeper < 0.0:
        deeper *= deepening_share
    for k in range(3):
        carried[i, k] += (side * c + far * s) * lids.inward[e, k]
        carried[i, k] += deeper * lids.forward[e, k]


def shut_state(lids: LidVertices, surface: SkinSurface) -> State:
    """Return a state whose `carried` has the places at which the lids of one eye aim when shut."""
    state = State.at_rest(surface)
    shut = np.zeros((1, len(LID_ACTIONS)))
    shut[:, 0] = 1.0
    turn_lids(state, surface.positions, lids, shut, np.zeros((1, 2)))
    return state
