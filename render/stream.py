"""Triangles that change every frame: arrays lent to the program that makes them, and buffers.

The borrower writes rows 0..N of `vertices` and 0..M of `triangles` (and of `source`) by any
program; `upload` passes exactly those rows to OpenGL. Nothing is allocated per frame. Alternatively
the buffers themselves are lent to a program that runs on the graphics card. Source: Kähler et al.
2003, section 3: refined triangles go to the renderer and are forgotten.
"""

from enum import Enum
from typing import NamedTuple, Protocol

import moderngl
import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats32, Integers32, Unsigned32
from .camera import box_corners


class Share(Enum):
    """The part of the uploaded triangles that is drawn."""

    ALL = "all"  # in their order
    BUMPED = "bumped"  # those with a corner where the bump map shows
    SMOOTH = "smooth"  # all others


NUMBER_BYTES = 4  # bytes
COMMAND_WORDS = 7
_ATTRIBUTES = (
    ("3f", "in_position"),
    ("3f", "in_normal"),
    ("2f", "in_uv"),
    ("2f", "in_bumps"),
    ("3f", "in_u_gradient"),
    ("3f", "in_v_gradient"),
    ("2f", "in_fade"),
)


def _layout(count: int) -> tuple[str, ...]:
    """The format of the first attributes of a vertex, and their names."""
    formats, names = zip(*_ATTRIBUTES[:count], strict=True)
    return " ".join(formats), *names


# Of a vertex in OpenGL, by the columns of rows.
LAYOUTS = {6: _layout(2), 8: _layout(3), 16: _layout(6), 18: _layout(7)}
BUMPS = slice(8, 10)  # columns with the amounts of a bump map
_Ranges = dict[Share, tuple[int, int]]  # first triangle and count in a buffer of indices


class UploadedMesh(Protocol):
    """A mesh; arrays of one on the graphics card are fetched when they are read."""

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""

    @property
    def vertices(self) -> Floats32:
        """x y z, nx ny nz[, u v[, columns of bumps]], shape (vertex_count, columns)."""

    @property
    def triangles(self) -> Unsigned32:
        """Shape (triangle_count, 3)."""


class _Uploaded(NamedTuple):
    """A mesh of a `Stream`."""

    vertices: Floats32
    triangles: Unsigned32

    @property
    def vertex_count(self) -> int:
        return len(self.vertices)

    @property
    def triangle_count(self) -> int:
        return len(self.triangles)


