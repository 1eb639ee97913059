"""Vertex normals: what bends, and what light falls on.

Weighted by area: the cross products of the incident triangles, summed and normalised. (Kähler,
Haber, Seidel 2003, do not say; this needs no weights and lets large triangles decide.)

Edge vectors are taken in double precision before the rest is done in single, so a mesh far from the
origin loses nothing. Normals at rest and in a frame come from the same code: see criterion.py.
"""

import numpy as np
import numpy.typing as npt

from ...jit import njit

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]
Number = int | np.uint32
Vector = tuple[np.float32, np.float32, np.float32]

ZERO = np.float32(0.0)
ONE = np.float32(1.0)
SHORT, LONG = np.float32(1e-30), np.float32(1e37)
"""Squares of lengths between which single precision tells a length to the last bit."""


@njit
def unit(x: np.float32, y: np.float32, z: np.float32) -> Vector:
    """Normalise a vector; zero stays zero."""
    squared = x * x + y * y + z * z
    if SHORT < squared < LONG:
        scale = ONE / np.sqrt(squared)
        return x * scale, y * scale, z * scale
    return unit_of_extreme(np.float64(x), np.float64(y), np.float64(z))


@njit
def unit_of_extreme(x: float, y: float, z: float) -> Vector:
    """Normalise a vector whose square single precision cannot hold; zero stays zero."""
    length = np.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return ZERO, ZERO, ZERO
    return np.float32(x / length), np.float32(y / length), np.float32(z / length)


@njit
def between(positions: Doubles, a: Number, b: Number) -> Vector:
    """The vector from a to b, rounded when it has been taken."""
    return (
        np.float32(positions[b, 0] - positions[a, 0]),
        np.float32(positions[b, 1] - positions[a, 1]),
        np.float32(positions[b, 2] - positions[a, 2]),
    )


@njit
def cross_product(positions: Doubles, a: np.uint32, b: np.uint32, c: np.uint32) -> Vector:
    """Normal of a triangle times twice its area."""
    ux, uy, uz = between(positions, a, b)
    vx, vy, vz = between(positions, a, c)
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@njit
def add(vectors: Floats, v: np.uint32, x: np.float32, y: np.float32, z: np.float32) -> None:
    """Add a vector to row v."""
    vectors[v, 0] += x
    vectors[v, 1] += y
    vectors[v, 2] += z


@njit
def normalise(vectors: Floats) -> None:
    """Bring vectors, shape (V, 3), to length one; those that are zero stay zero."""
    for v in range(vectors.shape[0]):
        x, y, z = unit(vectors[v, 0], vectors[v, 1], vectors[v, 2])
        vectors[v, 0], vectors[v, 1], vectors[v, 2] = x, y, z


@njit
def vertex_normals(positions: Doubles, faces: Unsigned, normals: Floats) -> None:
    """Write the area-weighted unit normal of every vertex into `normals`, shape (V, 3).

    Zero where a vertex has no triangle with an area. `faces`: vertices of triangles, shape (F, 3).
    """
    normals[:] = ZERO
    for t in range(faces.shape[0]):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        x, y, z = cross_product(positions, a, b, c)
        add(normals, a, x, y, z)
        add(normals, b, x, y, z)
        add(normals, c, x, y, z)
    normalise(normals)
