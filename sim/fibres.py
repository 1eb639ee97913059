"""Muscle fibres: polylines from bone to skin that follow the face, and how they contract.

A fibre is FIBRE_POINTS points p_0 (origin) .. p_n (insertion). Its skin is attached by arc length
t in 0..1. Contracted by c, the point at t moves to where t (1 - c) was: skin slides along the
fibre's own arc towards the origin. A muscle whose origin is no bone (frontalis: the scalp) stays
still at t = f instead, and both ends slide to it: t moves to f + (t - f)(1 - c). All fibres share
one table of displacements at SAMPLES places along them, filled again each tick; the skin reads it
by linear interpolation.

                      t = 0                t (1 - c)   t                 t = 1
    origin on bone      o-------.-------.----*<--------o-------.-----------o  insertion in the skin

Source: Kähler et al. 2001, section 4 (piecewise linear fibres, contraction q_i along the
polyline, u_i = max(c t_i, 0.01)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from .landmarks import Array, Side
from .rig import Fibre, LinearMuscle
from .surface import Surface

FIBRE_POINTS = 9  # segments of 4-10 mm: as fine as the built-in face's triangles
SAMPLES = 17  # places along a fibre where its displacement is known, to 0.2 mm
WRAP_NEIGHBOURS = 10  # vertices that say where the skin is (chosen)
LEAST_ARC = 0.01  # Kähler's 0.01: the insertion never reaches the origin


@dataclass(frozen=True)
class FibreBundle:
    """All fibres of a face, in muscle order."""

    muscle: npt.NDArray[np.int32]  # (B,) number of its muscle
    points: Array  # (B, FIBRE_POINTS, 3) mm at rest
    mandible: Array  # (B, FIBRE_POINTS) share of the mandible's motion
    contraction: Array  # (B,) share of the length lost at full activation
    fixed_at: Array  # (B,) place along the fibre that stays still
    gain: Array  # (B,)


def build_fibre(
    fibre: Fibre, muscle: LinearMuscle, surface: Surface, landmarks: Array, side: Side
) -> Array:
    """Points of one fibre [mm], shape (FIBRE_POINTS, 3), bent to the skin by the muscle's wrap."""
    along = np.linspace(0.0, 1.0, FIBRE_POINTS)[:, None]
    origin, insertion = fibre.origin.on(landmarks, side), fibre.insertion.on(landmarks, side)
    points = origin * (1.0 - along) + insertion * along
    if muscle.wrap == 0.0 or surface.vertex_count < WRAP_NEIGHBOURS:
        return points
    distance, vertices = cKDTree(surface.positions).query(points, k=WRAP_NEIGHBOURS)
    # The furthest neighbour gets no weight, so a tie for its place cannot bend a midline fibre.
    weight = (1.0 - (distance / np.maximum(distance[:, -1:], 1e-9)) ** 2) ** 2 + 1e-12
    weight /= weight.sum(axis=1, keepdims=True)
    skin = (surface.positions[vertices] * weight[:, :, None]).sum(axis=1)
    normal = (surface.normals[vertices] * weight[:, :, None]).sum(axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    correction = ((skin - points) * normal).sum(axis=1, keepdims=True) * normal
    for _ in range(2):  # single vertices must not put kinks into a fibre
        inner = 0.25 * correction[:-2] + 0.5 * correction[1:-1] + 0.25 * correction[2:]
        correction[1:-1] = inner
    bent: Array = points + muscle.wrap * correction
    return bent


@dataclass(frozen=True)
class Attachment:
    """How the skin is attached to one fibre; per vertex of the whole skin."""

    weight: Array  # (V,)
    arc: Array  # (V,) place along the fibre, 0..1
    foot: Array  # (V, 3) nearest point of the fibre


def attach(points: Array, positions: Array, *, width: float, beyond: float) -> Attachment:
    """Attach skin (V, 3) to a fibre (n, 3): Gaussian falloff across it and past its end."""
    start, segment = points[:-1], np.diff(points, axis=0)
    length = np.maximum(np.linalg.norm(segment, axis=1), 1e-9)
    arc_start = np.concatenate([[0.0], np.cumsum(length)])
    t = ((positions[:, None] - start) * segment).sum(axis=2) / length**2
    t = np.clip(t, 0.0, 1.0)
    feet = start + t[:, :, None] * segment
    squared = ((positions[:, None] - feet) ** 2).sum(axis=2)
    row, best = np.arange(len(positions)), squared.argmin(axis=1)
    foot = feet[row, best]
    arc = (arc_start[best] + t[row, best] * length[best]) / arc_start[-1]
    past = (positions - points[-1]) @ (segment[-1] / length[-1])
    across = np.maximum(squared[row, best] - past**2, 0.0)
    at_end = (arc >= 1.0 - 1e-12) & (past > 0.0)
    squared_widths = squared[row, best] / width**2
    reach = np.where(at_end, across / width**2 + (past / beyond) ** 2, squared_widths)
    weight = np.where(reach < CUT**2, np.exp(-reach), 0.0)
    return Attachment(weight, arc, foot)


CUT = 2.2  # widths at which the Gaussian (0.8 %) is cut to zero


@numba.njit(cache=True)
def contract_fibres(  # type: ignore[no-untyped-def]
    points, mandible, contraction, fixed_at, gain, activation, turn, shift, table
):
    """Fill `table` (B, SAMPLES, 3) with the displacement [mm] of the skin along each active fibre.

    The fibre's points first move with the bones (`turn`, `shift` of the mandible by their share),
    so a fibre stays fixed to its bone while the jaw is open.
    """
    samples = table.shape[1]
    count = points.shape[1]
    moved = np.empty((count, 3))
    arc = np.empty(count)
    for b in range(points.shape[0]):
        if activation[b] <= 0.0:
            continue
        for p in range(count):
            x, y, z = points[b, p, 0], points[b, p, 1], points[b, p, 2]
            w = mandible[b, p]
            for k in range(3):
                to = turn[k, 0] * x + turn[k, 1] * y + turn[k, 2] * z + shift[k]
                moved[p, k] = points[b, p, k] + w * (to - points[b, p, k])
        arc[0] = 0.0
        for p in range(1, count):
            dx = moved[p, 0] - moved[p - 1, 0]
            dy = moved[p, 1] - moved[p - 1, 1]
            dz = moved[p, 2] - moved[p - 1, 2]
            arc[p] = arc[p - 1] + np.sqrt(dx * dx + dy * dy + dz * dz)
        kept = max(1.0 - contraction[b] * activation[b], LEAST_ARC)
        fixed = fixed_at[b] * arc[count - 1]
        # `there` and `here` only grow, so both find their segment by walking on.
        near, far = 1, 1
        for s in range(samples):
            here = arc[count - 1] * s / (samples - 1)
            there = fixed + kept * (here - fixed)
            while near < count - 1 and arc[near] < there:
                near += 1
            while far < count - 1 and arc[far] < here:
                far += 1
            u = (there - arc[near - 1]) / max(arc[near] - arc[near - 1], 1e-12)
            t = (here - arc[far - 1]) / max(arc[far] - arc[far - 1], 1e-12)
            for k in range(3):
                to = moved[near - 1, k] + u * (moved[near, k] - moved[near - 1, k])
                at = moved[far - 1, k] + t * (moved[far, k] - moved[far - 1, k])
                table[b, s, k] = gain[b] * (to - at)
