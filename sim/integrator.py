"""Time stepping: a frame is cut into ticks, a tick into substeps of semi-implicit Euler.

    tick      at most 1/120 s: activations advance, bones, lids and muscle pulls are placed anew
    substep   a third of it, at most 1/360 s: forces, velocity, position, contact

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

from .contact import hold_lips, keep_lips_apart, keep_out_of_eyeballs
from .springs import edge_forces
from .tissue import tissue_forces

LONGEST_FRAME = 1.0 / 20.0  # s, the longest `dt` a caller may ask for
LONGEST_TICK = 1.0 / 120.0  # s: an eighth of a blink
SUBSTEPS = 3  # per tick; four cost a quarter more and need hardly less added mass
LONGEST_SUBSTEP = LONGEST_TICK / SUBSTEPS
LIP_PASSES = 2  # averaged projections need a second pass where lips are pressed hard
ROUNDING = 0.02  # ticks: 1/60 s given as 0.0167 is still two ticks, not three
FASTEST = 5000.0  # mm/s per axis; a face never reaches it, a vertex thrown by the caller may


def ticks_in(dt: float) -> int:
    """Into how many ticks a frame of `dt` [s] is divided."""
    return max(1, math.ceil(dt / LONGEST_TICK - ROUNDING))


@numba.njit(cache=True)
def advance(  # type: ignore[no-untyped-def]
    state, substeps, h, rest, mass, tissue, edges, lips, grip, eyes
):
    """Advance a face by `substeps` of length `h` [s]: the list of all forces and constraints."""
    damp(state, h, mass, tissue)
    for _ in range(substeps):
        tissue_forces(state, tissue)
        edge_forces(state, edges)
        accelerate(state)
        hold_lips(state, rest, mass, lips, grip, h)
        move(state, h)
        for _ in range(LIP_PASSES):
            keep_lips_apart(state, rest, mass, lips, grip.overlap)
        keep_out_of_eyeballs(state, eyes)


@numba.njit(cache=True)
def damp(state, h, mass, tissue):  # type: ignore[no-untyped-def]
    """Prepare what damping leaves of a velocity, and what a force adds to it, for this tick."""
    for i in range(len(mass)):
        rate = np.sqrt((tissue.tangential[i] + state.hold[i]) / mass[i])
        damping = tissue.damping + 2.0 * tissue.damping_ratio * rate
        state.kept[i] = 1.0 / (1.0 + h * damping)
        state.gain[i] = state.kept[i] * h / mass[i]


@numba.njit(cache=True)
def accelerate(state):  # type: ignore[no-untyped-def]
    """First half of semi-implicit Euler: velocities from forces and damping."""
    v, force = state.v, state.force
    for i in range(len(v)):
        kept, gain = state.kept[i], state.gain[i]
        for k in range(3):
            v[i, k] = kept * v[i, k] + gain * force[i, k]


@numba.njit(cache=True)
def move(state, h):  # type: ignore[no-untyped-def]
    """Second half: positions from the new velocities."""
    x, v = state.x, state.v
    for i in range(len(x)):
        for k in range(3):
            v[i, k] = min(max(v[i, k], -FASTEST), FASTEST)
            x[i, k] += h * v[i, k]
