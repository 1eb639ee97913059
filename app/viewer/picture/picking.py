"""What lies under the mouse: a point of the skin, and the muscle nearest to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import render
from risorius.sim.landmarks import polyline_distance

FloatArray = npt.NDArray[np.float64]
MUSCLE_REACH = 14.0  # [mm] from a fibre within which a click on the skin means its muscle
# A ray that meets an edge must not slip between its two triangles by the last bit.
ROUNDING = 1e-9  # of a triangle; [mm] too


@dataclass(frozen=True)
class Ray:
    """What the camera sees in one pixel."""

    origin: FloatArray
    direction: FloatArray

    @classmethod
    def through(
        cls, camera: render.OrbitCamera, viewport: render.Rectangle, place: tuple[float, float]
    ) -> Ray:
        """The ray of `place` [pixels from the lower left corner of the surface]."""
        left, bottom, width, height = viewport
        to_clip = np.asarray(camera.view_matrix() @ camera.projection_matrix(width / height))
        x = 2.0 * (place[0] - left) / width - 1.0
        y = 2.0 * (place[1] - bottom) / height - 1.0
        ends = np.array([[x, y, -1.0, 1.0], [x, y, 1.0, 1.0]]) @ np.linalg.inv(to_clip)
        near, far = ends[:, :3] / ends[:, 3:]
        return cls(near, (far - near) / np.linalg.norm(far - near))

    def at_depth_of(self, point: FloatArray, axis: FloatArray) -> FloatArray:
        """Where the ray meets the plane through `point` across `axis` (the line of sight)."""
        along = float((point - self.origin) @ axis) / float(self.direction @ axis)
        met: FloatArray = self.origin + along * self.direction
        return met


def skin_under(
    ray: Ray, positions: FloatArray, faces: npt.NDArray[Any], *, from_outside: bool = True
) -> FloatArray | None:
    """The nearest point of the mesh that the ray meets, or None; `from_outside` or either side.

    Möller and Trumbore 1997, for all triangles at once whose corners lie around the ray.
    """
    axes = np.linalg.svd(ray.direction[None])[2][1:]  # across the ray
    for aside in ((positions - ray.origin) @ axis for axis in axes):
        corners = aside[faces]
        faces = faces[(corners.min(axis=1) < ROUNDING) & (corners.max(axis=1) > -ROUNDING)]
    a, b, c = (positions[faces[:, corner]] for corner in range(3))
    ab, ac = b - a, c - a
    across = np.cross(ray.direction, ac)
    volume = (ab * across).sum(axis=1)
    met = (volume if from_outside else np.abs(volume)) > 1e-12
    volume = np.where(met, volume, 1.0)
    from_a = ray.origin - a
    u = (from_a * across).sum(axis=1) / volume
    turned = np.cross(from_a, ab)
    v = (turned @ ray.direction) / volume
    distance = (ac * turned).sum(axis=1) / volume
    inside = (u >= -ROUNDING) & (v >= -ROUNDING) & (u + v <= 1.0 + ROUNDING)
    hit = met & inside & (distance > 0.0)
    if not hit.any():
        return None
    point: FloatArray = ray.origin + distance[hit].min() * ray.direction
    return point


def muscle_at(point: FloatArray, fibres: Mapping[str, Sequence[FloatArray]]) -> str | None:
    """The muscle whose fibres come nearest to a point of the skin, or None if all are far."""
    nearest = {  # its end once more: a fibre may be a single point
        name: min(
            float(polyline_distance(point[None], np.vstack([line, line[-1:]]))[0]) for line in lines
        )
        for name, lines in fibres.items()
        if lines
    }
    if not nearest:
        return None
    name = min(nearest, key=lambda each: nearest[each])
    return name if nearest[name] <= MUSCLE_REACH else None
