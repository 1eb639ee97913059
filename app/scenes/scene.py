"""A scene to animate: a visible mesh, and controls that move it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..control_names.limits import ControlValues, Limits
from .drawable import Drawable, Framing


class Scene(Drawable):
    """Anything that moves the vertices of one triangle mesh.

    groups: all controls, by the heading that a panel shows. values: what each control is set to.
    actions: what controls do, where that is known. expressions: whole faces, without those of a
    side.
    """

    framing: Framing
    groups: Mapping[str, tuple[str, ...]]
    limits: Limits
    values: ControlValues
    actions: Mapping[str, str] = MappingProxyType({})
    expressions: tuple[str, ...] = ()

    def pose(self, channels: Mapping[str, float]) -> None:
        """Set controls, each cut off at its limits; what is not named becomes 0.

        Raises UserError on a name that is no control.
        """
        self.take(self.limits.pose(channels))

    def take(self, values: ControlValues) -> None:
        """Set all controls."""
        self.values = values

    def reset(self) -> None:
        """Back to rest, at once."""
        self.values = self.limits.pose({})

    def moved_by(self, name: str) -> Mapping[str, float]:
        """The lowest controls that a control moves: itself, or what a layer's control adds to.

        With each, the amount by which it changes when the control is at its most, without a sign.
        """
        return {name: 1.0}
