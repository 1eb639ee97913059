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

from .kernels import kernel

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
TINY = np.finfo(np.float32).tiny


@kernel
def grow(need: Floats, splits: Small, growth_once: Floats, growth_twice: Floats) -> None:
    """Write splits and growth of every edge from its need, all of shape (E,)."""
    for e in range(need.shape[0]):
        splits[e] = np.uint8(need[e] > ZERO) + np.uint8(need[e] > ONE)
        growth_once[e] = min(max(need[e] / RAMP, ZERO), ONE)
        growth_twice[e] = min(max((need[e] - ONE) / RAMP, ZERO), ONE)


@kernel
def number_centres(
    rows: Short, counts: Small, subtriangles: Small, centre: int, centre_triangles: Unsigned
) -> tuple[int, int]:
    """List the triangles that have a point in the middle; return how many, and all subtriangles."""
    centre_count, triangle_count = 0, 0
    for t in range(rows.shape[0]):
        centre_triangles[centre_count] = t
        centre_count += subtriangles[rows[t], 0, 0] == centre
        triangle_count += counts[rows[t]]
    return centre_count, triangle_count


@kernel
def place_centres(
    faces: Unsigned,
    corners: Unsigned,
    triangle_edges: npt.NDArray[np.int32],
    splits: Small,
    growth_once: Floats,
    first_points: Unsigned,
    centre_triangles: Unsigned,
    centre_count: int,
    first_centre: int,
    vertices: Floats,
) -> None:
    """Write the rows of the points in the middle of triangles, attributes too."""
    weights = np.empty(3, np.float32)
    middles = np.empty(3, np.uint32)
    for k in range(centre_count):
        t, row = centre_triangles[k], first_centre + k
        for i in range(3):
            e = triangle_edges[t, i]
            after, before = triangle_edges[t, (i + 1) % 3], triangle_edges[t, (i + 2) % 3]
            middles[i] = first_points[e] + (splits[e] >> 1)
            others = max(growth_once[before], growth_once[after])
            weights[i] = (ALONE - SHARED * others) if splits[e] > 0 else ZERO
        for column in range(6):
            value = ZERO
            for i in range(3):
                a, b = faces[t, i], faces[t, (i + 1) % 3]
                value += THIRD * vertices[a, column]
                if weights[i] > ZERO:
                    straight = HALF * (vertices[a, column] + vertices[b, column])
                    value += weights[i] * (vertices[middles[i], column] - straight)
            vertices[row, column] = value
        x, y, z = vertices[row, 3], vertices[row, 4], vertices[row, 5]
        scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
        for column in range(3, 6):
            vertices[row, column] *= scale
        for column in range(6, vertices.shape[1]):
            a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
            vertices[row, column] = THIRD * (
                vertices[a, column] + vertices[b, column] + vertices[c, column]
            )
