r"""Points displaced from edges between end points that stay: the frame of `cubic` and `detail`.

A scheme says how far the points of every edge would stand out of the straight edge, its
*displacement*; this pass puts those of split edges there, as far as they have grown (blending.py):

                 .  m  .                 m      =  (a + b) / 2          +  displacement
              n           n              n at a =  (3 a + b) / 4        +  displacement
            a---------------b            grown   =  mix of (a + m) / 2 and n

The normal at m is the mean of those at a and b, and at n that of its neighbours, as in the paper
(section 4.4); surface_normals.py has others.

Kähler, Haber, Seidel 2003, section 4.2 asks for rules that are cheap, local, close to the input
mesh, and correct at borders; these are all, and leave every vertex where the simulation has it.
"""

import numpy as np

from ...jit import njit
from ..border.rows import place_unmoved
from ..kahler.frame import ONCE, FrameBuffers
from ..kahler.smoothing import write_mean_normal
from ..mesh.arrays import Floats
from ..mesh.connectivity import Surroundings
from ..mesh.vectors import HALF, QUARTER, THREE_QUARTERS, dot, mix, plus, row_of, times, write_row

NEAR_START, MIDDLE, NEAR_END = 0, 1, 2
"""Points of an edge in an array of displacements, shape (E, 3, 3): edge, point, x y z."""


@njit
def displacement_sizes(displacements: Floats, sizes: Floats) -> None:
    """Write how far the middle of every edge is displaced, shape (E,)."""
    for e in range(sizes.shape[0]):
        middle = row_of(displacements[e], MIDDLE)
        sizes[e] = np.sqrt(dot(middle, middle))


@njit
def place_on_curves(
    around: Surroundings, frame: FrameBuffers, normals: Floats, displacements: Floats
) -> None:
    """Write vertices as they are, and the one or three points of every split edge.

    `normals`: unit normals of vertices, shape (V, 3); `displacements`: of edges, shape (E, 3, 3).
    """
    points, vertices = frame.points, frame.rows
    place_unmoved(points, normals, vertices)
    for k in range(frame.counts[ONCE]):
        e = frame.split_once[k]
        a, b = around.points[e, 0], around.points[e, 1]
        row = np.uint32(frame.first_points[e] + (frame.splits[e] >> 1))
        near_a, near_b = np.uint32(row - 1), np.uint32(row + 1)
        at_a, at_b, displacement = row_of(points, a), row_of(points, b), displacements[e]
        out = times(frame.geomorph_once[e], row_of(displacement, MIDDLE))
        middle = plus(times(HALF, plus(at_a, at_b)), out)
        write_row(vertices, row, middle)
        write_mean_normal(vertices, a, b, row)
        if frame.splits[e] == 2:
            full_a = plus(times(THREE_QUARTERS, at_a), times(QUARTER, at_b))
            full_b = plus(times(THREE_QUARTERS, at_b), times(QUARTER, at_a))
            full_a = plus(full_a, row_of(displacement, NEAR_START))
            full_b = plus(full_b, row_of(displacement, NEAR_END))
            geomorph = frame.geomorph_twice[e]
            write_row(vertices, near_a, mix(times(HALF, plus(at_a, middle)), full_a, geomorph))
            write_row(vertices, near_b, mix(times(HALF, plus(at_b, middle)), full_b, geomorph))
            write_mean_normal(vertices, a, row, near_a)
            write_mean_normal(vertices, b, row, near_b)
