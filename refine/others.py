"""Refiners for comparison: the unchanged mesh, and Loop subdivision of the whole mesh.

*None* splits nothing: it returns the mesh itself in the form of a refined mesh.

Kähler, Haber, Seidel 2003, compare with the static mesh in every figure and in Table 1. Positions,
normals and texture coordinates are, to the last bit, those of `kahler` where no edge is split, so
that a switch between the two shows only refinement.

*Loop* subdivides the whole mesh, level by level: the adaptive refiner is compared with it.

Its rules are those of Loop 1987 with Warren's vertex weights (Warren 2001). Kähler, Haber, Seidel
2003, section 4.2, take their rules from this scheme. Every edge is split, every vertex is smoothed,
borders follow their own curve. The connectivity of each level is built at binding; a frame only
moves points, by the passes of `kahler`.

Normals and texture coordinates of new points are interpolated along the edge, as in `kahler`, and
not recomputed from the subdivided surface. So both can be compared in shading and in time.

Differs from `kahler` with all edges split twice: a triangle becomes sixteen, not ten, with three
points in its interior, and the second level smooths all vertices of the first.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Unpack

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats32, Integers32
from .border.base import BaseRefiner
from .border.corner_values import Values
from .border.option import Option
from .border.plugin import Origins, Stream, View
from .border.rows import (
    GEOMETRY_COLUMNS,
    spread_over_wedges,
    wedge_values,
    write_wedges,
)
from .kahler.frame import buffers_for, split_everywhere
from .kahler.smoothing import LoopScheme
from .mesh.connectivity import Connectivity, connect
from .mesh.creases import sharpened

CHILD_TRIANGLES = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""Four children of a triangle with corners 0 1 2 and midpoints 3 4 5 of its edges."""
LEVELS_OPTION = Option("how often all edges are split", 1, 4, name="levels", kind="integer")
"""Most levels, chosen: four levels make 256 triangles of each, half a million of a face."""


class Level:
    """One step of subdivision of a mesh with V vertices and E edges: every edge split once."""

    def __init__(self, connectivity: Connectivity, points: Floats32, normals: Floats32) -> None:
        """Take `points` and `normals`, shape (V, 3), as buffers that a frame fills."""
        self.points = points
        self.normals = normals
        self._scheme = LoopScheme()
        positions = np.zeros((0, 3))  # no pass of this refiner reads them
        self._scheme.bind(connectivity, positions, normals)
        frame = buffers_for(connectivity, positions, points, normals)
        self._frame = split_everywhere(frame, connectivity.vertex_count)
        self._scheme.keep(self._frame)

    def subdivide(self, rows: Floats32) -> None:
        """Write the moved vertices, then one point per edge, into the first V + E `rows`."""
        if rows is not self._frame.rows:
            self._frame = self._frame._replace(rows=rows)
        self._scheme.place(self._frame)


class Loop(BaseRefiner):
    """Uniform Loop subdivision; the refiner named `loop`."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        levels: Annotated[int, LEVELS_OPTION] = 1,
        **values: Unpack[Values],
    ) -> None:
        """Bind to a mesh (see `registry.create`). `levels`: 1 to 4, how often edges are split."""
        super().__init__(faces, rest_positions, **values)
        LEVELS_OPTION.check(levels)
        self.edge_splits[:] = levels
        finest = _Refined.from_mesh(
            self.connectivity, None if self._values is None else self._values.values
        )
        self._split = [finest.connectivity]
        self._levels = [Level(finest.connectivity, self.points, self.normals)]
        for _ in range(levels - 1):
            finest = finest.subdivided()
            self._split.append(finest.connectivity)
            rest = np.zeros((finest.connectivity.vertex_count, 3), dtype=np.float32)
            self._levels.append(Level(finest.connectivity, rest, rest.copy()))
        self._rows = np.zeros((len(self._levels[-1].points), GEOMETRY_COLUMNS), np.float32)
        self._finest = finest.subdivided()
        self._triangles = self._finest.connectivity.corners
        if self._finest.values is not None:
            self._wedge_values = wedge_values(self._finest.connectivity, self._finest.values)

    @property
    def vertex_capacity(self) -> int:
        """Vertices of the finest level, one per wedge."""
        return len(self._finest.connectivity.wedge_vertices)

    @property
    def triangle_capacity(self) -> int:
        """Triangles of the finest level: 4, 16, 64 or 256 for each."""
        return len(self._triangles)

    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Write the finest level."""
        vertex_count = self.vertex_capacity
        triangle_count = self.triangle_capacity
        vertices, triangles, source = self.reserve(stream, vertex_count, triangle_count)
        self.find_normals()
        for level, finer in pairwise(self._levels):
            level.subdivide(self._rows)
            written = self._rows[: len(finer.points)]
            np.copyto(finer.points, written[:, :3])
            np.copyto(finer.normals, written[:, 3:])
        self._levels[-1].subdivide(vertices)

        if self._values is not None:
            write_wedges(self._finest.connectivity, self._wedge_values, vertices)
        triangles[:triangle_count] = self._triangles
        source[:triangle_count] = self._finest.source
        return vertex_count, triangle_count

    def follow_values(self) -> None:
        """Compute the values of every level: all values of the level before, then on its edges."""
        assert self._values is not None
        values = self._values.values
        for mesh in self._split:
            values = _with_edge_points(values, mesh)
        finest = self._finest.connectivity
        spread_over_wedges(values, finest.wedge_uv, self._wedge_values)

    def origins(self) -> Origins:
        """Return the place on the input mesh of every output vertex."""
        finest = self._finest
        wedges = finest.connectivity.wedge_vertices.astype(np.int32)
        vertices = np.stack([wedges] * 3, axis=1)
        weights = np.zeros(vertices.shape, dtype=np.float32)
        weights[:, 0] = 1.0
        vertices[self._triangles] = self.connectivity.faces[finest.source][:, None, :]
        weights[self._triangles] = finest.barycentric
        return Origins(vertices, weights)


