"""Vertex normals: what bends, and what light falls on.

Weighted by area: the cross products of the incident triangles, summed and normalised. (Kähler,
Haber, Seidel 2003, do not say; this needs no weights and lets large triangles decide.)

Edge vectors are taken in double precision before the rest is done in single, so a mesh far from the
origin loses nothing. Normals at rest and in a frame come from the same code: see criterion.py.
"""

import numpy as np
import numpy.typing as npt

from .lanes import Four, cross, four, single, write
from .native import Call, has_room, native

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Unsigned = npt.NDArray[np.uint32]

ZERO = np.float32(0.0)
ONE = np.float32(1.0)
TINY = np.finfo(np.float32).tiny
"""Squared length below which a vector is left as it is instead of being normalised."""


def bind_normals(positions: Doubles, faces: Unsigned, normals: Floats) -> Call:
    """Return a call that writes the unit normals of `positions` into `normals`, both (V, 3).

    `positions` are made by `with_room`; `faces`: vertices of each triangle, shape (F, 3).
    """
    assert has_room(positions)
    return vertex_normals.bind(positions, faces, np.empty((len(positions), 4), np.float32), normals)


@native
def unit(x: np.float32, y: np.float32, z: np.float32) -> tuple[np.float32, np.float32, np.float32]:
    """Normalise a vector; zero stays zero."""
    scale = ONE / np.sqrt(max(x * x + y * y + z * z, TINY))
    return x * scale, y * scale, z * scale


@native
def clear(sums: Floats) -> None:
    """Set rows of four to zero."""
    for v in range(sums.shape[0]):
        sums[v, 0] = sums[v, 1] = sums[v, 2] = sums[v, 3] = ZERO


@native
def cross_product(positions: Doubles, a: np.uint32, b: np.uint32, c: np.uint32) -> Four:
    """Normal of a triangle times twice its area; `positions` have room (lanes.py)."""
    at_a = four(positions, a)
    return cross(single(four(positions, b) - at_a), single(four(positions, c) - at_a))


@native
def normalise(sums: Floats, normals: Floats) -> None:
    """Write vectors, shape (V, 4) of which three count, at length one into rows of three."""
    for v in range(sums.shape[0]):
        x, y, z = unit(sums[v, 0], sums[v, 1], sums[v, 2])
        normals[v, 0], normals[v, 1], normals[v, 2] = x, y, z


@native
def vertex_normals(positions: Doubles, faces: Unsigned, sums: Floats, normals: Floats) -> None:
    """Write the area-weighted unit normal of every vertex into `normals`, shape (V, 3).

    Zero where a vertex has no triangle with an area. `sums`: scratch, shape (V, 4).

    Three numbers are taken four at a time (lanes.py): behind each row of `positions` has to be
    something to read.
    """
    clear(sums)
    for k in range(faces.shape[0]):
        t = np.uint64(k)
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        normal = cross_product(positions, a, b, c)
        write(sums, a, four(sums, a) + normal)
        write(sums, b, four(sums, b) + normal)
        write(sums, c, four(sums, c) + normal)
    normalise(sums, normals)
