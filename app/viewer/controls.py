"""The controls that a scene has, and poses of them: what needs neither time nor a script."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain

import numpy as np

from risorius.sim.layers import BOTH_SIDES

from ..controls.mirror import twin_of
from ..controls.vocabulary import filters
from ..scenes import Scene, clamped

RANDOM_SHARE = 0.25  # of the muscles that a random pose moves
RANDOM_STRENGTH = 0.8  # most of their range


class Controls:
    """Every control of every layer (muscles, jaw, gaze, action units, expressions, visemes).

    limits: the lowest and highest value of each. muscles: the lowest ones, to which all others add
    up; all where a scene does not tell. groups: title -> controls, the highest layer first; those
    of both sides of a muscle are found beside its sides.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.limits = scene.limits
        simulation = getattr(scene, "simulation", None)
        self.muscles = frozenset(simulation.controls if simulation is not None else self.limits)
        order = [*chain(*filters().values()), *scene.groups]
        self.groups = {
            title: scene.groups[title]
            for title in dict.fromkeys(order)
            if title in scene.groups and title != BOTH_SIDES
        }

    def pose(self, values: Mapping[str, float]) -> dict[str, float]:
        """A value for each control, within its limits; 0 where none is given."""
        return {**dict.fromkeys(self.limits, 0.0), **clamped(self.limits, values)}

    def alone(self, name: str) -> dict[str, float]:
        """This control at its most, and no other."""
        return self.pose({name: self.limits[name][1]})

    def random(self, generator: np.random.Generator) -> dict[str, float]:
        """A few muscles of each group by chance, both sides alike; layers stay at zero."""
        pose = self.pose({})
        for names in self._scene.groups.values():
            for name in names:
                is_muscle = name in self.muscles and self.limits[name][0] == 0.0
                if is_muscle and twin_of(name) <= name and generator.random() < RANDOM_SHARE:
                    value = RANDOM_STRENGTH * generator.random() * self.limits[name][1]
                    pose[name] = pose[twin_of(name)] = value
        return pose

    def moved_by(self, values: Mapping[str, float]) -> frozenset[str]:
        """The lowest controls that a pose moves."""
        active = (name for name, value in values.items() if value)
        return frozenset().union(*map(self._scene.moved_by, active))
