"""Least squares with prices and limits: few unknowns differ from zero (the lasso).

Source: Friedman et al. 2007, "Pathwise coordinate optimization"; Tibshirani 1996.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64


class Lasso(NamedTuple):
    """Find x with low <= changed + x <= high and least x G x - 2 r x + 2 price |changed + x|."""

    gram: Floats64  # (C, C)
    right: Floats64  # (C,)
    price: Floats64  # (C,)
    changed: Floats64  # (C,) change of each control so far
    low: Floats64  # (C,)
    high: Floats64  # (C,)

    def minimise(self, usable: Flags) -> Floats64:
        """Move one control after another to its minimum, until none moves any more; return x, (C,).

        usable: flags of controls, shape (C,); all others return to their first values.
        """
        total = self.changed.copy()
        downhill = self.right.copy()
        downhill += self.gram[:, ~usable] @ total[~usable]
        total[~usable] = 0.0
        most_sweeps = 60  # most sweeps through all controls
        sweep_tolerance = 1e-4  # a change that counts as none, between sweeps
        for _ in range(most_sweeps):
            farthest = 0.0
            for c in np.flatnonzero(usable):
                slope = self.gram[c, c]
                to = total[c] + downhill[c] / slope
                to = np.sign(to) * max(abs(to) - self.price[c] / slope, 0.0)
                by = min(max(to, self.low[c]), self.high[c]) - total[c]
                if by:
                    total[c] += by
                    downhill -= by * self.gram[c]
                    farthest = max(farthest, abs(by))
            if farthest < sweep_tolerance:
                break
        return total - self.changed

    def change(self, usable: Flags) -> Floats64:
        """Return the change of each control, so far and to the minimum, (C,)."""
        return self.changed + self.minimise(usable)

    def cost(self, usable: Flags) -> float:
        """Return the least value of the sum with only these controls, up to a constant."""
        x = self.minimise(usable)
        spent = self.price @ np.abs(self.changed + x)
        squares = x @ self.gram @ x
        return float(squares - 2.0 * self.right @ x + 2.0 * spent)
