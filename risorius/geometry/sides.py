"""The sides of triangles as pairs of vertices."""

import numpy as np

from .arrays import Floats64, Integers, Integers64


def sides_of(faces: Integers) -> Integers:
    """The directed sides of triangles (F, 3), shape (3 F, 2): first those from corner 0 to 1."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def different_pairs(pairs: Integers) -> tuple[Integers64, Integers64]:
    """Return the distinct pairs of non-negative integers (n, 2), and each pair's index there, (n,).

    The distinct pairs, shape (k, 2), are sorted by the first number, then by the second.
    `np.unique` of rows takes ten times as long.
    """
    first, second = pairs.T.astype(np.int64)
    span = int(second.max(initial=0)) + 1
    keys, numbers = np.unique(first * span + second, return_inverse=True)
    return np.column_stack(np.divmod(keys, span)), numbers.astype(np.int64)


def numbered_edges(faces: Integers) -> tuple[Integers64, Integers64]:
    """Return the edges of triangles (F, 3), as `edges_of` does, and the edge of each side, (3 F,).

    The sides are in the order of `sides_of`.
    """
    return different_pairs(np.sort(sides_of(faces), axis=1))


def edges_of(faces: Integers) -> Integers64:
    """The edges of triangles (F, 3), each once, the lower vertex first, sorted, shape (E, 2)."""
    return numbered_edges(faces)[0]


def border_edges(faces: Integers) -> Integers64:
    """Those of `edges_of` that have a single triangle, shape (n, 2)."""
    edges, numbers = numbered_edges(faces)
    found: Integers64 = edges[np.bincount(numbers) == 1]
    return found


def border_sides(faces: Integers) -> Integers:
    """Those of `sides_of` that no other triangle shares, shape (n, 2), in the same order."""
    _, numbers = numbered_edges(faces)
    found: Integers = sides_of(faces)[np.bincount(numbers)[numbers] == 1]
    return found


def side_lengths(vertices: Floats64, sides: Integers) -> Floats64:
    """The lengths (n,) of sides or edges (n, 2) between vertices (V, 3), in their unit."""
    along = vertices[sides[:, 1]] - vertices[sides[:, 0]]
    lengths: Floats64 = np.linalg.norm(along, axis=1)
    return lengths
