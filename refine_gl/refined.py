"""The mesh of a frame: a `refine.RefinedMesh` whose arrays are fetched when they are read."""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import moderngl
import numpy as np

from risorius.geometry.arrays import Floats32, Integers32, Integers64, Unsigned32
from risorius.refine import GpuStream, RefinedMesh

COMMAND_WORDS = 7
"""Words of a command buffer: DrawElementsIndirectCommand (5), numbers of vertices and triangles."""

Run = Callable[..., Any]
"""Calls a function with arguments while the context of a stream is current."""
RefinedColumns = tuple[Floats32 | None, Mapping[str, Floats32]]
"""Texture coordinates and attributes in the rows of a frame."""


class GpuBuffers:
    """A stream for results that are not drawn, with the buffers of a `refine.GpuStream`."""

    def __init__(
        self, gl: moderngl.Context, columns: int, vertex_capacity: int, triangle_capacity: int
    ) -> None:
        """Make room for the largest frame."""
        self.context = gl
        number_bytes = 4
        self.vertex_buffer = gl.buffer(reserve=max(number_bytes * columns * vertex_capacity, 16))
        self.index_buffer = gl.buffer(reserve=max(3 * number_bytes * triangle_capacity, 16))
        self.source_buffer = gl.buffer(reserve=max(number_bytes * triangle_capacity, 16))
        self.command_buffer = gl.buffer(reserve=number_bytes * COMMAND_WORDS)


class GpuMesh:
    """Triangles of one frame, in buffers that the next frame overwrites.

    It has the members of `refine.RefinedMesh`. Each array is fetched once, when it is read first;
    reading waits until the frame is complete.
    """

    def __init__(
        self,
        stream: GpuStream,
        run: Run,
        columns: int,
        parted: Callable[[Floats32], RefinedColumns],
    ) -> None:
        """`columns`: length of a row; `parted`: returns the texture coordinates and attributes."""
        self._stream = stream
        self._run = run
        self._columns = columns
        self._parted = parted

    @cached_property
    def _counts(self) -> Integers64:
        words = self._fetched("command_buffer", COMMAND_WORDS).view(np.uint32)
        return words[-2:].astype(np.int64)

    @property
    def vertex_count(self) -> int:
        """Number of vertices; 28 bytes are fetched."""
        return int(self._counts[0])

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        return int(self._counts[1])

    @cached_property
    def vertices(self) -> Floats32:
        """Rows x y z, nx ny nz[, u v][, attributes], shape (N, columns); viewed by other arrays."""
        words = self._fetched("vertex_buffer", self._columns * self.vertex_count)
        return words.view(np.float32).reshape(-1, self._columns)

    @property
    def positions(self) -> Floats32:
        """Vertex positions, shape (N, 3)."""
        return self.vertices[:, 0:3]

    @property
    def normals(self) -> Floats32:
        """Unit vertex normals, shape (N, 3)."""
        return self.vertices[:, 3:6]

    @cached_property
    def triangles(self) -> Unsigned32:
        """Vertices of each triangle, shape (M, 3)."""
        return self._fetched("index_buffer", 3 * self.triangle_count).reshape(-1, 3)

    @cached_property
    def source(self) -> Integers32:
        """Input triangle that each triangle is part of, shape (M,)."""
        return self._fetched("source_buffer", self.triangle_count).view(np.int32)

    @property
    def uv(self) -> Floats32 | None:
        """Texture coordinates, shape (N, 2); None if the mesh was bound without."""
        return self._parted(self.vertices)[0]

    @property
    def attributes(self) -> Mapping[str, Floats32]:
        """The attributes that were bound, by name, shape (N, k)."""
        return self._parted(self.vertices)[1]

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle as arrays."""
        arrays = [getattr(self, name) for name in RefinedMesh._fields[:-1]]
        return RefinedMesh, (*arrays, dict(self.attributes))

    def _fetched(self, name: str, count: int) -> Unsigned32:
        """Return the first numbers of a buffer as a writable copy."""
        words = np.empty(count, np.uint32)
        if count:
            self._run(getattr(self._stream, name).read_into, words, words.nbytes)
        return words
