"""Muscles: laying a rig's fibres and sphincters into a face and attaching the skin to them.

Linear muscles attach the skin around each of their fibres (fibres.py). Sphincters draw skin on an
elliptic ring to a centre, q = p* + (1 - c a)(p - p*); a centre in front of the lips makes them
protrude, and upper and lower half are separate muscles. Both bulge the skin as they contract.

Source: Kähler et al. 2001, section 4: linear muscles, sphincters, bulging.
Differs from it: skin hangs on fibre points by smooth weights instead of on the nearest ellipsoid,
and bulge acts along the skin normal. Weights were fitted to scanned expressions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .fibres import attach, build_fibre
from .landmarks import Array, Side, smoothstep
from .rig import Fibre, LinearMuscle, Muscle, Rig, RingMuscle
from .surface import Surface

RING_POINTS = 25  # corners of the line drawn for a sphincter
BULGE_SPREAD = 0.3  # of the fibre's length (fitted)
GATE_ENDS = -0.6  # of the lip side field: beyond it a gated muscle leaves the other lip alone
GATE_FULL = 1.0  # where it has its full hold; in between it fades, or corners get square
FLARE_HEIGHT = 5.0  # mm from the mouth line where the flare is three quarters of its full size
MIDLINE_FADE = 20.0  # mm across the midline over which a paired muscle yields to its twin
FACE_DEPTH = 25.0  # mm behind the outer eye corners a ring no longer reaches the skin


@dataclass(frozen=True)
class PlacedFibre:
    """One fibre in a face and its attachment to the skin, per vertex."""

    fibre: Fibre
    points: Array  # (FIBRE_POINTS, 3) mm
    weight: Array  # (V,)
    arc: Array  # (V,) place along the fibre, 0..1


@dataclass(frozen=True)
class Placed:
    """One muscle on one side of a face and its attachment to the skin, per vertex."""

    name: str  # of its control
    muscle: Muscle
    weight: Array  # (V,) strongest attachment
    steady: Array  # (V, 3) mm x weight of displacement at full activation that is linear in it
    fibres: tuple[PlacedFibre, ...] = ()
    ring: npt.NDArray[np.int32] | None = None  # skin vertices along a sphincter


def place_muscles(
    rig: Rig, surface: Surface, landmarks: Array, lip_side: Array
) -> tuple[Placed, ...]:
    """Lay all linear and ring muscles of a rig into a face, in rig order, left before right."""
    placed = []
    for muscle in rig.muscles:
        lip = _lip_gate(muscle, lip_side)
        for name, side in sides_of(muscle):
            gate = lip * _side_gate(muscle, surface.positions[:, 0], side)
            if isinstance(muscle, LinearMuscle):
                placed.append(_place_linear(name, muscle, surface, landmarks, gate, side))
            elif isinstance(muscle, RingMuscle):
                placed.append(_place_ring(name, muscle, surface, landmarks, gate, side))
    return tuple(placed)


def sides_of(muscle: Muscle) -> tuple[tuple[str, Side], ...]:
    """Control names of a muscle and the side each is on."""
    if not muscle.pair:
        return ((muscle.name, Side.LEFT),)
    return ((f"{muscle.name}_left", Side.LEFT), (f"{muscle.name}_right", Side.RIGHT))


def _side_gate(muscle: Muscle, lateral: Array, side: Side) -> Array:
    """1 on a paired muscle's own side, fading to 0 across the midline; twins add up to 1."""
    if not muscle.pair or muscle.crosses:
        return np.ones_like(lateral)
    gate: Array = np.clip(0.5 + side.sign * lateral / (2.0 * MIDLINE_FADE), 0.0, 1.0)
    return gate


def _lip_gate(muscle: Muscle, lip_side: Array) -> Array:
    """1 where a muscle may act, fading to 0 on the lip it must leave alone, shape (V,)."""
    if muscle.gate == "none":
        return np.ones_like(lip_side)
    towards = lip_side if muscle.gate == "upper_lip" else -lip_side
    return smoothstep((towards - GATE_ENDS) / (GATE_FULL - GATE_ENDS))


