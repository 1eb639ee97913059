"""Smoothing of channels that tremble: the one-euro filter, slow where a face is still.

Off unless asked for, since muscles filter by themselves. It costs time and height: a channel comes
15 to 45 ms later, and a short peak loses up to 14 % (measured on a phone's take).

Source: Casiez, Roussel, Vogel 2012, "1 Euro Filter: A Simple Speed-based Low-pass Filter for Noisy
Input in Interactive Systems".
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from .calibration import ANGLES
from .take import Array, Take

STILL = 1.5  # [Hz] that pass while nothing moves
OPENING = 3.0  # [Hz] more for each unit a second; a blink has five, and passes
SPEED = 1.0  # [Hz] that pass of the speed itself
DEGREES = 30.0  # of an angle that count as one unit


class OneEuro:
    """The filter of one face: give it frame after frame."""

    def __init__(self) -> None:
        self._names: tuple[str, ...] = ()
        self._units: Array = np.empty(0)
        self._values: Array = np.empty(0)
        self._speeds: Array = np.empty(0)

    def frame(self, channels: Mapping[str, float], seconds: float) -> dict[str, float]:
        """The channels of the next frame, smoothed; `seconds` have passed since the last one.

        Frames that begin to name other channels begin anew.
        """
        names = tuple(channels)
        if names != self._names:
            self._names = names
            self._begin(names)
        smooth = self.step(np.fromiter(channels.values(), np.float64, len(names)), seconds)
        return dict(zip(names, smooth.tolist(), strict=True))

    def take(self, take: Take) -> Take:
        """The whole take, smoothed."""
        self._begin(tuple(take.channels))
        rows = np.stack(list(take.channels.values()), axis=1)  # (T, channels)
        for row, seconds in zip(rows, np.diff(take.times, prepend=0.0).tolist(), strict=True):
            row[:] = self.step(row, seconds)
        return replace(take, channels=dict(zip(take.channels, rows.T.copy(), strict=True)))

    def _begin(self, names: tuple[str, ...]) -> None:
        self._units = np.array([DEGREES if name in ANGLES else 1.0 for name in names])
        self._values, self._speeds = np.empty(0), np.zeros(len(names))

    def step(self, values: Array, seconds: float) -> Array:
        """The next values, shape (channels,)."""
        if not len(self._values):
            self._values = values.copy()
        elif seconds > 0.0:
            moved = values - self._values
            self._speeds += _share(SPEED, seconds) * (moved / self._units / seconds - self._speeds)
            cut_off = STILL + OPENING * np.abs(self._speeds)
            self._values = self._values + _share(cut_off, seconds) * moved
        return self._values


def _share(cut_off: float | Array, seconds: float) -> Array:
    """How far a low-pass filter goes towards the new value in a frame."""
    turn = 2.0 * math.pi * seconds * np.asarray(cut_off)
    return turn / (turn + 1.0)
