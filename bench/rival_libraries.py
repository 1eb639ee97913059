"""Other libraries that refine triangle meshes, each behind the same two calls.

The first call binds a method to triangles and rest positions, and stores all data that its library
can reuse. The second call refines a frame from positions and, for some methods, a limit. Each
library is used with the settings that came nearest to the true surfaces of rivals.py.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.assets.topology import boundary_loops
from risorius.geometry.arrays import Floats64, Integers32

PointsAndFaces = tuple[npt.NDArray[np.floating[Any]], npt.NDArray[np.integer[Any]]]
"""Positions (N, 3) and triangles (M, 3)."""
RefinesFrame = Callable[[Floats64, float], PointsAndFaces]
"""From positions and a limit to the refined mesh."""


class Method(NamedTuple):
    """One refinement method of a library."""

    title: str
    package: str
    """The distribution that contains it."""
    module: str
    bind: Callable[[Integers32, Floats64], RefinesFrame]
    has_limit: bool
    """Whether a limit sets the number of triangles; other methods make four of each."""


def _manifold3d(faces: Integers32, rest: Floats64, adaptive: bool) -> RefinesFrame:
    """Smooth by tangents. Holes are filled for a closed surface; the result is without fillings."""
    manifold3d = import_module("manifold3d")
    lids: list[tuple[int, int, int]] = []
    loops = boundary_loops(faces)
    for middle, loop in enumerate(loops, start=len(rest)):
        behind = [*loop[1:], loop[0]]
        lids += [(b, a, middle) for a, b in zip(loop, behind, strict=True)]
    count = len(faces)
    closed = np.concatenate([faces, np.array(lids, dtype=np.int32).reshape(-1, 3)])
    closed = closed.astype(np.uint32)
    names = np.arange(len(closed), dtype=np.uint32)
    rims = list(range(3 * count, 3 * len(closed), 3))  # first half edges of fillings

    def frame(positions: Floats64, limit: float) -> PointsAndFaces:
        """The refined surface of a frame."""
        centroids = np.array([positions[loop].mean(axis=0) for loop in loops]).reshape(-1, 3)
        points = np.concatenate([positions, centroids]).astype(np.float32)
        mesh = manifold3d.Mesh(points, closed, face_id=names)
        smooth = manifold3d.Manifold.smooth(mesh, rims, [0.0] * len(rims))
        fine = smooth.refine_to_tolerance(limit) if adaptive else smooth.refine(2)
        found = fine.to_mesh()
        is_own = np.array(found.face_id) < count
        return found.vert_properties[:, :3], found.tri_verts[is_own]

    return frame


def _meshlib(faces: Integers32, rest: Floats64) -> RefinesFrame:
    """Split the edges with most curvature, and smooth the new points."""
    mrmeshpy = import_module("meshlib.mrmeshpy")
    mrmeshnumpy = import_module("meshlib.mrmeshnumpy")
    kept = mrmeshnumpy.meshFromFacesVerts(faces, rest)

    def frame(positions: Floats64, limit: float) -> PointsAndFaces:
        """The refined surface of a frame."""
        mesh = mrmeshpy.copyMesh(kept)
        mesh.points = mrmeshnumpy.pointCloudFromPoints(positions).points
        mesh.invalidateCaches()
        settings = mrmeshpy.SubdivideSettings()
        settings.maxEdgeLen = 0.0
        settings.maxEdgeSplits = round(len(faces) / limit)
        settings.smoothMode = True
        settings.curvaturePriority = 1.0
        mrmeshpy.subdivideMesh(mesh, settings)
        mesh.pack()
        return mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology)

    return frame


def _pymeshlab(faces: Integers32, rest: Floats64, rule: str) -> RefinesFrame:
    """Split edges that are longer than the limit, up to three times."""
    pymeshlab = import_module("pymeshlab")

    def frame(positions: Floats64, limit: float) -> PointsAndFaces:
        """The refined surface of a frame."""
        meshes = pymeshlab.MeshSet(verbose=False)
        meshes.add_mesh(pymeshlab.Mesh(positions, faces))
        split = getattr(meshes, f"meshing_surface_subdivision_{rule}")
        split(threshold=pymeshlab.PureValue(limit), iterations=3)
        mesh = meshes.current_mesh()
        return mesh.vertex_matrix(), mesh.face_matrix()

    return frame


def _vtk(faces: Integers32, rest: Floats64, rule: str) -> RefinesFrame:
    """Run one of VTK's filters for each frame; the filter object is reused."""
    modeling = import_module("vtkmodules.vtkFiltersModeling")
    data = import_module("vtkmodules.vtkCommonDataModel")
    core = import_module("vtkmodules.vtkCommonCore")
    arrays = import_module("vtkmodules.util.numpy_support")
    mesh = data.vtkPolyData()
    points = core.vtkPoints()
    cells = data.vtkCellArray()
    corners = arrays.numpy_to_vtkIdTypeArray(faces.astype(np.int64).ravel(), deep=True)
    cells.SetData(3, corners)
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    subdivision = getattr(modeling, f"vtk{rule}SubdivisionFilter")()
    subdivision.SetInputData(mesh)
    if rule == "Adaptive":
        subdivision.SetMaximumTriangleArea(np.inf)  # the limit is a length only

    def frame(positions: Floats64, limit: float) -> PointsAndFaces:
        """The refined surface of a frame."""
        points.SetData(arrays.numpy_to_vtk(positions, deep=True))
        points.Modified()
        mesh.Modified()
        if rule == "Adaptive":
            subdivision.SetMaximumEdgeLength(limit)
        else:
            subdivision.SetNumberOfSubdivisions(1)
        subdivision.Update()
        fine = subdivision.GetOutput()
        triangles = arrays.vtk_to_numpy(fine.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        return arrays.vtk_to_numpy(fine.GetPoints().GetData()), triangles

    return frame


def _libigl(faces: Integers32, rest: Floats64) -> RefinesFrame:
    """Multiply by the stored matrix of one level of Loop subdivision."""
    igl = import_module("igl")
    matrix, fine = igl.loop_matrix(faces.astype(np.int64), len(rest))
    rows = matrix.tocsr()
    return lambda positions, limit: (rows @ positions, fine)


def _table() -> list[Method]:
    """All methods; a limit is a length, a tolerance or a number of splits."""
    adaptive = partial(_manifold3d, adaptive=True)
    everywhere = partial(_manifold3d, adaptive=False)
    manifold = ("manifold3d", "manifold3d")
    meshlib = ("meshlib", "meshlib.mrmeshpy")
    pymeshlab = ("pymeshlab", "pymeshlab")
    vtk = ("vtk", "vtkmodules.vtkFiltersModeling")
    return [
        Method("manifold3d, smooth, refined to a tolerance", *manifold, adaptive, True),
        Method("manifold3d, smooth, all edges", *manifold, everywhere, False),
        Method("meshlib, smooth, by curvature", *meshlib, _meshlib, True),
        Method("pymeshlab, Loop by length", *pymeshlab, partial(_pymeshlab, rule="loop"), True),
        Method(
            "pymeshlab, butterfly by length",
            *pymeshlab,
            partial(_pymeshlab, rule="butterfly"),
            True,
        ),
        Method("VTK, adaptive by length", *vtk, partial(_vtk, rule="Adaptive"), True),
        Method("VTK, Loop", *vtk, partial(_vtk, rule="Loop"), False),
        Method("VTK, butterfly", *vtk, partial(_vtk, rule="Butterfly"), False),
        Method("libigl, kept Loop matrix", "libigl", "igl", _libigl, False),
    ]


RIVAL_METHODS: Sequence[Method] = tuple(_table())