def _place_linear(
    name: str, muscle: LinearMuscle, surface: Surface, landmarks: Array, gate: Array, side: Side
) -> Placed:
    """Lay a linear muscle into a face and attach the skin around it."""
    fibres = []
    strongest = np.zeros(surface.vertex_count)
    steady = np.zeros((surface.vertex_count, 3))
    for fibre in muscle.fibres:
        points = build_fibre(fibre, muscle, surface, landmarks, side)
        factor = fibre.width_factor
        skin = attach(
            points, surface.positions, width=muscle.width * factor, beyond=muscle.beyond * factor
        )
        weight = fibre.weight * skin.weight * gate
        drawn = fibre.gain * fibre.convergence * muscle.contraction * skin.arc
        bulge = muscle.bulge * np.exp(-(((skin.arc - muscle.bulge_at) / BULGE_SPREAD) ** 2))
        bulge += fibre.lift
        steady += (weight * drawn)[:, None] * (skin.foot - surface.positions)
        steady += (weight * bulge)[:, None] * surface.normals
        strongest = np.maximum(strongest, weight)
        fibres.append(PlacedFibre(fibre, points, weight, skin.arc))
    return Placed(name, muscle, strongest, steady, fibres=tuple(fibres))


def _place_ring(
    name: str, muscle: RingMuscle, surface: Surface, landmarks: Array, gate: Array, side: Side
) -> Placed:
    """Lay a sphincter into a face: an elliptic ring around `shape`, drawn to `centre`."""
    x = surface.positions
    centre = muscle.centre.on(landmarks, side)
    middle = (muscle.shape or muscle.centre).on(landmarks, side)
    lateral, up, down = muscle.radii
    d = x - middle
    rho = np.hypot(d[:, 0] / lateral, np.where(d[:, 1] > 0.0, d[:, 1] / up, d[:, 1] / down))
    outside, inside = muscle.edge
    weight = np.exp(-0.5 * (np.maximum(rho - 1.0, 0.0) / outside) ** 2)
    weight *= np.exp(-0.5 * (np.maximum(1.0 - rho, 0.0) / inside) ** 2)
    at, half, fade = muscle.arc_deg
    angle = np.degrees(np.arctan2(d[:, 1], d[:, 0] * side.sign))
    off = np.abs((angle - at + 180.0) % 360.0 - 180.0)
    weight *= smoothstep(1.0 - (off - half) / max(fade, 1e-3))
    weight *= x[:, 2] > landmarks[[36, 45], 2].mean() - FACE_DEPTH
    weight *= gate
    pull = np.array(muscle.contraction) * (centre - x)
    pull += np.array(muscle.push) * (side.sign, 1.0, 1.0)
    seam = landmarks[[62, 66], 1].mean()
    across = np.exp(-((d[:, 0] / lateral) ** 2))
    pull[:, 1] += muscle.flare * np.tanh((x[:, 1] - seam) / FLARE_HEIGHT) * across
    ring = _ring_vertices(muscle, x, middle, weight, side)
    pull += muscle.bulge * surface.normals
    return Placed(name, muscle, weight, weight[:, None] * pull, ring=ring)


def _ring_vertices(
    muscle: RingMuscle, x: Array, middle: Array, weight: Array, side: Side
) -> npt.NDArray[np.int32]:
    """Skin vertices nearest to the ellipse of a sphincter, in order, for drawing it."""
    at, half, _ = muscle.arc_deg
    lateral, up, down = muscle.radii
    around = np.radians(at + np.linspace(-half, half, RING_POINTS))
    height = np.where(np.sin(around) > 0.0, up, down)
    outline = np.stack([lateral * np.cos(around) * side.sign, height * np.sin(around)], axis=1)
    attached = np.flatnonzero(weight >= 0.1 * weight.max())
    off = (x[attached, None, :2] - middle[:2] - outline) ** 2
    ring = attached[off.sum(axis=2).argmin(axis=0)].astype(np.int32)
    once: npt.NDArray[np.int32] = ring[np.insert(np.diff(ring) != 0, 0, True)]
    return once
