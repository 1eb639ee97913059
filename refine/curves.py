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
from .lanes import four, write
from .masks import grown, growth_of, write_normal
from .native import Call, has_room, native, with_room
from .normals import unit
from .output import place_unmoved
from .schemes import Frame

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

ZERO = np.float32(0.0)
QUARTER = np.float32(0.25)
HALF = np.float32(0.5)
THREE_QUARTERS = np.float32(0.75)
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
        self._bulge_rows = with_room(np.zeros((3 * len(connectivity.edges), 3), dtype=np.float32))
        self._bulges = self._bulge_rows.reshape(-1, 3, 3)
        self._everything: Frame | None = None

    def place(self, frame: Frame) -> None:
        """Write vertices as they are, and the points of split edges on their curves."""
        self._bulge(frame, self._bulges)
        frame.bound(self._bind_pointing)()

    def _bind_pointing(self, frame: Frame) -> list[Call]:
        """Return the call that writes all rows of a frame when bulges and normals are there."""
        assert has_room(frame.points)
        mesh = self._connectivity
        pointing = place_on_curves.bind(
            frame.points,
            self._vertex_normals(frame),
            mesh.edge_points,
            mesh.edge_wings,
            mesh.is_interior,
            frame.splits,
            *frame.growth,
            frame.first_points,
            frame.split_once,
            frame.counts,
            self._bulge_rows,
            frame.rows,
        )
        return [pointing]

    def all_bulges(self, positions: Doubles, normals: Floats) -> Floats:
        """Bulges of all edges as if each were split once, shape (E, 3, 3): middles are number 1.

        For criteria that ask how far an edge is from where it should be. The array is the one that
        `place` uses.
        """
        self._bulge(self._every_edge(positions, normals), self._bulges)
        return self._bulges

    def _every_edge(self, positions: Doubles, normals: Floats) -> Frame:
        """Return a frame in which each edge is split once; the same for the same arrays."""
        if not has_room(positions):
            positions = with_room(positions)
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
                counts=np.array([0, edge_count, 0, 0, 0]),
            )
        return frame

    def place_centres(self, frame: Frame) -> None:
        """Leave them as blending has them."""

    def _vertex_normals(self, frame: Frame) -> Floats:
        """Return the array of the normals that vertices get in the output, shape (V, 3)."""
        return frame.normals

    def _bulge(self, frame: Frame, bulges: Floats) -> None:
        """Write the bulges of the split edges; of those split once the middle is enough."""
        raise NotImplementedError


@native
def stand_upright(
    vertices: Floats,
    a: np.uint32,
    b: np.uint32,
    row: np.uint32,
    has_quarters: bool,
    share: np.float32,
) -> None:
    """Write the normal of the middle of an edge: the mean, less a share of its slope."""
    start = np.uint32(row - 1) if has_quarters else a
    end = np.uint32(row + 1) if has_quarters else b
    along = slope = ZERO
    for i in range(3):
        d = vertices[end, i] - vertices[start, i]
        along += d * d
        slope += d * (vertices[a, 3 + i] + vertices[b, 3 + i])
    slope *= share / max(along, TINY)
    x, y, z = unit(
        vertices[a, 3] + vertices[b, 3] - slope * (vertices[end, 0] - vertices[start, 0]),
        vertices[a, 4] + vertices[b, 4] - slope * (vertices[end, 1] - vertices[start, 1]),
        vertices[a, 5] + vertices[b, 5] - slope * (vertices[end, 2] - vertices[start, 2]),
    )
    write_normal(vertices, row, x, y, z)


@native
def turn_quarter(vertices: Floats, end: np.uint32, middle: np.uint32, row: np.uint32) -> None:
    """Write the normal of a quarter point: the mean of its neighbours'."""
    x, y, z = unit(
        vertices[end, 3] + vertices[middle, 3],
        vertices[end, 4] + vertices[middle, 4],
        vertices[end, 5] + vertices[middle, 5],
    )
    write_normal(vertices, row, x, y, z)


@native
def place_on_curves(
    points: Floats,
    normals: Floats,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    splits: npt.NDArray[np.uint8],
    growth_once: Floats,
    growth_twice: Floats,
    first_points: Unsigned,
    split_once: Unsigned,
    counts: npt.NDArray[np.int64],
    bulges: Floats,
    vertices: Floats,
) -> None:
    """Write vertices as they are, and the one or three points of every split edge.

    `points` and `bulges`, rows of three, have room (lanes.py); `counts`: see schemes.Frame.
    """
    place_unmoved(points, normals, vertices)
    for k in range(counts[1]):
        e = split_once[k]
        a, b = edge_points[e, 0], edge_points[e, 1]
        row, bulge = np.uint32(first_points[e] + (splits[e] >> 1)), np.uint64(3) * np.uint64(e)
        at_a, at_b, share = four(points, a), four(points, b), growth_of(e, growth_once)
        middle = HALF * (at_a + at_b) + share * four(bulges, bulge + np.uint64(MIDDLE))
        write(vertices, row, middle)
        if splits[e] == 2:
            near_a = THREE_QUARTERS * at_a + QUARTER * at_b + four(bulges, bulge)
            near_b = THREE_QUARTERS * at_b + QUARTER * at_a
            near_b = near_b + four(bulges, bulge + np.uint64(NEAR_END))
            near_a = grown(HALF * (at_a + middle), near_a, e, growth_twice)
            near_b = grown(HALF * (at_b + middle), near_b, e, growth_twice)
            write(vertices, np.uint32(row - 1), near_a)
            write(vertices, np.uint32(row + 1), near_b)
        if is_interior[e]:
            for i in range(4):
                wing = edge_wings[e, i]
                share = min(share, growth_of(wing, growth_once) if splits[wing] > 0 else ZERO)
        stand_upright(vertices, a, b, row, splits[e] == 2, UPRIGHT * share)
        if splits[e] == 2:
            turn_quarter(vertices, a, row, np.uint32(row - 1))
            turn_quarter(vertices, b, row, np.uint32(row + 1))
