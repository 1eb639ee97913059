"""Vectors of three numbers in kernels: tuples, and rows of arrays."""

from typing import Any

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .arrays import Floats64

Rows = npt.NDArray[np.number[Any]]
Number = int | np.integer[Any]
Vector = tuple[Any, Any, Any]
"""Three numbers in one precision, single or double."""
ROW_WIDTH = 3
"""Columns of a row. A kernel that asserts it is faster: the compiler need not multiply by it."""

ZERO = np.float32(0.0)
HALF = np.float32(0.5)
ONE = np.float32(1.0)
THIRD = np.float32(1 / 3)
QUARTER = np.float32(0.25)
THREE_QUARTERS = np.float32(0.75)
SMALLEST_FLOAT = np.finfo(np.float32).tiny
SHORT_SQUARE = np.float32(1e-30)
LONG_SQUARE = np.float32(1e37)
"""Range of squared lengths in which single precision represents a length to the last bit."""


@njit
def dot(u: Vector, v: Vector) -> Any:
    """Scalar product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@njit
def cross(u: Vector, v: Vector) -> Vector:
    """Vector product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


@njit
def plus(u: Vector, v: Vector) -> Vector:
    """Sum of two vectors."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2]


@njit
def less(u: Vector, factor: Any, v: Vector) -> Vector:
    """Return vector u minus `factor` times v."""
    return u[0] - factor * v[0], u[1] - factor * v[1], u[2] - factor * v[2]


@njit
def times(factor: Any, v: Vector) -> Vector:
    """Product of a number and a vector."""
    return factor * v[0], factor * v[1], factor * v[2]


@njit
def toward(start: Vector, end: Vector, fraction: Any) -> Vector:
    """Go a fraction of the way from start to end."""
    return plus(start, times(fraction, less(end, 1.0, start)))


@njit
def rotated(turn: Floats64, v: Vector) -> Vector:
    """Product of a matrix, whose first three columns count, and a vector."""
    return dot(row_of(turn, 0), v), dot(row_of(turn, 1), v), dot(row_of(turn, 2), v)


@njit
def rotated_back(turn: Floats64, v: Vector) -> Vector:
    """Product of the transposed matrix (3, 3) and a vector."""
    return rotated(turn.T, v)


@njit
def mix(start: Vector, end: Vector, fraction: Any) -> Vector:
    """Interpolate linearly from start (fraction 0) to end (fraction 1); exact at both."""
    if fraction == ONE:  # without blending, points are always at their final positions
        return end
    return plus(times(ONE - fraction, start), times(fraction, end))


@njit
def unit(v: Vector) -> Vector:
    """Normalise a vector; zero stays zero."""
    squared = dot(v, v)
    if is_representable(squared):
        return times(ONE / np.sqrt(squared), v)
    return unit_in_double(np.float64(v[0]), np.float64(v[1]), np.float64(v[2]))


@njit
def is_representable(squared: Any) -> Any:
    """Return whether single precision can represent the square of a length, without a branch."""
    return (SHORT_SQUARE < squared) & (squared < LONG_SQUARE)


@njit
def unit_in_double(x: float, y: float, z: float) -> Vector:
    """Normalise a vector whose square single precision cannot hold; zero stays zero."""
    length = np.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return ZERO, ZERO, ZERO
    return np.float32(x / length), np.float32(y / length), np.float32(z / length)


@njit
def row_of(rows: Rows, k: Number, first: int = 0) -> Vector:
    """Three numbers of row k, from column `first` on."""
    return rows[k, first], rows[k, first + 1], rows[k, first + 2]


@njit
def vector_of(values: Floats64) -> Vector:
    """The three numbers of an array."""
    return values[0], values[1], values[2]


@njit
def write_row(rows: Rows, k: Number, v: Vector, first: int = 0) -> None:
    """Write a vector into row k, from column `first` on."""
    rows[k, first], rows[k, first + 1], rows[k, first + 2] = v


@njit
def add_to_row(rows: Rows, k: Number, v: Vector) -> None:
    """Add a vector to row k."""
    rows[k, 0] += v[0]
    rows[k, 1] += v[1]
    rows[k, 2] += v[2]


@njit
def difference(positions: Floats64, a: Number, b: Number) -> Vector:
    """The vector from a to b."""
    return (
        positions[b, 0] - positions[a, 0],
        positions[b, 1] - positions[a, 1],
        positions[b, 2] - positions[a, 2],
    )


@njit
def between(positions: Floats64, a: Number, b: Number) -> Vector:
    """Return the vector from a to b, rounded after the subtraction."""
    x, y, z = difference(positions, a, b)
    return np.float32(x), np.float32(y), np.float32(z)
