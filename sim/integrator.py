"""Time stepping: a frame is cut into ticks, a tick into substeps of semi-implicit Euler.

    tick      at most 1/60 s: bones, lids and muscle pulls are placed for the activations that hold
              in its middle, which makes the lag second order
    substep   at most 1/300 s: forces, velocity, position, contact

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

LONGEST_FRAME = 1.0 / 20.0  # s, the longest `dt` a caller may ask for
LONGEST_TICK = 1.0 / 60.0  # s: half as long is no more exact than the middle of this
# s: skin is 24 % heavier in sum than its own mass; 14 % at 1/360, a fifth dearer
LONGEST_SUBSTEP = 1.0 / 300.0
ROUNDING = 0.02  # parts: 1/60 s given as 0.0167 is still one tick, not two


def ticks_in(dt: float) -> int:
    """Into how many ticks a frame of `dt` [s] is divided."""
    return parts(dt, LONGEST_TICK)


def substeps_in(tick: float) -> int:
    """Into how many substeps a tick [s] is divided."""
    return parts(tick, LONGEST_SUBSTEP)


def parts(whole: float, longest: float) -> int:
    """Into how many equal parts, none longer than `longest`, a time [s] is divided."""
    return max(1, math.ceil(whole / longest - ROUNDING))