class MeshBuffers:
    """Buffers to draw one mesh of limited size, rewritten every frame.

    columns: of its rows, 6 (position, normal), 8 (and texture u, v), 16 (and how much of a bump
        map shows, 0..1 in either slot of it, and the gradients of u and v along the surface) or 18
        (and the share that shows, 0..1, and a number below 0 where the inner side does not).
    mesh: the last one that was written into the buffers; a new object after each upload.
    has_bumps: whether the amounts of that mesh count.
    corners: of a box that holds its vertices, shape (8, 3), float64.
    """

    def __init__(
        self, gl: moderngl.Context, vertex_capacity: int, triangle_capacity: int, columns: int
    ) -> None:
        if columns not in LAYOUTS:
            raise ValueError(
                f"columns is {columns}; it must be 6 (position, normal), 8 (and texture u, v), "
                "16 (and two amounts of a bump map, gradients of u and v) or 18 (and two of a fade)"
            )
        if vertex_capacity < 1 or triangle_capacity < 1:
            raise ValueError(
                f"a stream of {vertex_capacity} vertices and {triangle_capacity} triangles; "
                "it must hold at least one of each"
            )
        self.context = gl
        self.columns = columns
        none = np.zeros((0, columns), np.float32)
        self.mesh: UploadedMesh = _Uploaded(none, np.zeros((0, 3), np.uint32))
        self.corners = np.zeros((8, 3))
        self.has_bumps = False
        self._triangle_capacity = triangle_capacity
        self.vertex_buffer = gl.buffer(
            reserve=NUMBER_BYTES * columns * vertex_capacity, dynamic=True
        )
        self.index_buffer = gl.buffer(reserve=3 * NUMBER_BYTES * triangle_capacity, dynamic=True)
        self._parted: moderngl.Buffer | None = None  # triangles, parted by bumps; made when needed
        self._ranges: _Ranges = {}
        self._vertex_arrays: dict[
            tuple[moderngl.Program, moderngl.Buffer], moderngl.VertexArray
        ] = {}

    @property
    def vertex_count(self) -> int:
        """Number of vertices of the last mesh."""
        return self.mesh.vertex_count

    @property
    def triangle_count(self) -> int:
        """Number of triangles of the last mesh."""
        return self.mesh.triangle_count

    def _check_bumps(self, has_bumps: bool) -> None:
        """Raise ValueError if amounts shall count, but rows have none."""
        if has_bumps and self.columns < BUMPS.stop:
            raise ValueError(
                f"bumps on a stream of {self.columns} columns; their amounts are columns 9 and 10: "
                "lend a stream of 16 columns, or upload without bumps"
            )

    def _part_bumps(self) -> None:
        """Upload the triangles again, those with bumps first."""
        parts = self.mesh.triangles
        amounts = self.mesh.vertices[:, BUMPS]
        is_shown = (amounts[:, 0] > 0.0) | (amounts[:, 1] > 0.0)
        is_bumped = is_shown[parts].any(axis=1)
        count = int(is_bumped.sum())
        self._ranges[Share.BUMPED] = 0, count
        self._ranges[Share.SMOOTH] = count, len(parts) - count
        if self._parted is None:
            room = 3 * NUMBER_BYTES * self._triangle_capacity
            self._parted = self.context.buffer(reserve=room, dynamic=True)
        _write_anew(self._parted, np.concatenate([parts[is_bumped], parts[~is_bumped]]))

    def check_uv(self) -> None:
        """Raise ValueError if there is a texture, but rows have no texture coordinates."""
        if self.columns == 6:
            raise ValueError(
                "a texture meets a stream of 6 columns; it needs texture coordinates: lend a "
                "stream of 8 columns (position, normal, u v), or draw without texture"
            )

    def check_fade(self) -> None:
        """Raise ValueError if rows do not have how the mesh fades, but it shall."""
        if self.columns < 18:
            raise ValueError(
                f"a fade on a stream of {self.columns} columns; it is columns 17 and 18: lend a "
                "stream of 18 columns, or draw without a fade"
            )

    def draw(self, program: moderngl.Program, share: Share = Share.ALL) -> None:
        """Draw uploaded triangles, with the attributes in_position, in_normal, in_uv as needed.

        `share`: BUMPED and SMOOTH need a mesh with bumps; the program then gets in_bumps, too.
        """
        if share is Share.ALL:
            self._draw_all(self._vertex_array(program, self.index_buffer))
            return
        first, count = self._ranges.get(share, (0, 0))
        if count == 0 or self._parted is None:
            return
        array = self._vertex_array(program, self._parted)
        array.render(moderngl.TRIANGLES, vertices=3 * count, first=3 * first)

    def _draw_all(self, array: moderngl.VertexArray) -> None:
        """Draw all triangles, in their order."""
        if self.vertex_count and self.triangle_count:
            array.render(moderngl.TRIANGLES, vertices=3 * self.triangle_count)

    def _vertex_array(
        self, program: moderngl.Program, indices: moderngl.Buffer
    ) -> moderngl.VertexArray:
        """The vertex array of a program and a buffer of triangles; the same one each time."""
        array = self._vertex_arrays.get((program, indices))
        if array is None:
            array = self.context.vertex_array(
                program,
                [(self.vertex_buffer, *LAYOUTS[self.columns])],
                index_buffer=indices,
                index_element_size=4,
                skip_errors=True,  # flat shading uses no normals, plain skin no uv
            )
            self._vertex_arrays[program, indices] = array
        return array


