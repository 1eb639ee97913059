"""Checks of the caller's positions and triangles, with errors that name the remedy.

All checks raise ValueError with the argument, its value and the allowed values. Arrays that pass
are copied, so that later changes to the caller's arrays have no effect.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Flags, Floats32, Floats64, Integers64
from ...jit import njit

LARGEST_COORDINATE = 1e15
"""Largest allowed coordinate: cross products of edges must be finite in single precision."""
MESH_SIZES = 1e-6, 1e9
"""Range of a mesh's size, the longest side of its box, in which normals are more than rounding.
Measured:
 grids with edges of a fortieth of that are refined properly from 1e-7 to 1e9.
"""

_DOUBLE_TYPE = np.dtype(np.float64)


def checked_mesh(
    positions: npt.ArrayLike,
    faces: npt.ArrayLike,
    names: tuple[str, str] = ("rest_positions", "faces"),
) -> tuple[Floats64, Integers64]:
    """Return positions, shape (V, 3), in double precision, and triangles, (F, 3), as copies.

    Points that no triangle uses may have any place, and may be NaN: these get the place of the
    first used point. `names`: names of the two arguments, for errors.
    """
    name = names[0]
    given = as_array(name, positions, "numbers of shape (V, 3)")
    if given.ndim != 2 or given.shape[1] != 3 or given.dtype.kind not in "fiu":
        raise ValueError(
            f"{name} must be numbers of shape (V, 3), got {given.dtype} of shape {given.shape}"
        )
    triangles = checked_indices(names[1], faces, len(given), name)
    is_used = used_vertices(triangles, len(given))
    with np.errstate(over="ignore"):
        checked = np.array(given, dtype=np.float64, order="C")
    is_good = (np.abs(checked) < LARGEST_COORDINATE).all(axis=1)
    bad = np.flatnonzero(is_used & ~is_good)
    if len(bad) > 0:
        raise ValueError(
            f"{name} must be finite and below {LARGEST_COORDINATE:g}, but vertex {bad[0]} is "
            f"{given[bad[0]]} ({len(bad)} such vertices in all); repair the mesh before "
            "binding it"
        )
    size = size_of(checked[is_used])
    least, most = MESH_SIZES
    if size != 0.0 and not least <= size <= most:
        raise ValueError(
            f"{name} must extend over {least:g} to {most:g} (or lie all at one place), but "
            f"extend over {size:g}; choose another unit of length, at binding and in all frames"
        )
    checked[~is_good] = checked[is_used.argmax()] if is_used.any() else 0.0
    return checked, triangles


def used_vertices(faces: npt.NDArray[np.integer], vertex_count: int) -> Flags:
    """Flag the vertices that triangles name, shape (V,)."""
    is_used = np.zeros(vertex_count, dtype=np.bool_)
    is_used[faces] = True
    return is_used


def size_of(positions: Floats64) -> float:
    """Longest side of the box around positions, shape (N, 3); 0 if there are none."""
    return float(np.ptp(positions, axis=0).max()) if len(positions) > 0 else 0.0


def as_array(name: str, given: npt.ArrayLike, wanted: str) -> npt.NDArray[Any]:
    """Return the argument as an array; raises ValueError if it is ragged or has masked entries.

    `wanted`: the kind of array that is allowed, for the error.
    """
    try:
        array = np.asarray(given)
    except ValueError as error:  # this is numpy's error for rows of unequal length
        raise ValueError(f"{name} must be {wanted}, but is not an array: {error}") from None
    if np.ma.is_masked(given):
        raise ValueError(f"{name} must be {wanted}, but has masked entries; fill them first")
    return array


def checked_indices(name: str, indices: npt.ArrayLike, limit: int, target: str) -> Integers64:
    """Return triangles, shape (F, 3), as a copy; all indices are from 0 to `limit` - 1."""
    return as_indices(name, indices, limit, target).astype(np.int64)


def as_indices(
    name: str, indices: npt.ArrayLike, limit: int, target: str
) -> npt.NDArray[np.integer]:
    """Return triangles as `checked_indices` does, without a copy where none is needed."""
    array = as_array(name, indices, "integers of shape (F, 3)")
    if array.shape in ((0,), (0, 3)):
        return np.zeros((0, 3), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise ValueError(
            f"{name} must be integers of shape (F, 3), got {array.dtype} of shape {array.shape}; "
            "cast numbers to int, cut polygons into triangles"
        )
    if not (array.min() >= 0 and array.max() < limit):
        bad = np.flatnonzero(((array < 0) | (array >= limit)).any(axis=1))
        raise ValueError(
            f"{name} must hold indices from 0 to {limit - 1} into {target}, "
            f"but triangle {bad[0]} is {array[bad[0]].tolist()}"
        )
    return array


def take_positions(
    given: npt.NDArray[np.floating], is_used: Flags, positions: Floats64, points: Floats32
) -> None:
    """Copy the positions of a frame, shape (V, 3), in double and in single precision.

    Raises ValueError unless all used positions are finite and below LARGEST_COORDINATE; `is_used`:
    flags of used vertices, shape (V,). Bad unused positions move to the first used one. An array
    other than a plain one of doubles is copied first, because kernels are compiled for one type of
    array.
    """
    source: npt.NDArray[Any] = given
    if given.dtype is not _DOUBLE_TYPE or not given.flags.carray:
        positions[...] = given
        source = positions
    if copy_finite(source, positions, points) == 0:
        return
    is_bad = ~(np.abs(positions) < LARGEST_COORDINATE).all(axis=1)
    bad = np.flatnonzero(is_bad & is_used)
    if len(bad) > 0:
        raise ValueError(
            f"positions must be finite and below {LARGEST_COORDINATE:g}, but vertex {bad[0]} is "
            f"{given[bad[0]]} ({len(bad)} such vertices in all); the mesh's motion is unstable"
        )
    first = is_used.argmax()
    positions[is_bad] = positions[first] if is_used[first] else 0.0
    points[is_bad] = positions[is_bad]


def take_positions_like_rest(
    positions: npt.ArrayLike, is_used: Flags, own: Floats64, points: Floats32
) -> None:
    """Copy positions as `take_positions` does, from an array of `own`'s shape (V, 3) and type."""
    given = np.asarray(positions)
    if given.shape != own.shape or given.dtype.kind != "f":
        raise ValueError(
            f"positions must be floats of shape {own.shape} like the rest positions, "
            f"got {given.dtype} of shape {given.shape}"
        )
    take_positions(given, is_used, own, points)


@njit
def copy_finite(given: Floats64, positions: Floats64, points: Floats32) -> int:
    """Copy positions, shape (V, 3), in double and single precision; count numbers too large.

    Counted are NaN, and numbers not below LARGEST_COORDINATE: 0 unless the motion is unstable.
    """
    numbers = given.reshape(-1)
    copied = positions.reshape(-1)
    rounded = points.reshape(-1)
    finite = 0  # no early exit: so the loop takes several at a time
    for k in range(numbers.size):
        copied[k] = numbers[k]
        rounded[k] = numbers[k]
        finite += abs(numbers[k]) < LARGEST_COORDINATE
    return int(numbers.size - finite)
