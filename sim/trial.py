"""One face under many rigs: for fitting, where a muscle changes and everything else stays.

To build a dense face takes seconds, and most of them go into muscles that are where they were.

Source: own.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from .anatomy import Anatomy, build_anatomy, with_muscles
from .face import Simulation
from .landmarks import Array
from .muscles import PlacedMuscle, place_muscles
from .rig import Muscle, Rig


class Trial:
    """A head whose muscles can be exchanged; jaw, eyes and tissue stay those of its own rig."""

    def __init__(self, head: Any) -> None:
        self.anatomy: Anatomy = build_anatomy(head)
        """The head at rest with its own rig."""
        self._placed: dict[Muscle, tuple[PlacedMuscle, ...]] = {}

    @property
    def rig(self) -> Rig:
        """The head's own rig."""
        return self.anatomy.rig

    @property
    def areas(self) -> Array:
        """Skin that belongs to each vertex [mm2], shape (V,)."""
        return self.anatomy.surface.areas

    def simulation(self, rig: Rig) -> Simulation:
        """The face with the muscles of a rig, which must be those of its own by name and kind."""
        anatomy, placed = self.anatomy, list[PlacedMuscle]()
        for muscle in rig.muscles:
            if muscle not in self._placed:
                alone = replace(rig, muscles=(muscle,))
                known, side = anatomy.landmarks, anatomy.lip_side
                self._placed[muscle] = place_muscles(alone, anatomy.surface, known, side)
            placed += self._placed[muscle]
        return Simulation(with_muscles(anatomy, rig, tuple(placed)))
