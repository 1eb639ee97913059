r"""What the interpolating schemes share: edges that bulge between end points that stay.

A scheme says how far the points of a split edge stand out of the straight edge, its *bulge*; this
pass puts them there, as far as they have grown (blending.py), with their normals.

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

from ...jit import njit
from ..border.rows import place_unmoved
from ..kahler.frame import ONCE, FrameBuffers, buffers_for, split_everywhere
from ..kahler.smoothing import mix, write_mean_normal
from ..mesh.arrays import Doubles, Floats
from ..mesh.connectivity import Connectivity, Surroundings
from ..mesh.vectors import (
    HALF,
    ZERO,
)

QUARTER = np.float32(0.25)
THREE_QUARTERS = np.float32(0.75)

UPRIGHT = np.float32(0.95)
"""How much of its slope along the curve a normal in the middle of an edge loses. Chosen: all but a
rest, so that one that lies along the edge keeps a direction."""
NEAR_START, MIDDLE, NEAR_END = 0, 1, 2
"""Points of an edge in an array of bulges, shape (E, 3, 3): edge, point, x y z."""


class CurveScheme:
    """A scheme whose original vertices stay and whose edges are curves; fill in `_bulge`."""

    interpolates = True
    turns: Floats | np.float32 = ZERO
    """How much a split would mend in normals at every edge, shape (E,), if that is known: the
    angle [rad] times the length."""

    def bind(
        self,
        connectivity: Connectivity,
        rest_positions: Doubles,
        rest_normals: Floats,
    ) -> None:
        """Take the mesh; `rest_positions` and `rest_normals`, shape (V, 3)."""
        self._mesh, self._around = connectivity, connectivity.around
        self._bulges = np.zeros((len(connectivity.edges), 3, 3), dtype=np.float32)
        self._every_edge = split_everywhere(
            buffers_for(connectivity, rest_positions, np.zeros((0, 3), np.float32), rest_normals),
            connectivity.vertex_count,
        )

    def prepare(self, frame: FrameBuffers) -> None:
        """Find the bulges of all edges as if each were split once."""
        self._bulge(
            self._every_edge._replace(
                positions=frame.positions, points=frame.points, normals=frame.normals
            )
        )

    def place(self, frame: FrameBuffers) -> None:
        """Write vertices as they are, and the points of split edges on their curves."""
        place_on_curves(self._around, frame, frame.normals, self._bulge(frame))

    def measure(self, bulges: Floats, turns: Floats) -> None:
        """Write how far the middle of every edge stands out if it is split once, shape (E,).

        And how much that would mend in normals [rad], times a length, if the scheme knows.
        """
        bulge_sizes(self._bulges, bulges)
        turns[:] = self.turns

    def _bulge(self, frame: FrameBuffers) -> Floats:
        """Return the bulges, shape (E, 3, 3); of edges split once only the middle, if split."""
        raise NotImplementedError


@njit
def bulge_sizes(bulges: Floats, sizes: Floats) -> None:
    """Write how far the middle of every edge bulges, shape (E,)."""
    for e in range(sizes.shape[0]):
        x, y, z = bulges[e, MIDDLE, 0], bulges[e, MIDDLE, 1], bulges[e, MIDDLE, 2]
        sizes[e] = np.sqrt(x * x + y * y + z * z)


@njit
def place_on_curves(
    around: Surroundings, frame: FrameBuffers, normals: Floats, bulges: Floats
) -> None:
    """Write vertices as they are, and the one or three points of every split edge.

    `normals`: of the vertices, shape (V, 3).
    """
    points, vertices = frame.points, frame.rows
    place_unmoved(points, normals, vertices)
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        a, b = around.points[e, 0], around.points[e, 1]
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
        write_mean_normal(vertices, a, b, row)
        if is_twice:
            write_mean_normal(vertices, a, row, near_a)
            write_mean_normal(vertices, b, row, near_b)
