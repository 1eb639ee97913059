"""The cuts of hair that a person may have. All numbers are chosen by eye."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ...smooth import Values
from .locks import Look


@dataclass(frozen=True)
class Cut:
    """How hair is cut and combed.

    hem: heights of its ends [mm] over angles around the head [deg], ((angle, height), ...).
    hangs: whether it hangs over the ears, past which one sees its inner side.
    longest: that a lock is [mm].
    volume: how far the outermost locks stand off the head [mm].
    opening: angles of the face's sides [deg], at the chin and at the brows, that stay bare.
    parting: x of the line on top of the head [mm] from which hair is combed to both sides.
    brushed: how far hair in front is brushed back instead of aside, 0 to 1.
    wave: how far locks swing aside [mm], and on which length [mm].
    count: of locks.
    look: of each.
    """

    hem: tuple[tuple[float, float], ...]
    hangs: bool
    longest: float
    volume: float
    opening: tuple[float, float]
    parting: float
    brushed: float
    wave: tuple[float, float]
    count: int
    look: Look

    def end(self, angle: Values) -> Values:
        """Height of the hem [mm] at angles around the head [rad], shape (n,)."""
        around, heights = np.array(self.hem).T
        return np.asarray(np.interp(np.degrees(np.abs(angle)), around, heights))


CUTS: Mapping[str, Cut | None] = MappingProxyType(
    {
        "cropped": None,  # as it is painted on the scalp
        "bob": Cut(
            hem=((50, -90), (85, -95), (120, -100), (180, -103)),
            hangs=True,
            longest=300.0,
            volume=9.0,
            opening=(56.0, 60.0),
            parting=22.0,
            brushed=0.0,
            wave=(1.0, 60.0),
            count=480,
            look=Look((9.0, 15.0), 0.25, 16),
        ),
        "waves": Cut(
            hem=((50, -58), (85, -66), (120, -84), (180, -92)),
            hangs=True,
            longest=300.0,
            volume=11.0,
            opening=(64.0, 64.0),
            parting=-24.0,
            brushed=0.0,
            wave=(3.0, 62.0),
            count=480,
            look=Look((9.0, 15.0), 0.25, 16),
        ),
        "short": Cut(
            hem=((55, 20), (75, 24), (85, 36), (120, 32), (134, -20), (150, -74), (180, -80)),
            hangs=False,
            longest=42.0,
            volume=7.0,
            opening=(50.0, 62.0),
            parting=30.0,
            brushed=1.0,
            wave=(0.8, 30.0),
            count=1000,
            look=Look((6.0, 10.0), 0.2, 6),
        ),
    }
)
