r"""No popping: the refined surface as a continuous function of the positions.

Kähler, Haber, Seidel 2003, put a new point where it belongs in the very frame in which its edge
passes a threshold. Here it begins on the straight edge and moves out while the need of its edge
goes on to rise. Two things have to be continuous for that:

*Points.* A criterion measures the `need` of an edge: above 0 it is split once, above 1 twice.

    growth once    need / RAMP,         from 0 to 1        where m is between the straight edge and
    growth twice   (need - 1) / RAMP,   from 0 to 1        its full place; the same for the quarters

*Triangles.* Where two edges of a triangle are split, a quadrangle is left that has two diagonals.
If one of its splits goes away the diagonal from the other one must stand, whichever it is, so it
has to turn somewhere in between, and the surface jumps. A point C in the middle has no diagonals:

              2               C = (corners) / 3 + sum of  w x (how far m stands out of its edge)
             /|\
            / | \             w = 2/3 where this is the only split edge: C lies on the line m-2 that
           /  |  \                is there without it, and nothing moves when it appears;
          /   C...m           w = 4/9 where another one has grown: the middle of a cubic patch
         / .  |  . \              (the sixth part of its six inner points; Vlachos et al. 2001,
        0-----m-----1             "Curved PN triangles", give the same).

It costs one more point and two more subtriangles for triangles with two or more splits.

Differs from the paper: "We don't generate any new vertices in the interior" (section 3).
"""

import numpy as np
import numpy.typing as npt

from .lanes import four, write
from .native import native
from .normals import unit

Floats = npt.NDArray[np.float32]
Unsigned = npt.NDArray[np.uint32]
Small = npt.NDArray[np.uint8]
Short = npt.NDArray[np.uint16]

RAMP = np.float32(0.25)
"""Need over which a point grows, in what lies between the two thresholds. Chosen: points that are
only half grown cost as much as whole ones."""
ALONE = np.float32(2 / 3)
"""Weight of the only split edge in the place of C."""
SHARED = np.float32(2 / 9)
"""What it loses where another edge has grown; 2/3 - 2/9 = 4/9."""
ZERO = np.float32(0.0)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
THIRD = np.float32(1 / 3)


@native
def grow(need: Floats, splits: Small, growth_once: Floats, growth_twice: Floats) -> None:
    """Write splits and growth of every edge from its need, all of shape (E,)."""
    for e in range(need.shape[0]):
        splits[e] = np.uint8(need[e] > ZERO) + np.uint8(need[e] > ONE)
        growth_once[e] = min(max(need[e] / RAMP, ZERO), ONE)
        growth_twice[e] = min(max((need[e] - ONE) / RAMP, ZERO), ONE)


@native
def number_centres(
    rows: Short,
    subtriangle_counts: Small,
    subtriangles: Small,
    centre: int,
    centre_triangles: Unsigned,
    counts: npt.NDArray[np.int64],
) -> None:
    """List the triangles that have a point in the middle; count them, and all subtriangles.

    `rows`: of the table, shape (F,); `centre`: number of that point in it; `counts`: schemes.Frame.
    """
    centre_count = triangle_count = 0
    for t in range(rows.shape[0]):
        centre_triangles[centre_count] = t
        centre_count += subtriangles[rows[t], 0, 0] == centre
        triangle_count += subtriangle_counts[rows[t]]
    counts[3], counts[4] = triangle_count, centre_count


@native
def middle_of(
    edges: npt.NDArray[np.int32],
    t: np.uint32,
    i: int,
    none: np.uint32,
    splits: Small,
    growth_once: Floats,
    first_points: Unsigned,
) -> tuple[np.float32, np.uint32]:
    """Weight of the middle of edge i of a triangle, and its row; 0 and `none` where none is."""
    e = edges[t, i]
    if splits[e] == 0:
        return ZERO, none
    others = max(growth_once[edges[t, (i + 1) % 3]], growth_once[edges[t, (i + 2) % 3]])
    return ALONE - SHARED * others, np.uint32(first_points[e] + (splits[e] >> 1))


@native
def place_centres(
    faces: Unsigned,
    corners: Unsigned,
    triangle_edges: npt.NDArray[np.int32],
    splits: Small,
    growth_once: Floats,
    first_points: Unsigned,
    centre_triangles: Unsigned,
    counts: npt.NDArray[np.int64],
    vertices: Floats,
) -> None:
    """Write the rows of the points in the middle of triangles, attributes too.

    `counts`: the first of these rows at 0, their number at 4 (schemes.Frame).
    """
    for k in range(counts[4]):
        t, row = centre_triangles[k], np.uint32(counts[0] + k)
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        u, p = middle_of(triangle_edges, t, 0, a, splits, growth_once, first_points)
        v, q = middle_of(triangle_edges, t, 1, b, splits, growth_once, first_points)
        w, r = middle_of(triangle_edges, t, 2, c, splits, growth_once, first_points)
        at_a, at_b, at_c = four(vertices, a), four(vertices, b), four(vertices, c)
        out_p = four(vertices, p) - HALF * (at_a + at_b)
        out_q = four(vertices, q) - HALF * (at_b + at_c)
        out_r = four(vertices, r) - HALF * (at_c + at_a)
        side_a, side_b, side_c = THIRD * at_a, THIRD * at_b, THIRD * at_c
        write(vertices, row, side_a + u * out_p + side_b + v * out_q + side_c + w * out_r)
        for i in range(3, 6):
            along_a, along_b, along_c = vertices[a, i], vertices[b, i], vertices[c, i]
            vertices[row, i] = (
                THIRD * along_a
                + u * (vertices[p, i] - HALF * (along_a + along_b))
                + THIRD * along_b
                + v * (vertices[q, i] - HALF * (along_b + along_c))
                + THIRD * along_c
                + w * (vertices[r, i] - HALF * (along_c + along_a))
            )
        x, y, z = unit(vertices[row, 3], vertices[row, 4], vertices[row, 5])
        vertices[row, 3], vertices[row, 4], vertices[row, 5] = x, y, z
        for i in range(6, vertices.shape[1]):
            vertices[row, i] = THIRD * (
                vertices[corners[t, 0], i] + vertices[corners[t, 1], i] + vertices[corners[t, 2], i]
            )
