"""Smoothing schemes: what decides where the points of split edges go.

Kähler, Haber, Seidel 2003, section 6: "it would be interesting to investigate the effects of other
smoothing schemes, since we currently don't interpolate, but only approximate". So a scheme is one
small class, bound once to the mesh and called once in every frame, when it is known which edges are
split and where in the output their points go:

    loop        the paper's rules (masks.py); original vertices at split edges move
    butterfly   modified butterfly subdivision (butterfly.py); original vertices stay
    cubic       cubic edges from end points and normals (cubic.py); original vertices stay
    detail      cubic, plus what a finer mesh at rest has in addition (detail.py)
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import numpy.typing as npt

from .connectivity import Connectivity
from .masks import ALL_GROWN, place_points
from .native import Call, Turns, has_room
from .rings import vertex_rings

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]
Bind = Callable[["Frame"], list[Call]]


@dataclass
class Frame:
    """What a scheme reads and writes; the arrays stay the same from frame to frame but `rows`."""

    positions: npt.NDArray[np.float64]
    """Deformed vertex positions, shape (V, 3)."""
    points: Floats
    """The same in single precision, which is enough for all but differences."""
    normals: Floats
    """Their unit normals, shape (V, 3)."""
    splits: npt.NDArray[np.uint8]
    """Splits of every rim, edges first."""
    growth_once: Floats
    """How far the middle point of an edge has grown, 0 to 1 (blend.py), shape (E,).

    All ones without blending, and then without a meaning where no point is.
    """
    growth_twice: Floats
    """How far its quarter points have."""
    first_points: Unsigned
    """Output row of the first point of every split rim."""
    split_once: Unsigned
    """The edges that are split; the first `once_count` count."""
    split_twice: Unsigned
    """The edges that are split twice; the first `twice_count` count."""
    rows: Floats
    """The output: x y z, nx ny nz, attributes; row v is vertex v."""
    counts: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(5, dtype=np.int64))
    """Numbers of output rows without centres, of edges that are split, of those split twice, of
    subtriangles, and of centres, shape (5,)."""
    centre_triangles: Unsigned | None = None
    """The triangles with a point in the middle, only with blending; `centre_count` of them."""
    _bound: dict[Bind, tuple[list[Call], Turns]] = field(
        default_factory=dict, init=False, repr=False
    )

    @property
    def first_centre(self) -> int:
        """Output row of the first of these points."""
        return int(self.counts[0])

    @property
    def centre_count(self) -> int:
        """How many triangles have a point in the middle."""
        return int(self.counts[4])

    @property
    def once_count(self) -> int:
        """How many edges are split."""
        return int(self.counts[1])

    @property
    def is_blended(self) -> bool:
        """Whether points grow out of their edges, instead of being there or not."""
        return self.centre_triangles is not None

    def bound(self, bind: Bind) -> Turns:
        """Return what `bind` makes of this frame, made once; it writes to the rows of now."""
        found = self._bound.get(bind)
        if found is None:
            calls = bind(self)
            found = [call for call in calls if call.takes("vertices")], Turns(*calls)
            self._bound[bind] = found
        for call in found[0]:
            call.put("vertices", self.rows)
        return found[1]

    @property
    def growth(self) -> tuple[Floats, Floats]:
        """Growth once and twice as compiled code takes it (masks.py), shape (E, 1) or (0, 0)."""
        if not self.is_blended:
            return ALL_GROWN, ALL_GROWN
        return self.growth_once[:, None], self.growth_twice[:, None]

    @property
    def twice_count(self) -> int:
        """How many edges are split twice."""
        return int(self.counts[2])


class Scheme(Protocol):
    """Places points; anything with these members can take the place of the built-in schemes."""

    @property
    def interpolates(self) -> bool:
        """Whether the original vertices stay where they are."""

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: npt.NDArray[np.float64],
        rest_normals: Floats,
    ) -> None:
        """Learn the mesh: `rest_positions` and `rest_normals`, shape (V, 3)."""

    def place(self, frame: Frame) -> None:
        """Write positions and normals of vertices and of points on split edges into the rows."""

    def place_centres(self, frame: Frame) -> None:
        """Correct the points in the middle of triangles, which have been written already."""


class LoopScheme:
    """The paper's scheme: Loop's rules with Warren's weights (section 4.2)."""

    interpolates = False

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: npt.NDArray[np.float64],
        rest_normals: Floats,
    ) -> None:
        """Work out the weights of every vertex."""
        self._connectivity = connectivity
        self._rings = vertex_rings(connectivity)
        self._vertex_growth = np.zeros(connectivity.vertex_count, dtype=np.float32)
        self._middles = np.zeros((len(connectivity.edges), 4), dtype=np.float32)

    def place(self, frame: Frame) -> None:
        """Write moved vertices, first level, second level."""
        frame.bound(self.placing)()

    def placing(self, frame: Frame) -> list[Call]:
        """Return the call that places points in the arrays of a frame; `vertices` are its rows."""
        assert has_room(frame.points) and has_room(frame.normals)
        mesh, rings = self._connectivity, self._rings
        placing = place_points.bind(
            frame.points,
            frame.normals,
            mesh.edge_points,
            mesh.edge_wings,
            mesh.is_interior,
            rings.own,
            rings.ring,
            rings.near,
            rings.starts,
            rings.others,
            frame.splits,
            *frame.growth,
            frame.first_points,
            frame.split_once,
            frame.split_twice,
            frame.counts,
            self._vertex_growth,
            self._middles,
            frame.rows,
        )
        return [placing]

    def raising(self, frame: Frame) -> list[Call]:
        """Return no call: points in the middle of triangles stay as blending has them."""
        return []

    def place_centres(self, frame: Frame) -> None:
        """Leave them as blending has them."""
