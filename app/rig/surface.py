"""A triangle mesh of a scene over time, from which files are written; lengths are in [mm]."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from risorius import refine
from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.normals import vertex_normals
from risorius.geometry.transforms import moved_points

METRES_PER_MILLIMETRE = 0.001  # metres in a millimetre; animation programs read numbers as metres


@dataclass(frozen=True)
class MovingSurface:
    """A triangle mesh over the N frames of a clip; its topology is constant.

    name: "skin", or the name of the part; unique within the clip.
    rest: vertices at rest, (V, 3), float64.
    faces: vertex indices, counter-clockwise from the visible side, (F, 3), int32.
    shapes: vertices in each frame, before `matrices`, (N, V, 3), float32; None: always `rest`.
    matrices: motion of the whole surface in each frame, (N, 4, 4), float64; None: no motion.
    uv: texture coordinates, (U, 2).
    face_uv: row of `uv` at each corner of triangles, (F, 3).
    colours: sRGB, 0 to 1, of the vertices, (V, 3), float32; None for a surface with a texture.
    shine: specular strength, 0 (dull) to 1 (wet).
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
        """Return the vertices in a frame, (V, 3)."""
        points = self.rest if self.shapes is None else self.shapes[frame].astype(np.float64)
        if self.matrices is None:
            return points
        return moved_points(self.matrices[frame], points)

    def normals_of(self, points: Floats64, frame: int | None) -> Floats64:
        """Return unit normals (V, 3) for the vertex positions `points` (V, 3) in a frame.

        frame: index of the frame; None for the surface at rest.
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

    rest_normals: unit normals at rest, (V, 3).
    normals: unit normals in each frame, (N, V, 3).
    sources: for each triangle, the triangle of the scene's mesh that contains it, (F,).
    origins: for each vertex, vertices of the scene's mesh and their weights.
    refiner: the refiner that made these triangles from the scene's mesh.
    """

    rest_normals: Floats32 = field(kw_only=True)
    normals: Floats32 = field(kw_only=True)
    sources: Integers32 = field(kw_only=True)
    origins: refine.Origins = field(kw_only=True)
    refiner: refine.Refiner = field(kw_only=True)

    def normals_of(self, points: Floats64, frame: int | None) -> Floats64:
        """Return the normals of the refiner, (V, 3)."""
        normals = self.rest_normals if frame is None else self.normals[frame]
        return normals.astype(np.float64)

    def carried(self, values: Floats64) -> Floats64:
        """Carry values of the scene's mesh, shape (n,), to these vertices, (V,)."""
        return np.asarray((values[self.origins.vertices] * self.origins.weights).sum(axis=1))

    @property
    def source(self) -> Integers32:
        """The triangle of the scene's mesh that each triangle is part of, shape (F,)."""
        return self.sources
