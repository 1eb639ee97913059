"""The controls that a scene has, poses of them, and what overrides them from outside."""

from __future__ import annotations

from collections.abc import Mapping

from risorius.assets.loading import read_words
from risorius.sim.layers import BOTH_SIDES

from ...controls.mirror import parted
from ...errors import counted
from ...scenes import FaceScene, Scene, clamped


class SceneControls:
    """Every control of every layer (muscles, jaw, gaze, action units, expressions, visemes).

    limits: the lowest and highest value of each. muscles: the lowest ones, to which all others add
    up; all where a scene does not tell. groups: title -> controls, the highest layer first; those
    of both sides of a muscle are found beside its sides.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.limits = scene.limits
        own = scene.simulation.controls if isinstance(scene, FaceScene) else self.limits
        self.muscles = frozenset(own)
        order = [*read_words()["order"], *scene.groups]
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

    def moved_by(self, values: Mapping[str, float]) -> frozenset[str]:
        """The lowest controls that a pose moves."""
        active = (name for name, value in values.items() if value)
        return frozenset().union(*map(self._scene.moved_by, active))


class LiveOverride:
    """Where a live face has controls, and by what share of 0 (not at all) to 1 (all the way)."""

    def __init__(self) -> None:
        self._controls: Mapping[str, float] = {}
        self._share = 0.0

    def take(self, controls: Mapping[str, float], share: float) -> None:
        """Override these controls from now on, and no others."""
        self._controls, self._share = controls, share

    @property
    def is_on(self) -> bool:
        """Whether anything is overridden."""
        return self._share > 0.0

    def over(
        self, values: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
    ) -> dict[str, float]:
        """The values, overridden within limits; a control that has no value is left out."""
        led = dict(values)
        for name, wanted in self._controls.items() if self._share else ():
            if name in values:
                low, high = limits[name]
                led[name] += self._share * (min(max(wanted, low), high) - values[name])
        return led


def change_of(before: Mapping[str, float], after: Mapping[str, float]) -> str:
    """What was set by hand, in words; what is not in `before` was 0."""
    names = sorted(name for name, value in after.items() if value != before.get(name, 0.0))
    labels = {name if len(names) == 1 else parted(name)[0] for name in names}
    if len(labels) != 1:
        return f"Set {counted(len(names), 'control')}"
    return f"Set {labels.pop().replace('_', ' ')} to {after[names[0]]:.2f}"
