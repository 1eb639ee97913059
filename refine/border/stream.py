"""Arrays for the output of a frame: arrays lent by the caller, and the refiner's own arrays."""

from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Integers32, Unsigned32

GROWTH_FACTOR = 1.25
"""Ratio of the new size to the needed size when a refiner's own stream must grow."""


class StreamArrays(NamedTuple):
    """The arrays of a stream, checked."""

    vertices: Floats32
    """Rows of the output (rows.py), shape (.., k)."""
    triangles: Unsigned32
    """Corners of the triangles, as row indices, shape (.., 3)."""
    source: Integers32
    """Input triangle that each triangle is part of, shape (..,)."""


class OwnStream:
    """The stream of a refiner for frames without a lent one: it grows with its frames."""

    def __init__(self, columns: int, vertex_capacity: int, triangle_capacity: int) -> None:
        self._most = vertex_capacity, triangle_capacity
        self.vertices = np.zeros((0, columns), dtype=np.float32)
        self.triangles: Unsigned32 = np.zeros((0, 3), dtype=np.uint32)
        self.source: Integers32 = np.zeros(0, dtype=np.int32)

    @classmethod
    def with_triangles(
        cls, columns: int, vertex_count: int, triangles: Unsigned32, source: Integers32
    ) -> "OwnStream":
        """Return a stream for frames that all have these triangles and this number of vertices."""
        stream = cls(columns, vertex_count, len(triangles))
        stream.vertices = np.zeros((vertex_count, columns), dtype=np.float32)
        stream.triangles = triangles
        stream.source = source
        return stream

    def reserve(self, vertex_count: int, triangle_count: int) -> None:
        """Enlarge the arrays for a frame of this size; the frame before is lost."""
        if len(self.vertices) < vertex_count:
            rows = min(int(GROWTH_FACTOR * vertex_count), self._most[0])
            self.vertices = np.zeros((rows, self.vertices.shape[1]), dtype=np.float32)
        if len(self.triangles) < triangle_count:
            rows = min(int(GROWTH_FACTOR * triangle_count), self._most[1])
            self.triangles = np.zeros((rows, 3), dtype=np.uint32)
            self.source = np.zeros(rows, dtype=np.int32)


def check_lent(name: str, array: object, dtype: type[np.generic], needed: tuple[int, ...]) -> None:
    """Raise ValueError unless `array` can be filled with at least `needed` rows."""
    if (
        isinstance(array, np.ndarray)
        and array.dtype == dtype
        and array.ndim == len(needed)
        and len(array) >= needed[0]
        and array.shape[1:] == needed[1:]
        and array.flags.c_contiguous
        and array.flags.aligned
        and array.flags.writeable
    ):
        return
    if isinstance(array, np.ndarray):
        got = f"{array.dtype} of shape {array.shape}"
        got += "" if array.flags.c_contiguous else ", not contiguous"
        got += "" if array.flags.writeable else ", read-only"
        got += "" if array.flags.aligned else ", not aligned"
    else:
        got = type(array).__name__
    columns = "".join(f", {size}" for size in needed[1:])
    raise ValueError(
        f"stream.{name} must be a writable C-contiguous {np.dtype(dtype)} array of shape "
        f"(>= {needed[0]}{columns}), got {got}; see vertex_capacity, triangle_capacity and "
        "vertex_columns of the refiner"
    )
