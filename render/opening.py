"""Openings in a skin, between lids or lips, through which light reaches the parts behind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import moderngl
import numpy as np

from ..geometry.arrays import Floats64
from .camera import PlacedView
from .programs import write_uniform


@dataclass(frozen=True, eq=False)
class Opening:
    """An opening in a skin, and the position of a part in it.

    - rim: points around the opening in the world, (RIM_POINTS, 3), clockwise seen from outside,
      with the upper half first.
    - is_filled: whether the part reaches the rim, like an eyeball between lids. Otherwise the part
      lies behind the rim, like teeth behind lips.
    """

    RIM_POINTS: ClassVar[int] = 12

    rim: Floats64
    is_filled: bool

    @property
    def defines(self) -> tuple[str, str]:
        """The defines of opening.glsl for the kind of the opening, and for the number of points."""
        kind = "FILLED" if self.is_filled else "BEHIND"
        return kind, RIM_DEFINE

    def set_uniforms(self, program: moderngl.Program, view: PlacedView) -> None:
        """Set the uniforms that place the opening in a view."""
        if self.is_filled:
            seen = np.column_stack([self.rim, np.ones(len(self.rim))]) @ view.world_to_view
            _set_lids(program, seen[:, :3])
        else:
            set_rim(program, "rim", self.rim, view)


RIM_DEFINE = f"RIM_POINTS {Opening.RIM_POINTS}"


def set_rim(program: moderngl.Program, name: str, rim: Floats64, view: PlacedView) -> None:
    """Set a uniform to a rim (`Opening.rim`) in view space."""
    seen = np.column_stack([rim, np.ones(len(rim))]) @ view.world_to_view
    write_uniform(program, name, seen[:, :3])


def _set_lids(program: moderngl.Program, rim: Floats64) -> None:
    """Set both halves of a rim, in view space, as cubics over the line between the corners."""
    half = len(rim) // 2
    first = rim[0]
    last = rim[half]
    centre = 0.5 * (first + last)
    width = max(float(np.linalg.norm(last - first)), 1e-9)
    along = (last - first) / width
    off = rim - centre
    outward = np.cross(np.roll(off, -1, axis=0), off).sum(axis=0)
    up = np.cross(outward, along)
    up /= max(float(np.linalg.norm(up)), 1e-9)
    for name, axis in (("opening_x", along), ("opening_y", up)):
        write_uniform(program, name, np.append(axis, -axis @ centre) / (0.5 * width))
    x = off @ along / (0.5 * width)
    y = off @ up / (0.5 * width)
    halves = {"upper_lid": range(half + 1), "lower_lid": (*range(half, len(rim)), 0)}
    for name, points in halves.items():
        at = list(points)
        powers = np.vander(x[at], 4, increasing=True)
        write_uniform(program, name, np.linalg.lstsq(powers, y[at])[0])
