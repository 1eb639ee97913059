"""The paper's refiner: it splits edges that bend, smooths around them, and looks triangles up.

Kähler, Haber, Seidel 2003, sections 4.1 to 4.4. One frame is `Kahler.fill`:

    normals     of the deformed mesh                                  (mesh/normals.py)
    mark        how often each edge is split               (4.1, criterion.py)
    number      lists of split edges, rows for new points  (look_up.py; 4.4, coherence.py)
    place       moved vertices, first level, second level  (4.2, smoothing.py)
    look up     subtriangles of each triangle              (4.3, table.py, look_up.py)

If the criterion never changes, marking, numbering and looking up are done once (`FixedTriangles`).
Then all frames have the same triangles, and a frame only computes normals and places points.

Differs from the paper: normals of new points are interpolated linearly and then normalised; the
deformed mesh is copied in each frame, because a simulation may change it meanwhile.
"""

from functools import cached_property
from typing import NamedTuple, Unpack

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32, Floats64, Integers32, Unsigned8, Unsigned32
from ...geometry.read_only import read_only
from ..border.base import BaseRefiner
from ..border.corner_values import Values
from ..border.plugin import Origins, Stream, View
from ..border.stream import OwnStream, StreamArrays
from ..mesh.threads import start_beside
from .criterion import Criterion, NormalDrop
from .cutting import Cutting
from .frame import buffers_for
from .look_up import (
    copy_along_attribute_edges,
    look_up_triangles,
    number_points,
    place_attributes,
)
from .scheme import Scheme
from .smoothing import LoopScheme
from .table import MOST_SPLITS, POINTS_OF_EDGE


class FixedTriangles(NamedTuple):
    """The triangles of all frames, if they never change."""

    vertex_count: int
    triangles: Unsigned32
    """Shape (M, 3), read only."""
    source: Integers32
    """Input triangle that each triangle is part of, shape (M,), read only."""


