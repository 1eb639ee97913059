"""The paper's refiner: split the edges that bend, smooth around them, look the triangles up.

Kähler, Haber, Seidel 2003, sections 4.1 to 4.3. One frame is:

    normals and drops   how often each edge is split                (criterion.py, criteria.py)
    numbering           lists of split edges, rows for new points                 (output.py)
    points              moved vertices, first level, second level                (schemes.py)
    table               subtriangles of each triangle               (patterns.py, output.py)

By default this is the paper to the letter. Options put other criteria and smoothing schemes in
place, and blend new points in (blend.py).

Differs from the paper: normals of new points are interpolated linearly and then normalised; the
deformed mesh is copied once, as a shield against a simulation that runs on meanwhile.
"""

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np
import numpy.typing as npt

from .arguments import AttributeLike
from .binding import BoundRefiner, Rows
from .blend import grow, number_centres, place_centres
from .choices import marking_of, may_renumber, measuring_of, placing_of, scheme_of
from .coherence_pass import Coherent
from .criteria import criterion_of
from .criterion import (
    THRESHOLD_ONCE,
    THRESHOLD_TWICE,
    Criterion,
    Measured,
    NormalDrop,
)
from .detail import FinerMesh
from .native import Call, Turns
from .output import (
    CENTRE,
    NO_ROOM,
    look_up_triangles,
    number_points,
    overflow,
)
from .patterns import (
    CONFIGURATIONS,
    FANS,
    MAXIMUM_FAN,
    MAXIMUM_SUBTRIANGLES,
    MOST_SPLITS,
    POINTS_OF_EDGE,
)
from .plugin import Origins, Stream, View
from .schemes import Frame, Scheme

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]
Small = npt.NDArray[np.uint8]


