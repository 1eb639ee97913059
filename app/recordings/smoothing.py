"""Smoothing of channels that tremble: the one-euro filter, slow where a face is still.

Off unless asked for, since muscles filter by themselves. It costs time and height: a channel comes
15 to 45 ms later, and a short peak loses up to 14 % (measured on a phone's take).

Source: Casiez, Roussel, Vogel 2012, "1 Euro Filter: A Simple Speed-based Low-pass Filter for Noisy
Input in Interactive Systems".
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from .calibration import ANGLES
from .take import Array, Take

STILL = 1.5  # [Hz] that pass while nothing moves
OPENING = 3.0  # [Hz] more for each unit a second; a blink has five, and passes
SPEED = 1.0  # [Hz] that pass of the speed itself
DEGREES = 30.0  # of an angle that count as one unit


def smoothed(take: Take) -> Take:
    """The take with each channel filtered."""
    units = np.array([DEGREES if name in ANGLES else 1.0 for name in take.channels])
    rows = np.stack(list(take.channels.values()), axis=1)  # (T, channels)
    speeds = np.zeros(len(units))
    steps = np.diff(take.times).tolist()
    for (before, row), seconds in zip(pairwise(rows), steps, strict=True):
        moved = row - before
        speeds += _share(SPEED, seconds) * (moved / units / seconds - speeds)
        row[:] = before + _share(STILL + OPENING * np.abs(speeds), seconds) * moved
    return replace(take, channels=dict(zip(take.channels, rows.T.copy(), strict=True)))


def _share(cut_off: float | Array, seconds: float) -> Array:
    """How far a low-pass filter goes towards the new value in a frame."""
    turn = 2.0 * math.pi * seconds * np.asarray(cut_off)
    return turn / (turn + 1.0)
