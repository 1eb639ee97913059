"""Alembic, for film and for geometry caches of game engines: a mesh for each surface. Metres.

Alembic names no unit; triangles are clockwise in it, seen from outside.

Source: Alembic 1.8, AbcGeom: OXform, OPolyMesh and their schemas.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.assets.topology import vertex_normals

from .clip import Clip, Surface
from .formats import Request, needed
from .sheets import METRES

PACKAGE = "alembic3d"
Abc, AbcGeom = (needed(f"alembic3d.{name}", PACKAGE) for name in ("Abc", "AbcGeom"))
AbcCoreAbstract, imath = needed("alembic3d.AbcCoreAbstract", PACKAGE), needed("imath", PACKAGE)

VERTEX, CORNER = AbcGeom.GeometryScope.kVertexScope, AbcGeom.GeometryScope.kFacevaryingScope


def write_abc(clip: Clip, part: Path, request: Request) -> None:
    """Write an archive of evenly spaced frames, in seconds from 0."""
    archive = Abc.OArchive(str(part))
    times = AbcCoreAbstract.TimeSampling(1.0 / clip.frames_per_second, 0.0)
    sampling = archive.addTimeSampling(times)
    root = AbcGeom.OXform(archive.getTop(), clip.scene.name, sampling)
    for surface in clip.surfaces:
        place = AbcGeom.OXform(root, surface.name, sampling)
        _add_motion(place.getSchema(), surface)
        mesh = AbcGeom.OPolyMesh(place, f"{surface.name}_mesh", sampling)
        if surface is clip.skin and request.refinement is not None:
            _add_refined(mesh.getSchema(), clip, request)
        else:
            _add_surface(mesh.getSchema(), surface, request)


def _add_motion(schema: Any, surface: Surface) -> None:
    """What moves the whole of a surface."""
    for matrix in () if surface.matrices is None else surface.matrices:
        rows = matrix.T.copy()  # its vectors are rows
        rows[3, :3] *= METRES
        sample = AbcGeom.XformSample()
        sample.setMatrix(imath.M44d(*rows.ravel().tolist()))
        schema.set(sample)


def _add_surface(schema: Any, surface: Surface, request: Request) -> None:
    """A mesh whose triangles stay; arrays that are the same in each frame are stored once."""
    if surface.colours is not None:
        colours = AbcGeom.OC3fGeomParam(schema.getArbGeomParams(), "Cd", False, VERTEX, 1)
        values = imath.C3fArray(len(surface.rest))
        for number, row in enumerate(surface.colours.tolist()):
            values[number] = imath.Color3f(*row)
        colours.set(AbcGeom.OC3fGeomParamSample(values, VERTEX))
    shapes = surface.rest[None] if surface.shapes is None else surface.shapes.astype(np.float64)
    for points in request.counted(shapes, len(shapes)):
        normals = vertex_normals(points, surface.faces)
        _add_frame(schema, points, normals, surface.faces, surface.uv, surface.face_uv)


def _add_refined(schema: Any, clip: Clip, request: Request) -> None:
    """The refined skin, which has other triangles in each frame."""
    assert request.refinement is not None
    for mesh in request.counted(clip.refined(request.refinement), clip.frame_count):
        _add_frame(schema, mesh.positions, mesh.normals, mesh.triangles, mesh.uv, mesh.triangles)


def _add_frame(
    schema: Any,
    points: npt.NDArray[Any],
    normals: npt.NDArray[Any],
    faces: npt.NDArray[Any],
    uv: npt.NDArray[Any] | None,
    face_uv: npt.NDArray[Any] | None,
) -> None:
    """Add a sample of a mesh."""
    clockwise = faces[:, ::-1].astype(np.int32).ravel()
    arrays = [  # looked into until the sample is set
        imath.V3fArrayFromBuffer((METRES * points).astype(np.float32)),
        imath.IntArrayFromBuffer(clockwise),
        imath.IntArrayFromBuffer(np.full(len(faces), 3, np.int32)),
    ]
    coordinates = AbcGeom.OV2fGeomParamSample()
    if uv is not None and face_uv is not None:
        corners = uv[face_uv[:, ::-1].ravel()].astype(np.float32)
        arrays.append(imath.V2fArrayFromBuffer(corners))
        coordinates = AbcGeom.OV2fGeomParamSample(arrays[-1], CORNER)
    arrays.append(imath.V3fArrayFromBuffer(normals.astype(np.float32)))
    lit = AbcGeom.ON3fGeomParamSample(arrays[-1], VERTEX)
    schema.set(AbcGeom.OPolyMeshSchemaSample(*arrays[:3], coordinates, lit))
