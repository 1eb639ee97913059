"""Teeth as hard bodies behind lips and cheeks: one elliptic arch on each jaw.

An arch is half an elliptic cylinder that stands on its bone. Its axis goes through the middle of
the molars. Its half width is half of their distance across, and its depth is the distance from them
to the incisors. Skin inside is moved out, away from the axis. The upper arch stays with the
cranium, the lower moves with the jaw. Towards the free edges of the teeth contact fades, so that a
lip can slip off.

Source: own; contact by projection as in contact.py. Anatomy: dental arches are close to half
ellipses.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64, Integers32
from ..geometry.records import joined
from . import checked
from .coordinates import FaceSpace
from .skull import RigidMotion
from .surface import SkinSurface


class Teeth(NamedTuple):
    """Skin vertices near an arch, one row for each vertex and arch."""

    vertex: Integers32  # (C,)
    lower: Flags  # (C,) moves with the mandible
    arch: Floats64  # (C, 5) mm: half width, depth, z of the axis, lowest and highest y of its teeth
    least: Floats64  # (C,) least distance from the axis, 1 = the arch

    def deepest(self, x: Floats64, mandible: RigidMotion) -> float:
        """Greatest depth of the skin `x` (V, 3) inside the teeth, minus the depth at rest [mm]."""
        if not len(self.vertex):
            return 0.0
        points = x[self.vertex]
        in_jaw = (points - mandible.shift) @ mandible.rotation
        points = np.where(self.lower[:, None], in_jaw, points)
        width, depth, axis, low, high = self.arch.T
        radius_ratio = _relative_distances(points, self.arch)
        _, height, forward = points.T
        is_met = (forward > axis) & (height > low) & (height < high)
        sunk = np.where(is_met, (self.least - radius_ratio) * np.minimum(width, depth), 0.0)
        return float(max(sunk.max(), 0.0))


def watch_teeth(parts: Any, surface: SkinSurface, space: FaceSpace) -> Teeth:
    """Find the skin that could touch the teeth: the parts whose name starts with "teeth_".

    Skin that starts inside an arch may not sink deeper.
    """
    found = [Teeth(np.zeros(0, np.int32), np.zeros(0, np.bool_), np.zeros((0, 5)), np.zeros(0))]
    given = () if parts is None else parts
    teeth_reach = 18.0  # mm around an arch in which skin is watched
    bones = ("cranium", "mandible")
    for part in checked.several("head.parts", given, ("name", "bone", "vertices")):
        if str(part.name).startswith("teeth_") and part.bone in bones:
            what = f"head.parts: {part.name}"
            points = checked.numbers(what, part.vertices, (None, 3), "(n, 3)")
            if not len(points):
                continue
            arch = _arch_of_teeth(space.to_standard(points))
            inside = _relative_distances(surface.positions, arch)
            off = surface.positions - (0.0, 0.0, arch[2])
            width, depth, _, low, high = arch
            near = inside < 1.0 + teeth_reach / min(width, depth)
            near &= off[:, 1] > low - teeth_reach
            near &= off[:, 1] < high + teeth_reach
            near &= off[:, 2] > 0.0
            watched = np.flatnonzero(near)
            count = len(watched)
            found.append(
                Teeth(
                    vertex=watched.astype(np.int32),
                    lower=np.full(count, part.bone == "mandible"),
                    arch=np.tile(arch, (count, 1)),
                    least=np.minimum(inside[watched], 1.0),
                )
            )
    return joined(found)


def _arch_of_teeth(teeth: Floats64) -> Floats64:
    """Half width, depth, z of the axis, lowest and highest y of the arch of teeth (n, 3) [mm]."""
    half_width = np.abs(teeth[:, 0]).max()
    back = teeth[np.abs(teeth[:, 0]) > 0.9 * half_width, 2].mean()
    depth = teeth[:, 2].max() - back
    low = teeth[:, 1].min()
    high = teeth[:, 1].max()
    lip_thickness = 0.5  # mm that stay between skin and a tooth
    return np.array([half_width + lip_thickness, depth + lip_thickness, back, low, high])


def _relative_distances(points: Floats64, arch: Floats64) -> Floats64:
    """Distance from the axis, relative to the arch's surface there, shape (n,).

    arch: of all points, (5,), or of each point, (n, 5), as in `Teeth`.
    """
    width, depth, axis = arch.T[:3]
    radius_ratio: Floats64 = np.hypot(points[:, 0] / width, (points[:, 2] - axis) / depth)
    return radius_ratio
