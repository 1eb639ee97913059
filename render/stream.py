"""Triangles that change every frame: arrays lent to whoever makes them, and the buffers behind.

The borrower writes rows 0..N of `vertices` and 0..M of `triangles` (and of `source`) with whatever
program it likes; `upload` hands exactly those rows to OpenGL. Nothing is allocated per frame.
Source: Kähler et al. 2003, section 3: refined triangles go to the renderer and are forgotten.
"""

from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from .sight import box_corners


class Stream:
    """One mesh of at most so many vertices and triangles, rewritten every frame.

    vertices: x y z, nx ny nz[, u v], shape (vertex_capacity, 6 or 8), float32; the borrower writes.
    triangles: vertex numbers, shape (triangle_capacity, 3), uint32; the borrower writes.
    source: number of the triangle that each one comes from, shape (triangle_capacity,), int32; the
        borrower writes; never uploaded.
    vertex_count, triangle_count: what the last `upload` handed over.
    has_wrinkles: whether that came with amounts of wrinkling.
    corners: of the box that holds the uploaded vertices, shape (8, 3), float64.
    """

    def __init__(
        self, gl: moderngl.Context, vertex_capacity: int, triangle_capacity: int, columns: int
    ) -> None:
        if columns not in (6, 8):
            raise ValueError(
                f"columns is {columns}; it must be 6 (position, normal) or 8 (and texture u, v)"
            )
        if vertex_capacity < 1 or triangle_capacity < 1:
            raise ValueError(
                f"a stream of {vertex_capacity} vertices and {triangle_capacity} triangles; "
                "it must hold at least one of each"
            )
        self.vertices: npt.NDArray[np.float32] = np.zeros((vertex_capacity, columns), np.float32)
        self.triangles: npt.NDArray[np.uint32] = np.zeros((triangle_capacity, 3), np.uint32)
        self.source: npt.NDArray[np.int32] = np.zeros(triangle_capacity, np.int32)
        self.vertex_count = 0
        self.triangle_count = 0
        self.corners = np.zeros((8, 3))
        self._gl = gl
        self._vertex_buffer = gl.buffer(reserve=self.vertices.nbytes, dynamic=True)
        self.has_wrinkles = False
        self._wrinkle_buffer: moderngl.Buffer | None = None
        self._index_buffer = gl.buffer(reserve=self.triangles.nbytes, dynamic=True)
        self._vertex_arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def upload(
        self,
        vertex_count: int,
        triangle_count: int,
        wrinkling: npt.NDArray[np.float32] | None = None,
    ) -> None:
        """Hand the first `vertex_count` vertices and `triangle_count` triangles to OpenGL.

        wrinkling: how far each vertex wrinkles, 0..1 in either slot of the map, (vertex_count, 2).
        """
        if not 0 <= vertex_count <= len(self.vertices):
            raise ValueError(
                f"vertex_count is {vertex_count}; this stream holds 0 to {len(self.vertices)}"
            )
        if not 0 <= triangle_count <= len(self.triangles):
            raise ValueError(
                f"triangle_count is {triangle_count}; this stream holds 0 to {len(self.triangles)}"
            )
        if wrinkling is not None and wrinkling.shape != (vertex_count, 2):
            raise ValueError(
                f"wrinkling has shape {wrinkling.shape}; it must be ({vertex_count}, 2), two "
                "amounts for each uploaded vertex"
            )
        self.vertex_count, self.triangle_count = vertex_count, triangle_count
        self.has_wrinkles = wrinkling is not None
        if vertex_count == 0 or triangle_count == 0:
            return
        self.corners = box_corners(self.vertices[:vertex_count, :3])
        # Orphaning gives the driver a fresh block while it may still draw from the old one.
        self._vertex_buffer.orphan()
        self._vertex_buffer.write(self.vertices[:vertex_count])
        self._index_buffer.orphan()
        self._index_buffer.write(self.triangles[:triangle_count])
        if wrinkling is not None:
            self._upload_wrinkling(wrinkling)

    def _upload_wrinkling(self, wrinkling: npt.NDArray[np.float32]) -> None:
        if self._wrinkle_buffer is None:
            room = 2 * self.vertices.itemsize * len(self.vertices)
            self._wrinkle_buffer = self._gl.buffer(reserve=room, dynamic=True)
        self._wrinkle_buffer.orphan()
        self._wrinkle_buffer.write(np.ascontiguousarray(wrinkling, np.float32))

    def draw(self, program: moderngl.Program) -> None:
        """Draw the uploaded triangles (attributes in_position, in_normal and in_uv, as needed)."""
        if self.vertex_count == 0 or self.triangle_count == 0:
            return
        array = self._vertex_arrays.get(program)
        if array is None:
            names = ["in_position", "in_normal", "in_uv"]
            layout = "3f 3f 2f"
            if self.vertices.shape[1] == 6:
                names.pop()
                layout = "3f 3f"
            content: list[Any] = [(self._vertex_buffer, layout, *names)]
            if "in_wrinkling" in list(program):
                content.append((self._wrinkle_buffer, "2f", "in_wrinkling"))
            array = self._gl.vertex_array(
                program,
                content,
                index_buffer=self._index_buffer,
                index_element_size=4,
                skip_errors=True,  # flat shading has no use for normals, plain skin none for uv
            )
            self._vertex_arrays[program] = array
        array.render(moderngl.TRIANGLES, vertices=3 * self.triangle_count)

    def release(self) -> None:
        """Give the buffers back to OpenGL; the arrays stay readable."""
        for array in self._vertex_arrays.values():
            array.release()
        self._vertex_arrays.clear()
        self._vertex_buffer.release()
        self._index_buffer.release()
        if self._wrinkle_buffer is not None:
            self._wrinkle_buffer.release()
        self.vertex_count = self.triangle_count = 0
