"""What others offer for the same work, ready to be timed beside us in one run.

- *sparse Loop*: the strongest, see sparse_loop.py: one or two uniform levels as matrices that are
  built once.
- *trimesh*: `trimesh.remesh.subdivide_loop`, one level.
- *VTK*: `vtkAdaptiveSubdivisionFilter`, two passes at most, its edge length chosen so that the mesh
  of the first frame gets as many triangles as ours. Alone, which computes no normals; and with what
  a frame of ours has in addition: `vtkPolyDataNormals` in front, whose normals the filter
  interpolates, and rows of single precision and 32-bit triangles behind.

What is not installed is left out, and named.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .sparse_loop import sparse_loop
from .waving_meshes import Load

Positions = npt.NDArray[np.floating]
Call = Callable[[Positions], object]

SEARCH_STEPS = 14
LARGEST_FOR_FILTERS = 30_000  # triangles; above, a call of these takes seconds
LARGEST_FOR_TWO_LEVELS = 300_000  # triangles; a million needs a matrix of 65 million numbers


@dataclass(frozen=True)
class Peer:
    """One method of somebody else, bound to a mesh."""

    name: str
    call: Call
    triangles: int


def peers_for(load: Load, target: int) -> tuple[list[Peer], list[str]]:
    """Bind all peers to a mesh, and return a line for each that is missing, too.

    `target`: triangles that an adaptive one is to make.
    """
    levels_made = (1, 2) if len(load.faces) <= LARGEST_FOR_TWO_LEVELS else (1,)
    found = [
        Peer(f"sparse Loop {levels}x, numba", *sparse_loop(load, levels=levels))
        for levels in levels_made
    ]
    missing: list[str] = []
    if len(load.faces) > LARGEST_FOR_FILTERS:
        return found, missing
    for name, bind in (
        ("VTK adaptive", lambda: _vtk(load, target)),
        ("VTK adaptive, whole frame", lambda: _vtk(load, target, is_whole=True)),
        ("trimesh", lambda: _trimesh(load)),
    ):
        try:
            found.append(bind())
        except ImportError as error:
            package = (error.name or name).partition(".")[0]
            missing.append(f"{name}: left out, {package} is not installed (extra 'peers')")
    return found, missing


def _trimesh(load: Load) -> Peer:
    import trimesh.remesh

    def frame(positions: Positions) -> Any:
        return trimesh.remesh.subdivide_loop(positions, load.faces, iterations=1)

    return Peer("trimesh Loop 1x", frame, len(frame(load.frames[0])[1]))


def _vtk(load: Load, target: int, *, is_whole: bool = False) -> Peer:
    from vtkmodules.util.numpy_support import (
        numpy_to_vtk,
        numpy_to_vtkIdTypeArray,
        vtk_to_numpy,
    )
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
    from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter

    cells = vtkCellArray()
    offsets = np.arange(0, 3 * len(load.faces) + 1, 3, dtype=np.int64)
    corners = load.faces.astype(np.int64).ravel()
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(corners, deep=True)
    )
    points, mesh, refiner = vtkPoints(), vtkPolyData(), vtkAdaptiveSubdivisionFilter()
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    if is_whole:
        normals = vtkPolyDataNormals()
        normals.SetInputData(mesh)
        normals.SplittingOff()
        normals.ConsistencyOff()
        refiner.SetInputConnection(normals.GetOutputPort())
    else:
        refiner.SetInputData(mesh)
    refiner.SetMaximumNumberOfPasses(2)
    refiner.SetMaximumTriangleArea(1e30)
    rows = np.zeros((len(load.rest) + 9 * len(load.faces), 6), np.float32)
    triangles = np.zeros((16 * len(load.faces), 3), np.uint32)

    def frame(positions: Positions) -> int:
        """Refine once; return the number of triangles."""
        points.SetData(numpy_to_vtk(np.ascontiguousarray(positions)))
        points.Modified()
        refiner.Update()
        output = refiner.GetOutput()
        count = int(output.GetNumberOfPolys())
        if is_whole:
            place = vtk_to_numpy(output.GetPoints().GetData())
            rows[: len(place), :3] = place
            rows[: len(place), 3:] = vtk_to_numpy(output.GetPointData().GetNormals())
            found = vtk_to_numpy(output.GetPolys().GetConnectivityArray())
            triangles[:count] = found.reshape(-1, 3)
        return count

    ends = load.frames[0][load.faces] - np.roll(load.frames[0][load.faces], -1, axis=1)
    low, high = 0.0, float(np.linalg.norm(ends, axis=2).max())
    for _ in range(SEARCH_STEPS):
        middle = 0.5 * (low + high)
        refiner.SetMaximumEdgeLength(middle)
        low, high = (middle, high) if frame(load.frames[0]) > target else (low, middle)
    refiner.SetMaximumEdgeLength(high)
    name = "VTK adaptive, whole frame" if is_whole else "VTK adaptive"
    return Peer(name, frame, frame(load.frames[0]))
