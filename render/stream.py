"""Lend buffers to the code that makes the triangles of each frame.

The borrower writes the first rows of `vertices`, `triangles` and `source`; `upload` passes exactly
these rows to OpenGL. No memory is allocated per frame. Alternatively, the OpenGL buffers themselves
are lent to a program on the graphics card. Source: Kähler et al. 2003, section 3: refined triangles
go to the renderer and are forgotten.
"""

from enum import Enum
from typing import NamedTuple, Protocol

import moderngl
import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats32, Integers32, Unsigned32
from .camera import box_corners


class TriangleGroup(Enum):
    """A group of the uploaded triangles: all, those with bumps, or those without."""

    ALL = "all"  # all triangles, in their order
    BUMPED = "bumped"  # triangles with a vertex where the bump map shows
    SMOOTH = "smooth"  # all other triangles


NUMBER_BYTES = 4  # bytes of a float32 or uint32
COMMAND_WORDS = 7  # numbers in the command buffer of a `GpuStream`
_VERTEX_ATTRIBUTES = (
    ("3f", "in_position"),
    ("3f", "in_normal"),
    ("2f", "in_uv"),
    ("2f", "in_bumps"),
    ("3f", "in_u_gradient"),
    ("3f", "in_v_gradient"),
    ("2f", "in_fade"),
)


def _vertex_format(count: int) -> tuple[str, ...]:
    """Return the format of the first `count` attributes of a vertex, and their names."""
    formats, names = zip(*_VERTEX_ATTRIBUTES[:count], strict=True)
    return " ".join(formats), *names


# Number of columns of a stream -> layout of its vertices in OpenGL.
VERTEX_LAYOUTS = {
    6: _vertex_format(2),
    8: _vertex_format(3),
    16: _vertex_format(6),
    18: _vertex_format(7),
}
BUMP_COLUMNS = slice(8, 10)  # columns with the amounts of a bump map
_Ranges = dict[TriangleGroup, tuple[int, int]]  # first triangle and count in a buffer of indices