@dataclass(frozen=True)
class _Refined:
    """A subdivided mesh, with its places on the input mesh."""

    connectivity: Connectivity
    values: Floats32 | None
    """Texture coordinates and attributes, shape (A, k)."""
    source: Integers32
    """Triangle of the input that each triangle is part of, shape (M,)."""
    barycentric: Floats32
    """Corners of each triangle in coordinates of its source, shape (M, 3, 3)."""

    @classmethod
    def from_mesh(cls, connectivity: Connectivity, values: Floats32 | None) -> "_Refined":
        """Take a mesh as it is."""
        face_count = len(connectivity.faces)
        return cls(
            connectivity,
            values,
            np.arange(face_count, dtype=np.int32),
            np.tile(np.eye(3, dtype=np.float32), (face_count, 1, 1)),
        )

    def subdivided(self) -> "_Refined":
        """Split every edge: each triangle becomes four; one that names a vertex twice stays."""
        mesh = self.connectivity
        whole = np.flatnonzero(mesh.is_degenerate)
        split = np.flatnonzero(~mesh.is_degenerate)
        parents = np.concatenate([np.repeat(split, 4), whole])
        order = np.argsort(parents, kind="stable")

        vertex_edge_points = mesh.vertex_count + mesh.triangle_edges[split].astype(np.int64)
        children = _child_triangles(mesh.faces[split].astype(np.int64), vertex_edge_points)
        faces = np.concatenate([children, mesh.faces[whole]])[order]

        corner_rows = None
        values = self.values
        if values is not None:
            rows = mesh.wedge_uv[mesh.corners].astype(np.int64)
            edges = mesh.triangle_attribute_edges[split] >> 1
            children = _child_triangles(rows[split], len(values) + edges.astype(np.int64))
            corner_rows = np.concatenate([children, rows[whole]])[order]
            values = _with_edge_points(values, mesh)

        corners = self.barycentric[split]
        children = _child_triangles(corners, (corners + np.roll(corners, -1, axis=1)) / 2)
        barycentric = np.concatenate([children, self.barycentric[whole]])[order]
        finer = connect(faces, mesh.vertex_count + len(mesh.edges), corner_rows)
        if mesh.is_sharp.any():  # both halves of a crease are creases
            is_half = (finer.edges >= mesh.vertex_count).sum(axis=1) == 1
            owner = finer.edges.max(axis=1) - mesh.vertex_count
            end = finer.edges.min(axis=1)
            owner[~is_half] = 0
            is_half &= (mesh.edges[owner] == end[:, None]).any(axis=1)
            finer = sharpened(finer, is_half & mesh.is_sharp[owner])
        return _Refined(
            finer,
            values,
            self.source[parents[order]],
            barycentric,
        )


def _with_edge_points(values: Floats32, mesh: Connectivity) -> Floats32:
    """Values of a mesh, (A, k), followed by those in the middle of each attribute edge."""
    edge_points = values[mesh.attribute_edge_uv].mean(axis=1, dtype=np.float32)
    return np.concatenate([values, edge_points])


def _child_triangles(corners: npt.NDArray[Any], edge_points: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return four triangles for each triangle: three at its corners, and one between its midpoints.

    `corners`: values at corners, shape (F, 3, ..); `edge_points`: values at edges, of this shape.
    Returns shape (4 F, 3, ..).
    """
    points = np.concatenate([corners, edge_points], axis=1)
    return points[:, CHILD_TRIANGLES].reshape(-1, *corners.shape[1:])


class PassThrough(BaseRefiner):
    """Passes the mesh on with normals; the refiner named `none`."""

    def __init__(
        self, faces: npt.ArrayLike, rest_positions: npt.ArrayLike, **values: Unpack[Values]
    ) -> None:
        """Bind to a mesh (see `registry.create`); there are no options."""
        super().__init__(faces, rest_positions, **values)
        self._source = np.arange(len(self.connectivity.faces), dtype=np.int32)

    @property
    def vertex_capacity(self) -> int:
        """One output vertex per wedge."""
        return len(self.connectivity.wedge_vertices)

    @property
    def triangle_capacity(self) -> int:
        """The triangles of the input."""
        return len(self.connectivity.faces)

    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Write the mesh as it is."""
        vertex_count = self.vertex_capacity
        triangle_count = self.triangle_capacity
        vertices, triangles, source = self.reserve(stream, vertex_count, triangle_count)
        self.find_normals()
        rows = vertices[: len(self.points)]
        rows[:, 0:3] = self.points
        rows[:, 3:GEOMETRY_COLUMNS] = self.normals
        self.write_wedges(vertices)
        triangles[:triangle_count] = self.connectivity.corners
        source[:triangle_count] = self._source
        return vertex_count, triangle_count
