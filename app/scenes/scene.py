"""A scene to animate: a visible mesh, and controls that move it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..control_names.limits import ControlValues, Limits
from .drawable import Drawable, Framing


class Scene(Drawable):
    """A mesh whose vertices are moved by controls.

    groups: heading of a panel -> controls. values: the current value of each control.
    actions: control -> its effect in words, if known. expressions: controls that show a whole face.
    """

    framing: Framing
    groups: Mapping[str, tuple[str, ...]]
    limits: Limits
    values: ControlValues
    actions: Mapping[str, str] = MappingProxyType({})
    expressions: tuple[str, ...] = ()

    def pose(self, channels: Mapping[str, float]) -> None:
        """Set controls, each clamped to its limits; all other controls become 0.

        Raises UserError for an unknown name.
        """
        self.set_controls(self.limits.pose(channels))

    def set_controls(self, values: ControlValues) -> None:
        """Set all controls."""
        self.values = values

    def reset(self) -> None:
        """Return to rest at once."""
        self.values = self.limits.pose({})

    def moved_by(self, name: str) -> Mapping[str, float]:
        """Return the controls of the lowest layer that a control moves, and their greatest changes.

        A control of the lowest layer moves only itself. A change is an absolute value, at the
        highest value of the control.
        """
        return {name: 1.0}
