"""The plane of the paper's experiments (Fig. 9 and Table 1)."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np

from risorius import assets
from risorius.geometry.arrays import Floats64
from risorius.geometry.directions import unit_vectors
from risorius.geometry.read_only import read_only

from ..control_names.limits import Limits
from .drawable import Framing
from .scene import Scene


class PlaneScene(Scene):
    """The paper's plane: 154 triangles under a strong travelling sine (Fig. 9 and Table 1).

    The wave runs along the diagonals of the cells, so that every edge bends: a wave along the plane
    would leave a third of the edges straight and unsplit. `amplitude` 1 lifts the crests by HEIGHT;
    `phase` moves the wave by this number of wavelengths.
    """

    name = "plane"
    WAVES = 1.5  # wavelengths per length of the plane (chosen by eye, as HEIGHT)
    HEIGHT = 0.2  # height of crests, relative to the plane's length

    groups = MappingProxyType({"Wave": ("amplitude", "phase")})
    limits = Limits({"amplitude": (0.0, 1.0), "phase": (0.0, 100.0)})

    def __init__(self) -> None:
        plane = assets.load("plane")
        vertices = plane.vertices
        super().__init__(self.name, plane.faces, vertices)
        self.framing = Framing(vertices, vertices, read_only(vertices.mean(axis=0)))
        self.values = self.limits.pose({})
        self._length = float(np.ptp(vertices, axis=0).max())
        self._positions = vertices.copy()
        self.place(read_only(self._positions))

    def step(self, seconds: float) -> None:
        self._positions[:] = self.waved(self.rest_positions)[0]

    def waved(self, points: Floats64) -> tuple[Floats64, Floats64]:
        """Return current positions of points of the plane z = 0, and normals there, (n, 3) each."""
        height = self.values["amplitude"] * self.HEIGHT * self._length
        frequency = 2.0 * np.pi * self.WAVES / self._length
        along = points.sum(axis=1) / np.sqrt(2.0)
        angle = frequency * along - 2.0 * np.pi * self.values["phase"]
        moved = points.copy()
        normals = np.ones_like(points)
        moved[:, 2] += height * np.sin(angle)
        normals[:, :2] = -np.sqrt(0.5) * height * frequency * np.cos(angle)[:, None]
        return moved, unit_vectors(normals)

    def reset(self) -> None:
        super().reset()
        self._positions[:] = self.rest_positions
