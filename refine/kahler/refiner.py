"""The paper's refiner: split the edges that bend, smooth around them, look the triangles up.

Kähler, Haber, Seidel 2003, sections 4.1 to 4.4. One frame is `Kahler.fill`:

    normals     of the deformed mesh                                  (mesh/normals.py)
    mark        how often each edge is split               (4.1, criterion.py)
    number      lists of split edges, rows for new points  (look_up.py; 4.4, coherence.py)
    place       moved vertices, first level, second level  (4.2, smoothing.py)
    look up     subtriangles of each triangle              (4.3, table.py, look_up.py)

Differs from the paper: normals of new points are interpolated linearly and then normalised; the
deformed mesh is copied once, as a shield against a simulation that runs on meanwhile.
"""

from typing import Unpack

import numpy as np
import numpy.typing as npt

from ..border.base import BaseRefiner
from ..border.corner_values import Values
from ..border.plugin import Origins, Stream, View
from ..border.stream import StreamArrays
from ..mesh.arrays import Doubles, Floats, Indices, Short, Small
from ..mesh.connectivity import Connectivity
from ..mesh.threads import beside
from .coherence import Coherent
from .criterion import Criterion, NormalDrop
from .frame import buffers_for
from .look_up import (
    copy_along_attribute_edges,
    look_up_triangles,
    number_points,
    place_attributes,
)
from .smoothing import LoopScheme, Scheme
from .table import CONFIGURATIONS, MOST_SPLITS, POINTS_OF_EDGE, Patterns


class Kahler(BaseRefiner):
    """Refinement after Kähler, Haber, Seidel 2003."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        criterion: Criterion | None = None,
        scheme: Scheme | None = None,
        coherent: bool = False,
        **values: Unpack[Values],
    ) -> None:
        """Bind to a mesh (see `registry.create`).

        `criterion`, `scheme`: None for the paper's.
        `coherent`: whether triangulations continue those of the frame before (section 4.4).
        """
        super().__init__(faces, rest_positions, **values)
        mesh = self._mesh
        self._criterion = NormalDrop() if criterion is None else criterion
        self._scheme = LoopScheme() if scheme is None else scheme
        self.history = Coherent(len(mesh.faces)) if coherent else None
        """What triangles remember of their splits, as they are walked; None unless `coherent`."""
        self._frame = buffers_for(mesh, self.positions, self.points, self.normals)
        if self.history is not None:
            self._look_up_in(self.history.patterns, self.history._states)
        else:
            self._look_up_in(CONFIGURATIONS, self._frame.configurations)
        frame = self._frame
        self._of_numbering = (
            mesh.edge_sides,
            mesh.more_sides,
            mesh.attribute_edges,
            len(mesh.wedge_vertices),
            frame.splits,
            frame.first_points,
            frame.split_once,
            frame.split_twice,
            frame.configurations,
            frame.counts,
        )
        self.edge_splits = frame.splits[: len(mesh.edges)]
        self._out: StreamArrays
        self._own(self._criterion, *self._criterion.parts, self._scheme, *self._scheme.parts)
        self._criterion.set_scheme(self._scheme)
        self.find_normals()
        self._criterion.bind(self.connectivity, self.rest_positions, self.normals)
        self._scheme.bind(self.connectivity, self.rest_positions, self.normals)

    @property
    def vertex_capacity(self) -> int:
        """Most output vertices: every wedge, and three points on every attribute edge."""
        return len(self.connectivity.wedge_vertices) + 3 * len(self.connectivity.attribute_edges)

    @property
    def triangle_capacity(self) -> int:
        """Most output triangles: the longest row of the table for each."""
        return int(self._patterns.subtriangles.shape[1] * len(self.connectivity.faces))

    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Write the frame: one line for each step above."""
        if self._criterion.uses_normals or self._scheme.uses_normals:
            self.find_normals()
        self._scheme.prepare(self._frame)
        self._mark(view)
        vertex_count, triangle_count = self._number()
        out = self.reserve(stream, vertex_count, triangle_count)
        if out.vertices is not self._frame.rows:
            self._frame = self._frame._replace(rows=out.vertices)
        self._out = out
        look_up = beside(self._look_up, triangle_count)
        try:
            self._place(out.vertices)
        finally:
            look_up()
        return vertex_count, triangle_count

    def _look_up_in(self, patterns: Patterns, rows: Short) -> None:
        """Take a table, and where each triangle says which row of it is its own."""
        self._patterns = patterns
        self._of_look_up = (
            self._mesh.corners,
            self._mesh.triangle_attribute_edges,
            self._frame.splits,
            self._frame.first_points,
            rows,
            patterns.counts.copy(),  # compiled code takes an array faster that it may write
            patterns.subtriangles.copy(),
        )

    def _mark(self, view: View | None) -> None:
        """Decide how often every edge is split (section 4.1)."""
        self._criterion.set_view(view)
        self._criterion.mark(self._frame.positions, self._frame.normals, self.edge_splits)

    def _number(self) -> tuple[int, int]:
        """Give new points their rows and triangles their row of the table; count both.

        Raises ValueError if a criterion asks for more than the table has.
        """
        vertex_count, triangle_count, most = number_points(*self._of_numbering)
        self._first_centre = vertex_count
        if most > MOST_SPLITS:
            raise ValueError(
                f"{type(self._criterion).__name__}.mark must write 0, 1 or 2 for every edge, "
                f"but edge {self.edge_splits.argmax()} got {most}"
            )
        if self.history is not None:
            self.history.follow(self._frame.configurations)
        return vertex_count, triangle_count

    def _place(self, rows: Floats) -> None:
        """Write vertices and new points: positions, normals, attributes (section 4.2)."""
        self._scheme.place(self._frame)
        if self._values is not None:
            self.write_wedges(rows)
            copy_along_attribute_edges(self.connectivity.attribute_edges, self._frame)
            place_attributes(self.connectivity.attribute_edge_uv, self._frame, self._values.values)

    def _look_up(self) -> None:
        """Write the subtriangles of every triangle (section 4.3)."""
        out = self._out
        look_up_triangles(*self._of_look_up, self._first_centre, out.triangles, out.source)

    def complaint(self) -> str | None:
        """Name the criterion that has measured NaN in the last frame; None if none has.

        It measures again, for `refine.check`.
        """
        frame = self._frame
        return self._criterion.find_complaint(frame.positions, frame.normals, len(self.edges))

    def origins(self) -> Origins:
        """Say for every vertex of the last frame where it lies on the input mesh."""
        points = points_on_edges(self.connectivity, self.edge_splits)
        return super().origins().followed_by(*points)


def points_on_edges(mesh: Connectivity, splits: Small) -> tuple[Indices, Doubles]:
    """Where the new points lie on the mesh: vertices and their weights, shape (N, 3) each.

    `splits`: of edges, shape (E,).
    """
    point_counts = np.array(POINTS_OF_EDGE)[splits[mesh.attribute_edges]]
    # Place along the edge, in quarters, of the points of a block: x 2 x or 1 2 3.
    block_starts = np.cumsum(point_counts) - point_counts
    within = np.arange(point_counts.sum()) - np.repeat(block_starts, point_counts)
    place = np.where(np.repeat(point_counts, point_counts) == 1, 2, within + 1)
    ends = np.repeat(mesh.edges[mesh.attribute_edges], point_counts, axis=0)
    weights = np.column_stack([4 - place, place, np.zeros_like(place)]) / 4.0
    return np.column_stack([ends, ends[:, 0]]), weights
