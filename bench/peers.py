"""What others offer for the same work, ready to be timed beside us in one run.

- *sparse Loop*: the strongest. The rules of one or two uniform levels (Loop 1987, Warren's weights)
  are one matrix for positions and one for normals, built once. A frame is vertex normals of the
  input and two products, normals brought to length one, all in float32, into rows of position and
  normal. It writes no triangles, since they never change. The product is compiled as our kernels
  are: four times as fast as scipy's.
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
import scipy.sparse

from risorius import refine
from risorius.jit import njit
from risorius.refine.mesh.normals import vertex_normals
from risorius.refine.mesh.rings import vertex_rings

from .waving_meshes import Load

Positions = npt.NDArray[np.floating]
Wide = npt.NDArray[np.int64]
Narrow = npt.NDArray[np.float32]
Matrix = Any
"""A scipy.sparse.csr_matrix, which carries no types."""

SEARCH_STEPS = 14
LARGEST_FOR_FILTERS = 30_000  # triangles; above, a call of these takes seconds
LARGEST_FOR_TWO_LEVELS = 300_000  # triangles; a million needs a matrix of 65 million numbers


@dataclass(frozen=True)
class Peer:
    """One method of somebody else, bound to a mesh."""

    name: str
    call: Callable[[Positions], object]
    triangles: int


def peers_for(load: Load, target: int) -> tuple[list[Peer], list[str]]:
    """Bind all peers to a mesh, and return a line for each that is missing, too.

    `target`: triangles that an adaptive one is to make.
    """
    levels_made = (1, 2) if len(load.faces) <= LARGEST_FOR_TWO_LEVELS else (1,)
    found = [_sparse_loop(load, levels) for levels in levels_made]
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


def _sparse_loop(load: Load, levels: int) -> Peer:
    """Build the matrices of `levels` levels; a call returns rows of position and normal."""
    smooth, spread, faces = _subdivision(load.faces.astype(np.int64), len(load.rest), levels)
    smooth, spread = smooth.astype(np.float32), spread.astype(np.float32)
    corners = load.faces.astype(np.uint32)
    points: npt.NDArray[Any] = np.zeros((len(load.rest), 3), dtype=np.float32)
    normals = np.zeros_like(points)
    rows = np.zeros((smooth.shape[0], 6), dtype=np.float32)
    smooth_rows, spread_rows = (
        (each.indptr.astype(np.uint32), each.indices.astype(np.uint32), each.data)
        for each in (smooth, spread)
    )

    def frame(positions: Positions) -> Narrow:
        np.copyto(points, positions)
        vertex_normals(points, corners, normals)
        _multiply(smooth_rows, spread_rows, points, normals, rows)
        return rows

    return Peer(f"sparse Loop {levels}x, numba", frame, len(faces))


def _subdivision(faces: Wide, vertex_count: int, levels: int) -> tuple[Matrix, Matrix, Wide]:
    """Matrices, shape (N, V), of levels of Loop's rules and of plain means, and their triangles."""
    smooth = spread = scipy.sparse.identity(vertex_count, format="csr")
    for _ in range(levels):
        mesh = refine.connect(faces, smooth.shape[0])
        smooth = (_loop_rules(mesh) @ smooth).tocsr()
        spread = (_midpoint_rules(mesh) @ spread).tocsr()
        faces = _quartered(mesh)
    return smooth, spread, faces


def _loop_rules(mesh: refine.Connectivity) -> Matrix:
    """Rows: vertices by Warren's weights, then edge points by Loop's; shape (V + E, V)."""
    rings = vertex_rings(mesh)
    every, starts = np.arange(mesh.vertex_count), rings.starts.astype(np.int64)
    further = np.repeat(every, starts[1:] - starts[:-1])
    centres = np.concatenate([np.repeat(every, rings.near.shape[1]), further])
    around = np.concatenate([rings.near.ravel(), rings.others]).astype(np.int64)
    ring = scipy.sparse.csr_matrix(
        (rings.ring[centres], (centres, around)), shape=(mesh.vertex_count, mesh.vertex_count)
    )
    edge_count = len(mesh.edges)
    weights = np.where(
        mesh.around.is_interior[:, None], [3 / 8, 3 / 8, 1 / 8, 1 / 8], [0.5, 0.5, 0.0, 0.0]
    )
    rows = np.repeat(np.arange(edge_count), 4)
    edges = scipy.sparse.csr_matrix(
        (weights.ravel(), (rows, mesh.around.points.ravel().astype(np.int64))),
        shape=(edge_count, mesh.vertex_count),
    )
    edges.eliminate_zeros()
    vertices = scipy.sparse.diags(rings.own) + ring
    vertices.eliminate_zeros()
    return scipy.sparse.vstack([vertices, edges]).tocsr()


def _midpoint_rules(mesh: refine.Connectivity) -> Matrix:
    """Rows: vertices as they are, then the means of both ends of each edge."""
    edge_count = len(mesh.edges)
    ends = scipy.sparse.csr_matrix(
        (np.full(2 * edge_count, 0.5), (np.repeat(np.arange(edge_count), 2), mesh.edges.ravel())),
        shape=(edge_count, mesh.vertex_count),
    )
    return scipy.sparse.vstack([scipy.sparse.identity(mesh.vertex_count), ends]).tocsr()


def _quartered(mesh: refine.Connectivity) -> Wide:
    """Every triangle cut into four, new vertices in the order of edges."""
    a, b, c = mesh.faces.T.astype(np.int64)
    ab, bc, ca = mesh.vertex_count + mesh.triangle_edges.T.astype(np.int64)
    four = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    return np.array(four).transpose(2, 0, 1).reshape(-1, 3)


@njit
def _multiply(smooth, spread, points, normals, rows):  # type: ignore[no-untyped-def]
    """Rows of smoothed position and of mixed normal, the normal of length one."""
    for r in range(rows.shape[0]):
        rows[r, 0], rows[r, 1], rows[r, 2] = _product(smooth, r, points)
        x, y, z = _product(spread, r, normals)
        scale = np.float32(1.0) / np.sqrt(max(x * x + y * y + z * z, np.float32(1e-30)))
        rows[r, 3], rows[r, 4], rows[r, 5] = x * scale, y * scale, z * scale


@njit
def _product(matrix, r, vectors):  # type: ignore[no-untyped-def]
    """A row of a matrix, in its plain arrays, times vectors."""
    starts, columns, values = matrix
    x = y = z = np.float32(0.0)
    for k in range(starts[r], starts[r + 1]):
        v, weight = columns[k], values[k]
        x += weight * vectors[v, 0]
        y += weight * vectors[v, 1]
        z += weight * vectors[v, 2]
    return x, y, z


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
