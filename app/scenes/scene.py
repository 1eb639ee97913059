"""A scene to animate: a visible mesh, and controls that move it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..control_names.limits import ControlValues, Limits
from .drawable import Drawable, Framing


class Scene(Drawable):
    """Anything that moves the vertices of one triangle mesh.

    groups: all controls, by headings of a panel. values: the set value of each control.
    actions: effects of controls, if known. expressions: whole faces, without one-sided ones.
    """

    framing: Framing
    groups: Mapping[str, tuple[str, ...]]
    limits: Limits
    values: ControlValues
    actions: Mapping[str, str] = MappingProxyType({})
    expressions: tuple[str, ...] = ()

    def pose(self, channels: Mapping[str, float]) -> None:
        """Set controls, each cut off at its limits; unnamed ones become 0.

        Raises UserError for an unknown name.
        """
        self.take(self.limits.pose(channels))

    def take(self, values: ControlValues) -> None:
        """Set all controls."""
        self.values = values

    def reset(self) -> None:
        """Return to rest at once."""
        self.values = self.limits.pose({})

    def moved_by(self, name: str) -> Mapping[str, float]:
        """The lowest controls that a control moves: itself, or targets of a layer's control.

        With each, the amount by which it changes when the control is at its most, without a sign.
        """
        return {name: 1.0}
