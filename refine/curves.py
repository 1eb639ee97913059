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

from ..jit import njit
from .connectivity import Connectivity
from .frame import ONCE, Frame
from .masks import growth_of_split, mix, write_mean_normal, write_normal
from .normals import unit
from .output import place_unmoved

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]

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
        self._mesh = connectivity
        self._bulges = np.zeros((len(connectivity.edges), 3, 3), dtype=np.float32)
        self._every_edge = _frame_of_every_edge(connectivity)

    def place(self, frame: Frame) -> None:
        """Write vertices as they are, and the points of split edges on their curves."""
        place_on_curves(self._mesh, frame, self._vertex_normals(frame), self._bulge(frame))

    def all_bulges(self, positions: Doubles, normals: Floats) -> Floats:
        """Bulges of all edges as if each were split once, shape (E, 3, 3): middles are number 1.

        For criteria that ask how far an edge is from where it should be. The array is the one that
        `place` uses.
        """
        return self._bulge(self._every_edge._replace(positions=positions, normals=normals))

    def place_centres(self, frame: Frame) -> None:
        """Leave them as blending has them."""

    def _vertex_normals(self, frame: Frame) -> Floats:
        """Return the normals that vertices get in the output, shape (V, 3)."""
        return frame.normals

    def _bulge(self, frame: Frame) -> Floats:
        """Return the bulges, shape (E, 3, 3); of edges split once only the middle, if split."""
        raise NotImplementedError


def _frame_of_every_edge(mesh: Connectivity) -> Frame:
    """A frame without output in which each edge is split once."""
    edge_count = len(mesh.edges)
    none, every = np.zeros(0, dtype=np.float32), np.arange(edge_count, dtype=np.uint32)
    return Frame(
        positions=np.zeros((0, 3)),
        points=np.zeros((0, 3), dtype=np.float32),
        normals=np.zeros((0, 3), dtype=np.float32),
        splits=np.ones(edge_count, dtype=np.uint8),
        growth_once=none,
        growth_twice=none,
        first_points=every,
        split_once=every,
        split_twice=every,
        configurations=np.zeros(0, dtype=np.uint16),
        centre_triangles=np.zeros(0, dtype=np.uint32),
        counts=np.array([0, edge_count, 0, 0, 0]),
        rows=np.zeros((0, 0), dtype=np.float32),
    )


@njit
def stand_upright(
    vertices: Floats,
    start: np.uint32,
    end: np.uint32,
    a: np.uint32,
    b: np.uint32,
    share: np.float32,
) -> tuple[np.float32, np.float32, np.float32]:
    """The mean normal of a and b, less a share of its slope on the way from start to end.

    All four are rows of the output; the result has length one.
    """
    along = slope = ZERO
    for i in range(3):
        d = vertices[end, i] - vertices[start, i]
        along += d * d
        slope += d * (vertices[a, 3 + i] + vertices[b, 3 + i])
    slope *= share / max(along, TINY)
    return unit(
        vertices[a, 3] + vertices[b, 3] - slope * (vertices[end, 0] - vertices[start, 0]),
        vertices[a, 4] + vertices[b, 4] - slope * (vertices[end, 1] - vertices[start, 1]),
        vertices[a, 5] + vertices[b, 5] - slope * (vertices[end, 2] - vertices[start, 2]),
    )


@njit
def place_on_curves(mesh: Connectivity, frame: Frame, normals: Floats, bulges: Floats) -> None:
    """Write vertices as they are, and the one or three points of every split edge.

    `normals`: of the vertices, shape (V, 3).
    """
    points, vertices = frame.points, frame.rows
    place_unmoved(points, normals, vertices)
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        a, b = mesh.edge_points[e, 0], mesh.edge_points[e, 1]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        near_a, near_b = np.uint32(row - 1), np.uint32(row + 1)
        is_twice = frame.splits[e] == 2
        share, twice = frame.growth_once[e], frame.growth_twice[e]
        for i in range(3):
            at_a, at_b = points[a, i], points[b, i]
            middle = HALF * (at_a + at_b) + share * bulges[e, MIDDLE, i]
            vertices[row, i] = middle
            if is_twice:
                full_a = THREE_QUARTERS * at_a + QUARTER * at_b + bulges[e, NEAR_START, i]
                full_b = THREE_QUARTERS * at_b + QUARTER * at_a + bulges[e, NEAR_END, i]
                vertices[near_a, i] = mix(HALF * (at_a + middle), full_a, twice)
                vertices[near_b, i] = mix(HALF * (at_b + middle), full_b, twice)
        if mesh.is_interior[e]:
            for i in range(4):
                wing = mesh.edge_wings[e, i]
                share = min(share, growth_of_split(frame.splits, frame.growth_once, wing))
        start, end = (near_a, near_b) if is_twice else (a, b)
        x, y, z = stand_upright(vertices, start, end, a, b, UPRIGHT * share)
        write_normal(vertices, row, x, y, z)
        if is_twice:
            write_mean_normal(vertices, a, row, near_a)
            write_mean_normal(vertices, b, row, near_b)
