r"""Weights of the smoothing rules: where the new points on split edges go.

Kähler, Haber, Seidel 2003, section 4.2 with Figs. 3 and 4, after Loop 1987. `o` is the point that
is computed.

    first level, interior edge      border edge

              1/8
             /   \
          3/8--o--3/8              1/2---o---1/2
             \   /
              1/8

    second level: o halves the half-edge a'm; then the middle point m itself is moved

            c                quarter point, interior edge   o = 3/8 (a' + m) + 1/8 (p + r)
           / \               quarter point, border edge     o = 1/2 (a' + m)
          /   \
         p-----q             middle point, interior edge
        / \   / \                5/8 m + 1/16 (a' + b' + p + q + r + s)
       /   \ /   \           middle point, border edge
      a'-o--m-----b'             3/4 m + 1/8 (a' + b')
       \   / \   /
        \ /   \ /
         r-----s
          \   /
            d

m is the first-level point of the edge; p, q, r, s those of the neighbour edges ac, bc, ad, bd, or
their midpoints where these are not split. a' and b' are the moved end points (rings.py).

The paper leaves open, and we decide: m, p, q, r, s enter the second level as the first level left
them, so that the order of edges cannot matter.

Normals of new points are interpolated linearly along the edge and normalised (section 4.4, first
paragraph). Whole passes and not one function per point: numba pays for every array argument of a
call, and a call per element made such loops five times slower (measured).
"""

import numpy as np
import numpy.typing as npt

from .kernels import kernel

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

EDGE_END = np.float32(3 / 8)
"""First and second level, interior: end points of the edge or half-edge (Fig. 3, Fig. 4 left)."""
EDGE_WING = np.float32(1 / 8)
"""First and second level, interior: the two points beside it (Fig. 3, Fig. 4 left)."""
BORDER_EDGE_END = np.float32(1 / 2)
"""Border edge: end points (Fig. 3, bottom left)."""
BORDER_MIDDLE_OWN = np.float32(3 / 4)
"""Middle point of a border edge split twice: the rule of a vertex on a border (Fig. 3)."""
BORDER_MIDDLE_RING = np.float32(1 / 8)
"""The moved ends of this edge."""
MIDDLE_OWN = np.float32(5 / 8)
"""Middle point of an interior edge split twice: valence six, 1 - 6/16 (Fig. 4 right)."""
MIDDLE_RING = np.float32(1 / 16)
"""Its six neighbours, 3/(8 x 6) (Fig. 4 right)."""

ZERO = np.float32(0.0)
QUARTER = np.float32(0.25)
HALF = np.float32(0.5)
THREE_QUARTERS = np.float32(0.75)
ONE = np.float32(1.0)
TINY = np.finfo(np.float32).tiny
"""Squared length below which a vector is left as it is instead of being normalised."""


@kernel
def unit(x: np.float32, y: np.float32, z: np.float32) -> tuple[np.float32, np.float32, np.float32]:
    """Normalise a vector; zero stays zero."""
    scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
    return x * scale, y * scale, z * scale


@kernel
def place_middles(
    positions: Doubles,
    normals: Floats,
    edge_points: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    first_points: Unsigned,
    split_once: Unsigned,
    once_count: int,
    middles: Floats,
    vertices: Floats,
) -> None:
    """Write the first-level point of every split edge (Fig. 3), and keep it in `middles`."""
    for k in range(once_count):
        e = split_once[k]
        a, b, c, d = edge_points[e, 0], edge_points[e, 1], edge_points[e, 2], edge_points[e, 3]
        row = first_points[e]
        end, wing = (EDGE_END, EDGE_WING) if is_interior[e] else (BORDER_EDGE_END, ZERO)
        for i in range(3):
            ends = np.float32(positions[a, i]) + np.float32(positions[b, i])
            wings = np.float32(positions[c, i]) + np.float32(positions[d, i])
            middles[e, i] = vertices[row, i] = end * ends + wing * wings
        vertices[row, 3], vertices[row, 4], vertices[row, 5] = unit(
            normals[a, 0] + normals[b, 0],
            normals[a, 1] + normals[b, 1],
            normals[a, 2] + normals[b, 2],
        )


@kernel
def place_quarters(
    positions: Doubles,
    normals: Floats,
    edge_points: Unsigned,
    edge_wings: Unsigned,
    is_interior: npt.NDArray[np.bool_],
    rim_splits: npt.NDArray[np.uint8],
    first_points: Unsigned,
    split_twice: Unsigned,
    twice_count: int,
    middles: Floats,
    vertices: Floats,
) -> None:
    """Write the three points of every edge that is split twice (Fig. 4)."""
    for k in range(twice_count):
        e = split_twice[k]
        a, b, c, d = edge_points[e, 0], edge_points[e, 1], edge_points[e, 2], edge_points[e, 3]
        row = first_points[e]
        has_p = rim_splits[edge_wings[e, 0]] > 0
        has_q = rim_splits[edge_wings[e, 1]] > 0
        has_r = rim_splits[edge_wings[e, 2]] > 0
        has_s = rim_splits[edge_wings[e, 3]] > 0
        for i in range(3):
            m = middles[e, i]
            moved_a, moved_b = vertices[a, i], vertices[b, i]
            if is_interior[e]:
                at_a, at_b = np.float32(positions[a, i]), np.float32(positions[b, i])
                at_c, at_d = np.float32(positions[c, i]), np.float32(positions[d, i])
                p = middles[edge_wings[e, 0], i] if has_p else HALF * (at_a + at_c)
                q = middles[edge_wings[e, 1], i] if has_q else HALF * (at_b + at_c)
                r = middles[edge_wings[e, 2], i] if has_r else HALF * (at_a + at_d)
                s = middles[edge_wings[e, 3], i] if has_s else HALF * (at_b + at_d)
                ring = (moved_a + moved_b) + ((p + r) + (q + s))
                vertices[row, i] = EDGE_END * (moved_a + m) + EDGE_WING * (p + r)
                vertices[row + 1, i] = MIDDLE_OWN * m + MIDDLE_RING * ring
                vertices[row + 2, i] = EDGE_END * (moved_b + m) + EDGE_WING * (q + s)
            else:
                vertices[row, i] = BORDER_EDGE_END * (moved_a + m)
                vertices[row + 1, i] = BORDER_MIDDLE_OWN * m + BORDER_MIDDLE_RING * (
                    moved_a + moved_b
                )
                vertices[row + 2, i] = BORDER_EDGE_END * (moved_b + m)
        ax, ay, az = normals[a, 0], normals[a, 1], normals[a, 2]
        bx, by, bz = normals[b, 0], normals[b, 1], normals[b, 2]
        near, far = THREE_QUARTERS, QUARTER
        vertices[row, 3], vertices[row, 4], vertices[row, 5] = unit(
            near * ax + far * bx, near * ay + far * by, near * az + far * bz
        )
        vertices[row + 1, 3], vertices[row + 1, 4], vertices[row + 1, 5] = unit(
            ax + bx, ay + by, az + bz
        )
        vertices[row + 2, 3], vertices[row + 2, 4], vertices[row + 2, 5] = unit(
            far * ax + near * bx, far * ay + near * by, far * az + near * bz
        )