class Kahler(BaseRefiner):
    """Refinement after Kähler, Haber, Seidel 2003."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        criterion: Criterion | None = None,
        scheme: Scheme | None = None,
        cutting: Cutting | None = None,
        **values: Unpack[Values],
    ) -> None:
        """Bind to a mesh (see `registry.create`).

        `criterion`, `scheme`, `cutting`: None chooses the paper's.
        """
        super().__init__(faces, rest_positions, **values)
        mesh = self._mesh
        self._criterion = NormalDrop() if criterion is None else criterion
        self._scheme = LoopScheme() if scheme is None else scheme
        self.cutting = Cutting() if cutting is None else cutting
        """The way in which triangles are cut."""
        self._frame = buffers_for(mesh, self.positions, self.points, self.normals)
        frame = self._frame
        patterns = self.cutting.patterns
        self._of_look_up = (
            mesh.corners,
            mesh.triangle_attribute_edges,
            frame.splits,
            frame.first_points,
            self.cutting.bind(self.connectivity, frame),
            patterns.counts.copy(),  # compiled code takes writable arrays faster
            patterns.subtriangles.copy(),
        )
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
        self._claim(self._criterion, *self._criterion.parts, self._scheme, *self._scheme.parts)
        self._claim(self.cutting)
        self._criterion.set_scheme(self._scheme)
        self.find_normals()
        self._criterion.bind(self.connectivity, self.rest_positions, self.normals)
        self._scheme.bind(self.connectivity, self.rest_positions, self.normals)

    @property
    def vertex_capacity(self) -> int:
        """Greatest number of output vertices: wedges, 3 points per attribute edge, and centres.

        If the criterion never changes, this is the exact number in every frame.
        """
        if self.topology is not None:
            return self.topology.vertex_count
        mesh = self.connectivity
        most_centres = len(mesh.faces) if self.cutting.has_centres else 0
        return len(mesh.wedge_vertices) + 3 * len(mesh.attribute_edges) + most_centres

    @property
    def triangle_capacity(self) -> int:
        """Greatest possible number of output triangles, by the longest row of the table.

        If the criterion never changes, this is the exact number in every frame.
        """
        if self.topology is not None:
            return len(self.topology.triangles)
        return int(self.cutting.patterns.subtriangles.shape[1] * len(self.connectivity.faces))

    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Write a frame: one line for each step of the list above."""
        if self._criterion.uses_normals or self._scheme.uses_normals:
            self.find_normals()
        self._scheme.prepare(self._frame)
        topology = self.topology
        if topology is not None:
            return self._fill_kept(stream, topology)
        self._mark(view)
        vertex_count, triangle_count = self._number()
        out = self._reserve_rows(stream, vertex_count, triangle_count)
        look_up = start_beside(lambda: self._look_up(out.triangles, out.source), triangle_count)
        try:
            self._place(out.vertices)
        finally:
            look_up()
        return vertex_count, triangle_count

    def _fill_kept(self, stream: Stream, topology: FixedTriangles) -> tuple[int, int]:
        """Write a frame whose vertices and triangles have been numbered before."""
        vertex_count = topology.vertex_count
        triangle_count = len(topology.triangles)
        out = self._reserve_rows(stream, vertex_count, triangle_count)
        if out.triangles is not topology.triangles:
            out.triangles[:triangle_count] = topology.triangles
            out.source[:triangle_count] = topology.source
        self._place(out.vertices)
        return vertex_count, triangle_count

    def _reserve_rows(self, stream: Stream, vertex_count: int, triangle_count: int) -> StreamArrays:
        """Return the arrays of a stream, and make its rows the rows of the frame."""
        out = self.reserve(stream, vertex_count, triangle_count)
        if out.vertices is not self._frame.rows:
            self._frame = self._frame._replace(rows=out.vertices)
        return out

    @cached_property
    def topology(self) -> FixedTriangles | None:
        """The triangles of all frames if the criterion never changes, else None.

        It is also None if frames depend on earlier frames (`coherent`).
        """
        if not self._criterion.is_constant or self.cutting.has_memory:
            return None
        self._mark(None)
        vertex_count, triangle_count = self._number()
        self._scheme.keep(self._frame)
        triangles = np.zeros((triangle_count, 3), dtype=np.uint32)
        source = np.zeros(triangle_count, dtype=np.int32)
        self._look_up(triangles, source)
        return FixedTriangles(vertex_count, read_only(triangles), read_only(source))

    @cached_property
    def _own_stream(self) -> OwnStream:
        """The stream for frames for which the caller lends none."""
        if self.topology is not None:
            return OwnStream.with_triangles(self.vertex_columns, *self.topology)
        return super()._own_stream

    def _mark(self, view: View | None) -> None:
        """Decide how often every edge is split (section 4.1)."""
        self._criterion.set_view(view)
        self.cutting.mark(self._criterion, self._frame, self.edge_splits)

    def _number(self) -> tuple[int, int]:
        """Assign output rows to new points, and table rows to triangles; count both.

        Raises ValueError if a criterion wants more splits than the table has.
        """
        vertex_count, triangle_count, most = number_points(*self._of_numbering)
        self._first_centre = vertex_count
        if most > MOST_SPLITS:
            raise ValueError(
                f"{type(self._criterion).__name__}.mark must write 0, 1 or 2 for every edge, "
                f"but edge {self.edge_splits.argmax()} got {most}"
            )
        return self.cutting.number(self._frame, vertex_count, triangle_count)

    def _place(self, rows: Floats32) -> None:
        """Write vertices and new points: positions, normals, attributes (section 4.2)."""
        self._scheme.place(self._frame)
        if self._values is not None:
            self.write_wedges(rows)
            copy_along_attribute_edges(self.connectivity.attribute_edges, self._frame)
            place_attributes(self.connectivity.attribute_edge_uv, self._frame, self._values.values)
        self.cutting.place(self._scheme, self._frame)

    def _look_up(self, triangles: Unsigned32, source: Integers32) -> None:
        """Write the subtriangles of every triangle (section 4.3)."""
        look_up_triangles(*self._of_look_up, self._first_centre, triangles, source)

    def complaint(self) -> str | None:
        """Describe the criterion that measured NaN in the last frame; None if there was no NaN.

        It measures again, for `refine.check`.
        """
        frame = self._frame
        return self._criterion.find_complaint(frame.positions, frame.normals, len(self.edges))

    def origins(self) -> Origins:
        """Return the place on the input mesh of every vertex of the last frame."""
        mesh = self.connectivity
        return self._origins_among(mesh.wedge_vertices, mesh.edges[mesh.attribute_edges])

    def origins_of_values(self) -> Origins:
        """Return origins whose vertices are replaced by rows of the values bound at corners.

        So the two sides of a seam have different origins. The row of a vertex without triangles is
        -1.
        """
        return self._origins_among(self.connectivity.wedge_uv, self.connectivity.attribute_edge_uv)

    def _origins_among(
        self, of_wedges: npt.NDArray[np.integer], of_ends: npt.NDArray[np.integer]
    ) -> Origins:
        """The origins, given indices of wedges, (W,), and of ends of attribute edges, (R, 2)."""
        frame = self._frame
        splits = self.edge_splits[self.connectivity.attribute_edges]
        origins = Origins.at(of_wedges).followed_by(*points_on_edges(of_ends, splits))
        with_centre = frame.centre_triangles[: frame.centre_count]
        corners = of_wedges[self.connectivity.corners[with_centre]]
        return origins.followed_by(corners, frame.centre_weights[: frame.centre_count])


def points_on_edges(
    ends: npt.NDArray[np.integer], splits: Unsigned8
) -> tuple[npt.NDArray[np.integer], Floats64]:
    """Places of the new points on edges: ends and their weights, shape (N, 3) each.

    `ends`: end points of attribute edges, shape (R, 2); `splits`: number of splits of each, (R,).
    """
    point_counts = np.array(POINTS_OF_EDGE)[splits]
    # Places of the points of a block along the edge, in quarters: x 2 x or 1 2 3.
    block_starts = np.cumsum(point_counts) - point_counts
    within = np.arange(point_counts.sum()) - np.repeat(block_starts, point_counts)
    place = np.where(np.repeat(point_counts, point_counts) == 1, 2, within + 1)
    of_points = np.repeat(ends, point_counts, axis=0)
    weights = np.column_stack([4 - place, place, np.zeros_like(place)]) / 4.0
    return np.column_stack([of_points, of_points[:, 0]]), weights
