"""One triangle mesh of a scene over time, for writers of files. Lengths are millimetres."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from risorius import refine
from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.normals import vertex_normals
from risorius.geometry.transforms import moved_points

METRES = 0.001  # in a millimetre; animation programs read plain numbers as metres


@dataclass(frozen=True)
class MovingSurface:
    """One triangle mesh of a clip over all of its N frames; vertices and triangles never change.

    name: "skin", or the name of the part; unique within the clip.
    rest: vertices at rest, shape (V, 3), float64.
    faces: counter-clockwise from the visible side, shape (F, 3), int32.
    shapes: vertices in each frame, before `matrices`, shape (N, V, 3), float32; None: as `rest`.
    matrices: motion of the whole surface in each frame, shape (N, 4, 4), float64; None: no motion.
    uv, face_uv: texture coordinates, shape (U, 2), and their number at each corner, shape (F, 3).
    colours: sRGB 0..1 of the vertices, shape (V, 3), float32; None with a texture.
    shine: 0 dull, 1 wet.
    """

    name: str
    rest: Floats64
    faces: Integers32
    shapes: Floats32 | None = None
    matrices: Floats64 | None = None
    uv: Floats32 | None = None
    face_uv: Integers32 | None = None
    colours: Floats32 | None = None
    shine: float = 0.0

    def at(self, frame: int) -> Floats64:
        """Return the vertices in a frame, shape (V, 3)."""
        points = self.rest if self.shapes is None else self.shapes[frame].astype(np.float64)
        if self.matrices is None:
            return points
        return moved_points(self.matrices[frame], points)

    def normals_of(self, points: Floats64, frame: int | None) -> Floats64:
        """Return unit normals of vertices at `points` in a frame, shape (V, 3) each.

        frame: number of the frame, None for the surface at rest.
        """
        return vertex_normals(points, self.faces)

    def carried(self, values: Floats64) -> Floats64:
        """Carry values of the scene's mesh, shape (n,), to these vertices, (V,)."""
        return values

    @property
    def source(self) -> Integers32:
        """The triangle of the scene's mesh that each triangle is part of, shape (F,)."""
        return np.arange(len(self.faces), dtype=np.int32)


@dataclass(frozen=True)
class RefinedSurface(MovingSurface):
    """A refined surface, with the normals of its refiner.

    rest_normals: normals at rest, shape (V, 3). normals: normals in each frame, shape (N, V, 3).
    sources: the triangle of the scene's mesh that contains each triangle, shape (F,).
    origins: where each vertex lies on the scene's mesh. refiner: makes these triangles from the
    scene's mesh.
    """

    rest_normals: Floats32 = field(kw_only=True)
    normals: Floats32 = field(kw_only=True)
    sources: Integers32 = field(kw_only=True)
    origins: refine.Origins = field(kw_only=True)
    refiner: refine.Refiner = field(kw_only=True)

    def normals_of(self, points: Floats64, frame: int | None) -> Floats64:
        """Return the refiner's normals, shape (V, 3)."""
        normals = self.rest_normals if frame is None else self.normals[frame]
        return normals.astype(np.float64)

    def carried(self, values: Floats64) -> Floats64:
        """Carry values of the scene's mesh, shape (n,), to these vertices, (V,)."""
        return np.asarray((values[self.origins.vertices] * self.origins.weights).sum(axis=1))

    @property
    def source(self) -> Integers32:
        """The triangle of the scene's mesh that each triangle is part of, shape (F,)."""
        return self.sources