class UploadedMesh(Protocol):
    """The mesh in a stream; arrays on the graphics card are fetched when they are read."""

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""

    @property
    def vertices(self) -> Floats32:
        """Rows x y z, nx ny nz[, u v[, columns of bumps]], (vertex_count, columns)."""

    @property
    def triangles(self) -> Unsigned32:
        """Vertex indices, (triangle_count, 3)."""


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
    """Buffers of one mesh of limited size, which is rewritten every frame.

    columns: number of columns of the vertices. Each number includes the columns of smaller numbers:
        - 6: position (3), normal (3)
        - 8: texture coordinates u and v
        - 16: strengths of the bump map's two slots, 0 to 1 (2); gradients of u and of v along the
          surface (3 each)
        - 18: opacity of a fading mesh, 0 to 1; a number that is negative where the inner side of
          the mesh is hidden
    mesh: the last uploaded mesh; each upload makes a new object.
    has_bumps: whether the bump map shows on this mesh.
    corners: corners of a box around its vertices, (8, 3), float64.
    """

    def __init__(
        self, gl: moderngl.Context, vertex_capacity: int, triangle_capacity: int, columns: int
    ) -> None:
        if columns not in VERTEX_LAYOUTS:
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
        self._parted: moderngl.Buffer | None = None  # triangles with bumps first; made when needed
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

    @property
    def has_gradients(self) -> bool:
        """Whether vertices have the gradients of u and of v."""
        return self.columns >= 16

    def _check_bumps(self, has_bumps: bool) -> None:
        """Raise ValueError if bumps shall show, but the stream has no columns for them."""
        if has_bumps and not self.has_gradients:
            raise ValueError(
                f"bumps on a stream of {self.columns} columns; they need the columns 9 to 16: "
                "lend a stream of 16 columns, or upload without bumps"
            )

    def _part_bumps(self) -> None:
        """Upload the triangles into a second buffer, in which those with bumps come first."""
        parts = self.mesh.triangles
        amounts = self.mesh.vertices[:, BUMP_COLUMNS]
        is_shown = (amounts != 0.0).any(axis=1)
        is_bumped = is_shown[parts].any(axis=1)
        count = int(is_bumped.sum())
        self._ranges[TriangleGroup.BUMPED] = 0, count
        self._ranges[TriangleGroup.SMOOTH] = count, len(parts) - count
        if self._parted is None:
            room = 3 * NUMBER_BYTES * self._triangle_capacity
            self._parted = self.context.buffer(reserve=room, dynamic=True)
        _write_anew(self._parted, np.concatenate([parts[is_bumped], parts[~is_bumped]]))

    def check_uv(self) -> None:
        """Raise ValueError if the stream has no columns for texture coordinates."""
        if self.columns == 6:
            raise ValueError(
                "a texture meets a stream of 6 columns; it needs texture coordinates: lend a "
                "stream of 8 columns (position, normal, u v), or draw without texture"
            )

    def check_fade(self) -> None:
        """Raise ValueError if the stream has no columns for fading."""
        if self.columns < 18:
            raise ValueError(
                f"a fade on a stream of {self.columns} columns; it needs columns 17 and 18: lend a "
                "stream of 18 columns, or draw without a fade"
            )

    def draw(self, program: moderngl.Program, group: TriangleGroup = TriangleGroup.ALL) -> None:
        """Draw a group of the uploaded triangles; BUMPED and SMOOTH need a mesh with bumps.

        Available attributes: in_position, in_normal, in_uv, in_bumps, in_u_gradient, in_v_gradient
        and in_fade.
        """
        if group is TriangleGroup.ALL:
            self._draw_all(self._vertex_array(program, self.index_buffer))
            return
        first, count = self._ranges.get(group, (0, 0))
        if count == 0 or self._parted is None:
            return
        array = self._vertex_array(program, self._parted)
        array.render(moderngl.TRIANGLES, vertices=3 * count, first=3 * first)

    def _draw_all(self, array: moderngl.VertexArray) -> None:
        """Draw all triangles in their order."""
        if self.vertex_count and self.triangle_count:
            array.render(moderngl.TRIANGLES, vertices=3 * self.triangle_count)

    def _vertex_array(
        self, program: moderngl.Program, indices: moderngl.Buffer
    ) -> moderngl.VertexArray:
        """Return the vertex array of a program and an index buffer; it is made once and kept."""
        array = self._vertex_arrays.get((program, indices))
        if array is None:
            array = self.context.vertex_array(
                program,
                [(self.vertex_buffer, *VERTEX_LAYOUTS[self.columns])],
                index_buffer=indices,
                index_element_size=4,
                skip_errors=True,  # programs need not use all attributes
            )
            self._vertex_arrays[program, indices] = array
        return array


class Stream(MeshBuffers):
    """Arrays of a mesh, which the borrower fills and uploads.

    - vertices: rows x y z, nx ny nz[, u v[, columns of bumps]], (vertex_capacity, columns),
      float32.
    - triangles: vertex indices, (triangle_capacity, 3), uint32.
    - source: index of the base triangle of each triangle, (triangle_capacity,), int32; not
      uploaded.
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

        has_bumps: whether the bump map shows, with the strengths of columns 9 and 10.
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
    """Write rows into a new block of memory, because the driver may still draw from the old one.

    Software OpenGL clears the whole block, so its size is only the next power of two. Most frames
    have this size, and a driver reuses blocks of equal size.
    """
    buffer.orphan(1 << max(rows.nbytes - 1, 0).bit_length())
    buffer.write(rows)


class GpuStream(MeshBuffers):
    """Buffers of a mesh that a program makes on the graphics card.

    This program also writes the command that draws the mesh, so the number of triangles is not read
    back. Three features need the arrays on the processor, and wait until they are fetched: bumps,
    colours by triangle, and edge smoothing with software OpenGL.

    - vertex_buffer, index_buffer: vertices and triangles, as in a `Stream`.
    - source_buffer: index of the base triangle of each triangle, int32.
    - command_buffer: 7 uint32, a DrawElementsIndirectCommand, then the numbers of vertices and of
      triangles.
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
        """Draw the mesh in these buffers from now on.

        - mesh: an object that fetches the arrays.
        - positions: vertices of the base mesh, (V, 3); all new vertices lie near their box.
        - has_bumps: as in `Stream.upload`.
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