class Kahler(BoundRefiner):
    """Refinement after Kähler, Haber, Seidel 2003; the refiner named `kahler`."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        uv: npt.ArrayLike | None = None,
        face_uv: npt.ArrayLike | None = None,
        attributes: Mapping[str, AttributeLike] | None = None,
        threshold_once: float = THRESHOLD_ONCE,
        threshold_twice: float = THRESHOLD_TWICE,
        criterion: str | Criterion | Sequence[str | Criterion] = "normal",
        scheme: str | Scheme = "loop",
        detail: FinerMesh | None = None,
        blend: bool | None = None,
        coherent: bool = False,
    ) -> None:
        """Bind to a mesh (see `plugin.create`).

        `threshold_once`, `threshold_twice`: drop of the normal dot product above which an edge is
        split once or twice, for the paper's criterion, "normal".
        `criterion`: "normal", "curvature", "rest", "silhouette", "screen", "bulge", an object, or a
        list of them, of which the one counts that asks for most; "normal+rest" is such a list.
        `scheme`: "loop", the paper's, "butterfly", "cubic", "detail", or an object.
        `detail`: for "detail" the finer mesh at rest, its positions and its triangles.
        `blend`: whether points grow out of their edges, so that nothing pops. None stands for what
        costs nothing in faithfulness: True for the schemes that interpolate, False for the paper's.
        `coherent`: whether triangulations continue those of the frame before (section 4.4).
        """
        for name, flag in (("blend", blend), ("coherent", coherent)):
            if flag not in (None, True, False):
                raise ValueError(f"{name} must be True or False, got {flag!r}")
        self._scheme = scheme_of(scheme, detail)
        self._criterion = criterion_of(criterion, NormalDrop(threshold_once, threshold_twice))
        super().__init__(
            faces,
            rest_positions,
            uv=uv,
            face_uv=face_uv,
            attributes=attributes,
            may_renumber=may_renumber(self._scheme, self._criterion),
        )
        mesh = self.connectivity
        if blend is None:
            blend = self._scheme.interpolates and not coherent
            blend = blend and isinstance(self._criterion, Measured)
        if hasattr(self._criterion, "use"):
            self._criterion.use(self._scheme)
        self._looks = hasattr(self._criterion, "look")
        self._is_foreign = not isinstance(self._criterion, NormalDrop)
        self._blend = blend
        if blend and coherent:
            raise ValueError(
                "coherent=True continues the triangulations of the frame before; with blend=True "
                "none ever turns a diagonal; ask for one of the two"
            )
        self.history = Coherent(len(mesh.faces)) if coherent else None
        """What triangles remember of their splits, as they are walked; None unless `coherent`."""
        self._patterns = FANS if blend else CONFIGURATIONS
        if self.history is not None:
            self._patterns = self.history.patterns
        if blend and not isinstance(self._criterion, Measured):
            raise ValueError(
                f"blend=True needs a criterion that measures, but {type(self._criterion).__name__} "
                "has no method measure(positions, normals, need)"
            )
        self._make_buffers()
        self._find_normals()
        self._criterion.bind(mesh, self._rest_positions, self._normals)
        self._scheme.bind(mesh, self._rest_positions, self._normals)
        self._bind_passes()

    def _make_buffers(self) -> None:
        mesh = self.connectivity
        edge_count, rim_count = len(mesh.edges), len(mesh.rim_edges)
        # One row more than rims: triangles without edges refer to it and find zero splits.
        self._rim_splits = np.zeros(rim_count + 1, dtype=np.uint8)
        self._edge_splits = self._rim_splits[:edge_count]
        self._splits = self._edge_splits.view()
        self._splits.flags.writeable = False
        self._configurations = np.zeros(len(mesh.faces) + 1, dtype=np.uint16)
        self._triangle_configurations = self._configurations[:-1]
        self._need = np.zeros(edge_count if self._blend else 0, dtype=np.float32)
        self._frame = Frame(
            positions=self._positions,
            points=self._points,
            normals=self._normals,
            splits=self._rim_splits,
            growth_once=np.ones(edge_count, dtype=np.float32),
            growth_twice=np.ones(edge_count, dtype=np.float32),
            first_points=np.zeros(rim_count + 1, dtype=np.uint32),
            split_once=np.zeros(edge_count + 1, dtype=np.uint32),
            split_twice=np.zeros(edge_count + 1, dtype=np.uint32),
            rows=np.zeros((0, self.vertex_columns), dtype=np.float32),
        )
        if self._blend:
            self._frame.centre_triangles = np.zeros(len(mesh.faces) + 1, dtype=np.uint32)

    def _bind_passes(self) -> None:
        """Bind the compiled passes of a frame to their arguments, and join what can be joined.

        With the paper's criterion, and any scheme but `butterfly`, a frame is one call of compiled
        code, and another only where it needs more room than there is.
        """
        self._drawn_to: Rows | None = None
        marking, numbering, draws = (
            self._bind_marking(),
            self._bind_numbering(),
            self._bind_drawing(),
        )
        self._writes = [call for call in draws if call.takes("vertices")]
        self._draw, self._number = Turns(*draws), Turns(*numbering)
        self._is_marked = marking is not None
        self._is_whole = self._is_marked and self._is_placed
        if marking is not None:
            begin = [self._take_in, self._find_normals, *marking, *numbering]
            if self._is_whole:
                begin += [overflow.bind(self._frame.counts, self._room), *draws]
            self._begin = Turns(*begin)

    def _bind_numbering(self) -> list[Call]:
        """Return the calls that list and count what a frame has, and find the rows of the table."""
        mesh, frame, patterns = self.connectivity, self._frame, self._patterns
        number = number_points.bind(
            self._rim_splits,
            mesh.rim_edges,
            mesh.edge_sides,
            mesh.more_sides,
            len(mesh.wedge_vertices),
            frame.first_points,
            frame.split_once,
            frame.split_twice,
            self._configurations,
            frame.counts,
        )
        if self.history is not None:
            return [number, self.history.following(self._triangle_configurations)]
        if frame.centre_triangles is None:
            return [number]
        centres = number_centres.bind(
            self._triangle_configurations,
            patterns.counts,
            patterns.subtriangles,
            CENTRE,
            frame.centre_triangles,
            frame.counts,
        )
        return [number, centres]

    def _bind_drawing(self) -> list[Call]:
        """Return the calls that write points, if the scheme is compiled, and triangles."""
        mesh, frame, patterns = self.connectivity, self._frame, self._patterns
        self._look_up_triangles = look_up_triangles.bind(
            self._output_corners,
            mesh.triangle_rims,
            self._rim_splits,
            frame.first_points,
            frame.counts,
            self._triangle_configurations if self.history is None else self.history.states,
            patterns.counts,
            patterns.subtriangles,
            np.zeros(CENTRE + 1, dtype=np.uint32),
            np.zeros((0, 3), dtype=np.uint32),
            np.zeros(0, dtype=np.int32),
        )
        placing, raising = placing_of(self._scheme, frame) or ([], [])
        self._is_placed = len(placing) > 0
        values = self._bind_values(mesh, self._rim_splits, frame.first_points)
        draws = [*placing, *values, self._look_up_triangles]
        if frame.centre_triangles is not None:
            centres = place_centres.bind(
                mesh.faces,
                mesh.corners,
                mesh.triangle_edges,
                self._rim_splits,
                frame.growth_once,
                frame.first_points,
                frame.centre_triangles,
                frame.counts,
                frame.rows,
            )
            draws += [centres, *raising]
        return draws

    def _bind_marking(self) -> list[Call] | None:
        """Return the calls that decide on splits and growth; None if the criterion is Python."""
        if not self._blend:
            return marking_of(self._criterion, self._normals, self._edge_splits)
        frame = self._frame
        self._grow = grow.bind(self._need, self._edge_splits, frame.growth_once, frame.growth_twice)
        measuring = measuring_of(self._criterion, self._normals, self._need)
        return None if measuring is None else [measuring, self._grow]

    @property
    def splits(self) -> Small:
        """How often each edge was split in the last frame, shape (E,), read only."""
        return self._splits

    @property
    def vertex_capacity(self) -> int:
        """Most output vertices: every wedge, three points on every rim, centres when blending."""
        mesh = self.connectivity
        centres = len(mesh.faces) if self._blend else 0
        return len(mesh.wedge_vertices) + 3 * len(mesh.rim_edges) + centres

    @property
    def triangle_capacity(self) -> int:
        """Most output triangles: ten for each, twelve when blending."""
        most = MAXIMUM_FAN if self._blend else MAXIMUM_SUBTRIANGLES
        return most * len(self.connectivity.faces)

    def _fill(self, stream: Stream, view: View | None, begun: int) -> tuple[int, int]:
        frame = self._frame
        if not self._is_marked:
            self._mark(view)
            self._number()
        vertex_count, _, _, triangle_count, centre_count = frame.counts.tolist()
        vertex_count += centre_count
        if self._is_whole and begun != NO_ROOM:
            return vertex_count, triangle_count
        self._draw_to(stream, self._reserve(stream, vertex_count, triangle_count))
        if not self._is_placed:
            self._scheme.place(frame)
        self._draw()
        if self._blend and not self._is_placed:
            self._scheme.place_centres(frame)
        return vertex_count, triangle_count

    def _draw_to(self, stream: Stream, rows: Rows) -> None:
        """Hand the rows of the output to the passes that write them.

        Where nobody has to be asked for room in every frame, the next one may write there at once.
        """
        if stream is self._own_stream or not hasattr(stream, "reserve"):
            self._written = stream, rows
            self._room[:] = len(rows[0]), len(rows[1])
        if rows is self._drawn_to:
            return
        self._drawn_to = rows
        self._frame.rows, triangles, source = rows
        self._look_up_triangles.put("triangles", triangles)
        self._look_up_triangles.put("source", source)
        for call in self._writes:
            call.put("vertices", self._frame.rows)

    def _mark(self, view: View | None) -> None:
        """Decide on the splits of every edge, and how far their points have grown."""
        criterion = self._criterion
        if self._looks:
            criterion.look(view)  # type: ignore[attr-defined]
        if self._blend:
            cast(Measured, criterion).measure(self._positions, self._normals, self._need)
            self._grow()
            return
        criterion.mark(self._positions, self._normals, self._edge_splits)
        if self._is_foreign:
            self._check_splits()

    def _check_splits(self) -> None:
        """Raise ValueError if a criterion from outside asks for more than the table has."""
        most = self._edge_splits.max(initial=0)
        if most > MOST_SPLITS:
            raise ValueError(
                f"{type(self._criterion).__name__}.mark must write 0, 1 or 2 for every edge, "
                f"but edge {self._edge_splits.argmax()} got {most}"
            )

    def origins(self) -> Origins:
        """Say for every vertex of the last frame where it lies on the input mesh."""
        mesh, frame = self.connectivity, self._frame
        point_counts = np.array(POINTS_OF_EDGE)[self._rim_splits[:-1]]
        # Place along the edge, in quarters, of the points of a block: x 2 x or 1 2 3.
        block_starts = np.cumsum(point_counts) - point_counts
        within = np.arange(point_counts.sum()) - np.repeat(block_starts, point_counts)
        place = np.where(np.repeat(point_counts, point_counts) == 1, 2, within + 1)
        ends = np.repeat(self.edges[mesh.rim_edges], point_counts, axis=0)
        wedges = self._wedge_names()
        vertices = [np.stack([wedges] * 3, axis=1), np.column_stack([ends, ends[:, 0]])]
        weights = [np.zeros((len(wedges), 3)), np.zeros((len(ends), 3))]
        weights[0][:, 0] = 1.0
        weights[1][:, 0], weights[1][:, 1] = (4 - place) / 4.0, place / 4.0
        if frame.centre_triangles is not None:
            centres = frame.centre_triangles[: frame.centre_count]
            vertices.append(wedges[self._output_corners[centres]])
            weights.append(np.full((frame.centre_count, 3), 1.0 / 3.0))
        return Origins(
            np.concatenate(vertices).astype(np.int32), np.concatenate(weights).astype(np.float32)
        )
