"""The paper's refiner: split the edges that bend, smooth around them, look the triangles up.

Kähler, Haber, Seidel 2003, sections 4.1 to 4.3. One frame is:

    normals and drops   how often each edge is split                              (criterion.py)
    numbering           rows of the output for new points, lists of split edges   (output.py)
    first level         moved vertices, middle points                    (rings.py, masks.py)
    second level        quarter points, middle points moved again                  (masks.py)
    table               subtriangles of each triangle                (patterns.py, output.py)

Differs from the paper: normals of new points are interpolated linearly and then normalised; the
deformed mesh is copied once, as a shield against a simulation that runs on meanwhile.
"""

from typing import cast

import numpy as np
import numpy.typing as npt

from .binding import BoundRefiner
from .criterion import THRESHOLD_ONCE, THRESHOLD_TWICE, Criterion, NormalDrop, vertex_normals
from .masks import place_middles, place_quarters
from .output import (
    copy_rims,
    copy_wedges,
    look_up_triangles,
    number_points,
    place_texture,
)
from .patterns import (
    MAXIMUM_SUBTRIANGLES,
    MOST_SPLITS,
    POINTS_OF_EDGE,
    SUBTRIANGLE_COUNTS,
    SUBTRIANGLES,
)
from .plugin import Origins
from .rings import place_vertices, vertex_rings

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
        threshold_once: float = THRESHOLD_ONCE,
        threshold_twice: float = THRESHOLD_TWICE,
        criterion: Criterion | None = None,
    ) -> None:
        """Bind to a mesh (see `plugin.create`).

        `threshold_once`, `threshold_twice`: drop of the normal dot product above which an edge is
        split once or twice. `criterion`: another rule in place of these thresholds.
        """
        super().__init__(faces, rest_positions, uv=uv, face_uv=face_uv)
        connectivity = self.connectivity
        edge_count, rim_count = len(connectivity.edges), len(connectivity.rim_edges)
        self._rings = vertex_rings(connectivity)
        # One row more than rims: triangles without edges refer to it and find zero splits.
        self._rim_splits = np.zeros(rim_count + 1, dtype=np.uint8)
        self._edge_splits = self._rim_splits[:edge_count]
        self._splits = self._edge_splits.view()
        self._splits.flags.writeable = False
        self._first_points = np.zeros(rim_count + 1, dtype=np.uint32)
        self._middles = np.zeros((edge_count, 3), dtype=np.float32)
        self._split_once = np.zeros(edge_count + 1, dtype=np.uint32)
        self._split_twice = np.zeros(edge_count + 1, dtype=np.uint32)
        self._moved = np.zeros(connectivity.vertex_count, dtype=np.uint8)
        self._wedge_uv = self._texture_of(connectivity.wedge_uv)
        self._rim_uv = self._texture_of(connectivity.rim_uv)

        vertex_normals(self._rest_positions, connectivity.faces, self._normals)
        self._has_own_criterion = criterion is None
        self._criterion = criterion or NormalDrop(threshold_once, threshold_twice)
        self._criterion.bind(connectivity, self._rest_positions, self._normals)

    @property
    def splits(self) -> Small:
        """How often each edge was split in the last frame, shape (E,), read only."""
        return self._splits

    @property
    def vertex_capacity(self) -> int:
        """Most output vertices: every wedge, and three points on every rim."""
        return len(self.connectivity.wedge_vertices) + 3 * len(self.connectivity.rim_edges)

    @property
    def triangle_capacity(self) -> int:
        """Most output triangles: ten for each."""
        return MAXIMUM_SUBTRIANGLES * len(self.connectivity.faces)

    def _fill(
        self, vertices: Floats, triangles: Unsigned, source: npt.NDArray[np.int32]
    ) -> tuple[int, int]:
        connectivity, splits = self.connectivity, self._rim_splits
        vertex_normals(self._positions, connectivity.faces, self._normals)
        self._criterion.mark(self._positions, self._normals, self._edge_splits)
        if not self._has_own_criterion:
            self._check_splits()
        vertex_count, once_count, twice_count = number_points(
            splits,
            connectivity.edge_points,
            connectivity.rim_edges,
            len(connectivity.wedge_vertices),
            self._first_points,
            self._split_once,
            self._split_twice,
            self._moved,
        )
        self._place_points(vertices, once_count, twice_count)
        if self._uv is not None:
            self._place_seams(vertices)
        triangle_count = look_up_triangles(
            connectivity.corners,
            connectivity.triangle_rims,
            splits,
            self._first_points,
            SUBTRIANGLE_COUNTS,
            SUBTRIANGLES,
            triangles,
            source,
        )
        return vertex_count, triangle_count

    def _place_points(self, vertices: Floats, once_count: int, twice_count: int) -> None:
        """Write positions and normals: moved vertices, first level, second level."""
        rings, positions, normals = self._rings, self._positions, self._normals
        edge_points, is_interior = self.connectivity.edge_points, self.connectivity.is_interior
        first_points, middles = self._first_points, self._middles
        place_vertices(
            positions,
            normals,
            self._moved,
            rings.own,
            rings.ring,
            rings.starts,
            rings.vertices,
            vertices,
        )
        place_middles(
            positions,
            normals,
            edge_points,
            is_interior,
            first_points,
            self._split_once,
            once_count,
            middles,
            vertices,
        )
        place_quarters(
            positions,
            normals,
            edge_points,
            self.connectivity.edge_wings,
            is_interior,
            self._rim_splits,
            first_points,
            self._split_twice,
            twice_count,
            middles,
            vertices,
        )

    def _place_seams(self, vertices: Floats) -> None:
        """Copy geometry to the other sides of texture seams, and write texture coordinates."""
        mesh, splits, first_points = self.connectivity, self._rim_splits, self._first_points
        copy_wedges(mesh.vertex_count, mesh.wedge_vertices, vertices)
        copy_rims(len(mesh.edges), mesh.rim_edges, splits, first_points, vertices)
        place_texture(self._wedge_uv, self._rim_uv, splits, first_points, vertices)

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
        connectivity = self.connectivity
        point_counts = np.array(POINTS_OF_EDGE)[self._rim_splits[:-1]]
        # Place along the edge, in quarters, of the points of a block: x 2 x or 1 2 3.
        block_starts = np.cumsum(point_counts) - point_counts
        within = np.arange(point_counts.sum()) - np.repeat(block_starts, point_counts)
        place = np.where(np.repeat(point_counts, point_counts) == 1, 2, within + 1)
        ends = np.repeat(connectivity.edges[connectivity.rim_edges], point_counts, axis=0)
        wedges = connectivity.wedge_vertices.astype(np.int32)
        vertices = np.concatenate(
            [np.stack([wedges] * 3, axis=1), np.column_stack([ends, ends[:, 0]])]
        )
        weights = np.zeros(vertices.shape, dtype=np.float32)
        weights[: len(wedges), 0] = 1.0
        weights[len(wedges) :, 0] = (4 - place) / 4.0
        weights[len(wedges) :, 1] = place / 4.0
        return Origins(cast(npt.NDArray[np.int32], vertices), weights)
