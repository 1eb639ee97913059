"""Time stepping: a frame is cut into ticks, a tick into substeps of semi-implicit Euler.

    tick      at most 1/120 s: activations advance, bones, lids and muscle pulls are placed anew
    substep   a quarter of it, at most 1/480 s: forces, velocity, position, contact

A frame of any length is divided exactly, so there is no remainder to carry and no jitter at odd
frame rates. Masses are raised where the longest substep would be unstable (tissue.py), hence
every length up to it is stable too. Damping is implicit and per vertex: near critical for the
springs that hold the vertex, because one constant leaves overshoot wherever a muscle stiffens the
skin.

Source: Kähler et al. 2001 use an explicit Verlet scheme; step, mass scaling and damping were
measured here.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from .contact import keep_lips_apart, keep_out_of_eyeballs, seal_forces
from .springs import edge_forces
from .tissue import tissue_forces

LONGEST_FRAME = 1.0 / 20.0  # s, the longest `dt` a caller may ask for
LONGEST_TICK = 1.0 / 120.0  # s: an eighth of a blink
SUBSTEPS = 4  # per tick
LONGEST_SUBSTEP = LONGEST_TICK / SUBSTEPS
LIP_PASSES = 2  # averaged projections need a second pass where lips are pressed hard
ROUNDING = 0.02  # ticks: 1/60 s given as 0.0167 is still two ticks, not three
FASTEST = 5000.0  # mm/s per axis; a face never reaches it, a vertex thrown by the caller may


def ticks_in(dt: float) -> int:
    """Into how many ticks a frame of `dt` [s] is divided."""
    return max(1, math.ceil(dt / LONGEST_TICK - ROUNDING))


@numba.njit(cache=True)
def advance(  # type: ignore[no-untyped-def]
    substeps, h, x, v, rest, carried, normals, mass, base_damping, damping_ratio,
    tangential, normal, hold, pull,
    edges, rest_length, stiffness, shear, stiffening, strain_limit,
    lip_lower, lip_upper, lip_share, lip_gap, lip_seal, lip_averaging, seal_strength,
    eye_vertex, eye_centre, eye_distance,
    offset, force, gain, kept, move,
):  # fmt: skip
    """Advance positions `x` and velocities `v` (V, 3) by `substeps` of length `h` [s] in place."""
    for i in range(len(x)):
        stiff = (tangential[i] + hold[i]) / mass[i]
        kept[i] = 1.0 / (1.0 + h * (base_damping + 2.0 * damping_ratio * np.sqrt(stiff)))
        gain[i] = kept[i] * h / mass[i]
    for _ in range(substeps):
        tissue_forces(x, carried, normals, tangential, normal, hold, pull, offset, force)
        edge_forces(
            x, offset, edges, rest_length, stiffness, shear, stiffening, strain_limit, force
        )
        seal_forces(x, rest, lip_lower, lip_upper, lip_share, lip_seal, seal_strength, force)
        for i in range(len(x)):
            for k in range(3):
                speed = kept[i] * v[i, k] + gain[i] * force[i, k]
                v[i, k] = min(max(speed, -FASTEST), FASTEST)
                x[i, k] += h * v[i, k]
        for _ in range(LIP_PASSES):
            keep_lips_apart(
                x, v, rest, mass, lip_lower, lip_upper, lip_share, lip_gap, lip_averaging, move
            )
        keep_out_of_eyeballs(x, v, eye_vertex, eye_centre, eye_distance)
