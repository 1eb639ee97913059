"""The paper's refiner: split the edges that bend, smooth around them, look the triangles up.

Kähler, Haber, Seidel 2003, sections 4.1 to 4.3. One frame is:

    normals     of the deformed mesh                                       (normals.py)
    mark        how often each edge is split                (criterion.py, criteria.py)
    number      lists of split edges, rows for new points                   (output.py)
    place       moved vertices, first level, second level                  (schemes.py)
    look up     subtriangles of each triangle                 (patterns.py, output.py)

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
from .binding import BoundRefiner
from .blend import grow, number_centres, place_centres
from .choices import scheme_of
from .coherence_pass import Coherent
from .criteria import criterion_of
from .criterion import THRESHOLD_ONCE, THRESHOLD_TWICE, Criterion, Measured, NormalDrop
from .detail import FinerMesh
from .frame import CENTRES, ROWS, TRIANGLES, Frame
from .normals import vertex_normals
from .output import look_up_triangles, number_points
from .patterns import (
    CONFIGURATIONS,
    FANS,
    MAXIMUM_FAN,
    MAXIMUM_SUBTRIANGLES,
    MOST_SPLITS,
    POINTS_OF_EDGE,
)
from .plugin import Origins, Stream, View
from .schemes import Scheme

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
        `scheme`: "loop", the paper's, "cubic", "detail", or an object.
        `detail`: for "detail" the finer mesh at rest, its positions and its triangles.
        `blend`: whether points grow out of their edges, so that nothing pops. None stands for what
        costs nothing in faithfulness: True for the schemes that interpolate, False for the paper's.
        `coherent`: whether triangulations continue those of the frame before (section 4.4).
        """
        self._scheme = scheme_of(scheme, detail)
        self._criterion = criterion_of(criterion, NormalDrop(threshold_once, threshold_twice))
        super().__init__(faces, rest_positions, uv=uv, face_uv=face_uv, attributes=attributes)
        mesh = self.connectivity
        self._blend = self._is_blended(blend, coherent)
        if hasattr(self._criterion, "use"):
            self._criterion.use(self._scheme)
        self._looks = hasattr(self._criterion, "look")
        self._is_foreign = not isinstance(self._criterion, NormalDrop)
        self.history = Coherent(len(mesh.faces)) if coherent else None
        """What triangles remember of their splits, as they are walked; None unless `coherent`."""
        self._patterns = FANS if self._blend else CONFIGURATIONS
        if self.history is not None:
            self._patterns = self.history.patterns
        self._frame = self._make_frame()
        self._need = np.zeros(len(mesh.edges) if self._blend else 0, dtype=np.float32)
        self._edge_splits = self._frame.splits[: len(mesh.edges)]
        self._splits = self._edge_splits.view()
        self._splits.flags.writeable = False
        vertex_normals(self._positions, mesh.faces, self._normals)
        self._criterion.bind(mesh, self._rest_positions, self._normals)
        self._scheme.bind(mesh, self._rest_positions, self._normals)

    def _is_blended(self, blend: bool | None, coherent: bool) -> bool:
        """Whether frames are blended; ValueError for what does not go together."""
        for name, flag in (("blend", blend), ("coherent", coherent)):
            if flag not in (None, True, False):
                raise ValueError(f"{name} must be True or False, got {flag!r}")
        measures = isinstance(self._criterion, Measured)
        if blend is None:
            return self._scheme.interpolates and not coherent and measures
        if blend and coherent:
            raise ValueError(
                "coherent=True continues the triangulations of the frame before; with blend=True "
                "none ever turns a diagonal; ask for one of the two"
            )
        if blend and not measures:
            raise ValueError(
                f"blend=True needs a criterion that measures, but {type(self._criterion).__name__} "
                "has no method measure(positions, normals, need)"
            )
        return bool(blend)

    def _make_frame(self) -> Frame:
        mesh = self.connectivity
        edge_count, rim_count, face_count = len(mesh.edges), len(mesh.rim_edges), len(mesh.faces)
        return Frame(
            positions=self._positions,
            points=self._points,
            normals=self._normals,
            # One more than rims: triangles without edges refer to it and find zero splits.
            splits=np.zeros(rim_count + 1, dtype=np.uint8),
            growth_once=np.ones(edge_count, dtype=np.float32),
            growth_twice=np.ones(edge_count, dtype=np.float32),
            first_points=np.zeros(rim_count + 1, dtype=np.uint32),
            split_once=np.zeros(edge_count + 1, dtype=np.uint32),
            split_twice=np.zeros(edge_count + 1, dtype=np.uint32),
            configurations=np.zeros(face_count + 1, dtype=np.uint16),
            centre_triangles=np.zeros(face_count + 1 if self._blend else 0, dtype=np.uint32),
            counts=np.zeros(5, dtype=np.int64),
            rows=np.zeros((0, self.vertex_columns), dtype=np.float32),
        )

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

    def _fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        self._mark(view)
        rows_of_table = self._number()
        counts = self._frame.counts
        vertex_count, triangle_count = int(counts[ROWS] + counts[CENTRES]), int(counts[TRIANGLES])
        vertices, triangles, source = self._reserve(stream, vertex_count, triangle_count)
        if vertices is not self._frame.rows:
            self._frame = self._frame._replace(rows=vertices)
        self._place()
        look_up_triangles(
            self.connectivity, self._frame, self._patterns, rows_of_table, triangles, source
        )
        return vertex_count, triangle_count

    def _mark(self, view: View | None) -> None:
        """Decide on the splits of every edge, and how far their points have grown."""
        criterion, frame = self._criterion, self._frame
        if self._looks:
            criterion.look(view)  # type: ignore[attr-defined]
        if self._blend:
            cast(Measured, criterion).measure(frame.positions, frame.normals, self._need)
            grow(self._need, self._edge_splits, frame.growth_once, frame.growth_twice)
        else:
            criterion.mark(frame.positions, frame.normals, self._edge_splits)
            if self._is_foreign:
                self._check_splits()

    def _number(self) -> npt.NDArray[np.uint16]:
        """List and count what the frame has; return the row of the table for each triangle."""
        frame = self._frame
        number_points(self.connectivity, frame)
        if self._blend:
            number_centres(frame, self._patterns)
        if self.history is not None:
            return self.history.follow(frame.configurations)
        return frame.configurations

    def _place(self) -> None:
        """Write the rows of the frame: positions, normals, attributes."""
        frame = self._frame
        self._scheme.place(frame)
        self._write_values(frame)
        if self._blend:
            place_centres(self.connectivity, frame)
            self._scheme.place_centres(frame)

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
        point_counts = np.array(POINTS_OF_EDGE)[frame.splits[:-1]]
        # Place along the edge, in quarters, of the points of a block: x 2 x or 1 2 3.
        block_starts = np.cumsum(point_counts) - point_counts
        within = np.arange(point_counts.sum()) - np.repeat(block_starts, point_counts)
        place = np.where(np.repeat(point_counts, point_counts) == 1, 2, within + 1)
        ends = np.repeat(self.edges[mesh.rim_edges], point_counts, axis=0)
        wedges = mesh.wedge_vertices.astype(np.int32)
        vertices = [np.stack([wedges] * 3, axis=1), np.column_stack([ends, ends[:, 0]])]
        weights = [np.zeros((len(wedges), 3)), np.zeros((len(ends), 3))]
        weights[0][:, 0] = 1.0
        weights[1][:, 0], weights[1][:, 1] = (4 - place) / 4.0, place / 4.0
        if frame.is_blended:
            centres = frame.centre_triangles[: frame.centre_count]
            vertices.append(wedges[mesh.corners[centres]])
            weights.append(np.full((frame.centre_count, 3), 1.0 / 3.0))
        return Origins(
            np.concatenate(vertices).astype(np.int32), np.concatenate(weights).astype(np.float32)
        )
