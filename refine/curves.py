r"""What the interpolating schemes share: edges that bulge between end points that stay.

A scheme says how far the points of a split edge stand out of the straight edge, its *bulge*; this
pass puts them there, as far as they have grown (blend.py), with their normals.

                 .  m  .                 m      =  (a + b) / 2          +  bulge
              n           n              n at a =  (3 a + b) / 4        +  bulge
            a---------------b            grown   =  mix of (a + m) / 2 and n

The normal at m is the mean of those at a and b, turned until it stands upright on the curve there:
an S that ends as it began has the same normals at both ends and another one in between (Vlachos et
al. 2001, "Curved PN triangles", have quadratic normals for the same reason). It does so as far as
the edges of both triangles have grown: beside a triangle that has no such normals a single one is
seen as a scar. At n the normal is the mean of its neighbours'.

Kähler, Haber, Seidel 2003, section 4.2 asks for rules that are cheap, local, close to the input
mesh, and correct at borders; these are all, and leave every vertex where the simulation has it.
"""

import numpy as np
import numpy.typing as npt

from .connectivity import Connectivity
from .kernels import kernel
from .output import place_unmoved
from .schemes import Frame

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

ZERO = np.float32(0.0)
QUARTER = np.float32(0.25)
HALF = np.float32(0.5)
THREE_QUARTERS = np.float32(0.75)
ONE = np.float32(1.0)
TINY = np.finfo(np.float32).tiny

UPRIGHT = np.float32(0.95)
"""How much of its slope along the curve a normal in the middle of an edge loses. Chosen: all but a
rest, so that one that lies along the edge keeps a direction."""
NEAR_START, MIDDLE, NEAR_END = 0, 1, 2
"""Points of an edge in an array of bulges, shape (E, 3, 3): edge, point, x y z."""


class CurveScheme:
    """A scheme whose original vertices stay and whose edges are curves; fill in `_bulge`."""

    interpolates = True
    turns: Floats | None = None
    """How much a split would mend in normals [rad] at every edge, shape (E,), if that is known."""

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: Doubles,
        rest_normals: Floats,
    ) -> None:
        """Take the mesh; `rest_positions` and `rest_normals`, shape (V, 3)."""
        self._connectivity = connectivity
        self._bulges = np.zeros((len(connectivity.edges), 3, 3), dtype=np.float32)
        self._everything: Frame | None = None

    def place(self, frame: Frame) -> None:
        """Write vertices as they are, and the points of split edges on their curves."""
        self._bulge(frame, self._bulges)
        place_unmoved(frame.points, self._vertex_normals(frame), frame.rows)
        place_on_curves(
            self._connectivity.edge_points,
            self._connectivity.edge_wings,
            self._connectivity.is_interior,
            frame.splits,
            frame.growth_once,
            frame.growth_twice,
            frame.first_points,
            frame.split_once,
            frame.once_count,
            self._bulges,
            frame.rows,
        )

    def all_bulges(self, positions: Doubles, normals: Floats) -> Floats:
        """Bulges of all edges as if each were split once, shape (E, 3, 3): middles are number 1.

        For criteria that ask how far an edge is from where it should be. The array is the one that
        `place` uses.
        """
        frame = self._everything
        if frame is None or frame.positions is not positions or frame.normals is not normals:
            edge_count = len(self._bulges)
            none = np.zeros(0, dtype=np.float32)
            every_edge = np.arange(edge_count, dtype=np.uint32)
            frame = self._everything = Frame(
                positions=positions,
                points=none,
                normals=normals,
                splits=np.ones(edge_count, dtype=np.uint8),
                growth_once=none,
                growth_twice=none,
                first_points=every_edge,
                split_once=every_edge,
                split_twice=every_edge,
                rows=none,
                counts=np.array([0, edge_count, 0, 0]),
            )
        self._bulge(frame, self._bulges)
        return self._bulges

    def place_centres(self, frame: Frame) -> None:
        """Leave them as blending has them."""

    def _vertex_normals(self, frame: Frame) -> Floats:
        """Return the normals that the vertices get in the output, shape (V, 3)."""
        return frame.normals

    def _bulge(self, frame: Frame, bulges: Floats) -> None:
        """Write the bulges of the split edges; of those split once the middle is enough."""
        raise NotImplementedError


@kernel
def unit(x: np.float32, y: np.float32, z: np.float32) -> tuple[np.float32, np.float32, np.float32]:
    """Normalise a vector; zero stays zero."""
    scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
    return x * scale, y * scale, z * scale


@kernel
def stand_upright(
    vertices: Floats,
    a: np.uint32,
    b: np.uint32,
    row: np.uint32,
    has_quarters: bool,
    share: np.float32,
) -> None:
    """Write the normal of the middle of an edge: the mean, less a share of its slope."""
    start, end = (row - 1, row + 1) if has_quarters else (a, b)
    along = slope = ZERO
    for i in range(3):
        d = vertices[end, i] - vertices[start, i]
        along += d * d
        slope += d * (vertices[a, 3 + i] + vertices[b, 3 + i])
    slope *= share / max(along, TINY)
    vertices[row, 3], vertices[row, 4], vertices[row, 5] = unit(
        vertices[a, 3] + vertices[b, 3] - slope * (vertices[end, 0] - vertices[start, 0]),
        vertices[a, 4] + vertices[b, 4] - slope * (vertices[end, 1] - vertices[start, 1]),
        vertices[a, 5] + vertices[b, 5] - slope * (vertices[end, 2] - vertices[start, 2]),
    )


@kernel
def place_on_curves(
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    growth_twice: Floats,
    first_points: Unsigned,
    split_once: Unsigned,
    once_count: int,
    bulges: Floats,
    vertices: Floats,
) -> None:
    """Write the one or three points of every split edge; the vertices are there already."""
    for k in range(once_count):
        e = split_once[k]
        a, b = edge_points[e, 0], edge_points[e, 1]
        row, growth = np.uint32(first_points[e] + (splits[e] >> 1)), growth_once[e]
        for i in range(3):
            straight = HALF * (vertices[a, i] + vertices[b, i])
            vertices[row, i] = straight + growth * bulges[e, MIDDLE, i]
        if splits[e] == 2:
            growth = growth_twice[e]
            for end in range(2):
                near, far = (a, b) if end == 0 else (b, a)
                point = np.uint32(row - 1 + 2 * end)
                for i in range(3):
                    chord = HALF * (vertices[near, i] + vertices[row, i])
                    straight = THREE_QUARTERS * vertices[near, i] + QUARTER * vertices[far, i]
                    on_curve = straight + bulges[e, NEAR_START + 2 * end, i]
                    vertices[point, i] = (ONE - growth) * chord + growth * on_curve
        share = growth_once[e]
        if is_interior[e]:
            for i in range(4):
                wing = edge_wings[e, i]
                share = min(share, growth_once[wing] if splits[wing] > 0 else ZERO)
        stand_upright(vertices, a, b, row, splits[e] == 2, UPRIGHT * share)
        if splits[e] == 2:
            for end in range(2):
                near, point = a if end == 0 else b, row - 1 + 2 * end
                vertices[point, 3], vertices[point, 4], vertices[point, 5] = unit(
                    vertices[near, 3] + vertices[row, 3],
                    vertices[near, 4] + vertices[row, 4],
                    vertices[near, 5] + vertices[row, 5],
                )