class Stream(MeshBuffers):
    """Arrays of a mesh, lent to its maker, and uploaded.

    vertices: x y z, nx ny nz[, u v[, columns of bumps]], shape (vertex_capacity, columns),
        float32; the borrower writes.
    triangles: vertex numbers, shape (triangle_capacity, 3), uint32; the borrower writes.
    source: number of the triangle that each one comes from, shape (triangle_capacity,), int32; the
        borrower writes; never uploaded.
    """

    def __init__(
        self, gl: moderngl.Context, vertex_capacity: int, triangle_capacity: int, columns: int
    ) -> None:
        super().__init__(gl, vertex_capacity, triangle_capacity, columns)
        self.vertices: Floats32 = np.zeros((vertex_capacity, columns), np.float32)
        self.triangles: Unsigned32 = np.zeros((triangle_capacity, 3), np.uint32)
        self.source: Integers32 = np.zeros(triangle_capacity, np.int32)

    def upload(self, vertex_count: int, triangle_count: int, *, has_bumps: bool = False) -> None:
        """Pass the first `vertex_count` vertices and `triangle_count` triangles to OpenGL.

        has_bumps: whether the amounts in columns 9 and 10 count; else no bump map shows.
        """
        self._check_bumps(has_bumps)
        if not 0 <= vertex_count <= len(self.vertices):
            raise ValueError(
                f"vertex_count is {vertex_count}; this stream holds 0 to {len(self.vertices)}"
            )
        if not 0 <= triangle_count <= len(self.triangles):
            raise ValueError(
                f"triangle_count is {triangle_count}; this stream holds 0 to {len(self.triangles)}"
            )
        rows = self.vertices[:vertex_count]
        triangles = self.triangles[:triangle_count]
        self.mesh = _Uploaded(rows, triangles)
        self.has_bumps = has_bumps
        self._ranges = {}
        if vertex_count == 0 or triangle_count == 0:
            return
        self.corners = box_corners(rows[:, :3])
        _write_anew(self.vertex_buffer, rows)
        _write_anew(self.index_buffer, triangles)
        if has_bumps:
            self._part_bumps()


def _write_anew(buffer: moderngl.Buffer, rows: npt.NDArray[np.generic]) -> None:
    """Write rows into a new block of memory: the driver may still draw from the old one.

    Software clears the whole block, so it is no larger than the next power of two. A driver keeps
    blocks by size, and most frames have that size.
    """
    buffer.orphan(1 << max(rows.nbytes - 1, 0).bit_length())
    buffer.write(rows)


class GpuStream(MeshBuffers):
    """Buffers of a mesh, lent to a program on the graphics card that makes the mesh there.

    The mesh is drawn by a command that this program writes, and the number of triangles is not read
    back. Bumps, colours by triangle, and the software path that omits hidden triangles need rows or
    triangles on the processor: these fetch them, and wait.

    vertex_buffer, index_buffer: rows and triangles, as in a `Stream`.
    source_buffer: the triangle that each comes from, int32.
    command_buffer: a DrawElementsIndirectCommand, then the numbers of vertices and triangles (7
        uint32).
    """

    def __init__(
        self,
        gl: moderngl.Context,
        vertex_capacity: int,
        triangle_capacity: int,
        columns: int,
        margin: float,
    ) -> None:
        super().__init__(gl, vertex_capacity, triangle_capacity, columns)
        self.source_buffer = gl.buffer(reserve=NUMBER_BYTES * triangle_capacity)
        self.command_buffer = gl.buffer(bytes(NUMBER_BYTES * COMMAND_WORDS))
        self._margin = margin

    def show(
        self,
        mesh: UploadedMesh,
        positions: npt.NDArray[np.floating],
        *,
        has_bumps: bool = False,
    ) -> None:
        """Draw the content of these buffers from now on.

        mesh: an object that fetches the arrays.
        positions: those of the mesh that it was made from, (V, 3), near its vertices.
        has_bumps: as `Stream.upload` takes it.
        """
        self._check_bumps(has_bumps)
        self.mesh = mesh
        self.has_bumps = has_bumps
        self._ranges = {}
        box = np.stack([positions.min(axis=0) - self._margin, positions.max(axis=0) + self._margin])
        self.corners = box_corners(box)
        if has_bumps:
            self._part_bumps()

    def _draw_all(self, array: moderngl.VertexArray) -> None:
        array.render_indirect(self.command_buffer, moderngl.TRIANGLES, count=1)
