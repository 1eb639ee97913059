"""Checks of callers' arguments: numbers, arrays and names; a wrong argument raises ValueError.

Every message names the argument, its value, and the allowed values. numpy alone would accept
strings as numbers, truncate 0.7 to vertex 0, and raise other errors.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64, Integers64
from ..schema import quoted

ArrayShape = tuple[int | None, ...]  # None: any length


def number(what: str, value: Any) -> float:
    """A finite number."""
    try:
        is_one = isinstance(value, int | float)  # by far the most common, and quickly checked
        is_one = is_one or (not isinstance(value, str | bytes) and np.ndim(value) == 0)
        result = float(value) if is_one else math.nan
    except (TypeError, ValueError, OverflowError):
        result = math.nan
    if not math.isfinite(result):
        raise ValueError(f"{what}: was {quoted(value)}, must be a finite number")
    return result


def numbers(what: str, given: Any, shape: ArrayShape, wanted: str = "") -> Floats64:
    """Copy finite numbers in C order; raises ValueError if their shape is not `shape`.

    wanted: words for the shape in the error.
    """
    wanted = wanted or str(shape)
    array = _array(what, given, "fiub", f"numbers, shape {wanted}")
    if not _has_shape(array, shape):
        raise ValueError(f"{what}: shape was {array.shape}, must be {wanted} and finite")
    with np.errstate(all="ignore"):  # numbers of a wider type may overflow to infinity
        result: Floats64 = np.array(array, dtype=np.float64, order="C")
    if not np.isfinite(result).all():
        raise ValueError(f"{what}: must all be finite numbers, but some are NaN or infinite")
    return result


def vertex_indices(
    what: str, given: Any, shape: ArrayShape, vertex_count: int, wanted: str
) -> Integers64:
    """Copy vertex indices in C order; wanted: words for the allowed values."""
    array = _array(what, given, "fiub", wanted)
    is_whole = array.dtype.kind in "iu" or array.size == 0  # an empty list has no type
    if not is_whole or not _has_shape(array, shape):
        raise ValueError(f"{what}: was {array.dtype} of shape {array.shape}, must be {wanted}")
    if array.size and (array.min() < 0 or array.max() >= vertex_count):
        raise ValueError(
            f"{what}: vertex indices run from {array.min()} to {array.max()}, "
            f"allowed are 0 to {vertex_count - 1}"
        )
    return np.array(array, dtype=np.int64, order="C")


def several(what: str, given: Any, attributes: tuple[str, ...]) -> list[Any]:
    """Return a list of objects that have these attributes; else raises ValueError."""
    names = ", ".join(attributes)
    try:
        found = list(given)
    except TypeError:
        raise ValueError(
            f"{what}: was {quoted(given)}, must be a list of objects with {names}"
        ) from None
    for each in found:
        if not all(hasattr(each, name) for name in attributes):
            raise ValueError(f"{what}: holds {quoted(each)}, must be objects with {names}")
    return found


def _array(what: str, given: Any, kinds: str, wanted: str) -> npt.NDArray[Any]:
    try:
        array = np.asarray(given)
    except (TypeError, ValueError, OverflowError):  # rows of different lengths
        raise ValueError(f"{what}: was {quoted(given)}, must be {wanted}") from None
    if array.dtype.kind not in kinds:
        raise ValueError(f"{what}: was {quoted(given)}, must be {wanted}")
    return array


def _has_shape(array: npt.NDArray[Any], shape: ArrayShape) -> bool:
    pairs = zip(array.shape, shape, strict=False)
    return array.ndim == len(shape) and all(want in (None, has) for has, want in pairs)
