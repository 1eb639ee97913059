"""A coarse mesh for a dense one, whose vertices lie on it: VTK's quadric edge collapse.

Source: Garland and Heckbert 1997, as `vtkQuadricDecimation` has it (extra 'peers'). It leaves
vertices beside the surface; each is put onto the nearest point, so that whatever moves the dense
mesh moves the coarse one, too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.app.errors import UserError, needed
from risorius.geometry.closest import closest_points

BORDER_WEIGHT = 10.0
"""How much a border counts: eyes and mouth keep their outlines. With more, the rest gets worse."""


class Coarse(NamedTuple):
    """A coarse mesh on a dense one."""

    triangles: npt.NDArray[np.int32]
    """Shape (M, 3)."""
    fine_triangle: npt.NDArray[np.int32]
    """The dense triangle in which each vertex lies, shape (N,)."""
    barycentric: npt.NDArray[np.float32]
    """Where in it, shape (N, 3)."""
    vertices: npt.NDArray[np.float32]
    """So its place, shape (N, 3)."""


def decimated(
    vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.integer], count: int
) -> Coarse:
    """Reduce a mesh to `count` triangles, or one or two less.

    Raises UserError without VTK, and for a mesh that has no more than that.
    """
    needed("vtkmodules", "decimation", "peers", package="VTK")
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkQuadricDecimation

    if len(triangles) <= count:
        raise UserError(f"the face has {len(triangles)} triangles, and {count} are to be left")
    points, cells, mesh = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices), deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(triangles.astype(np.int64).ravel(), deep=True))
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    collapse = vtkQuadricDecimation()
    collapse.SetInputData(mesh)
    collapse.SetTargetReduction(1.0 - count / len(triangles))
    collapse.SetBoundaryWeightFactor(BORDER_WEIGHT)
    collapse.Update()
    result = collapse.GetOutput()
    found = closest_points(
        vtk_to_numpy(result.GetPoints().GetData()).astype(np.float64), vertices, triangles
    )
    corners = vtk_to_numpy(result.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return Coarse(
        corners.astype(np.int32),
        found.triangles.astype(np.int32),
        found.weights.astype(np.float32),
        found.interpolate(vertices).astype(np.float32),
    )
