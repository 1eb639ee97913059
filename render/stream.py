"""Triangles that change every frame: arrays lent to whoever makes them, and the buffers behind.

The borrower writes rows 0..N of `vertices` and 0..M of `triangles` (and of `source`) with whatever
program it likes; `upload` hands exactly those rows to OpenGL. Nothing is allocated per frame.
Source: Kähler et al. 2003, section 3: refined triangles go to the renderer and are forgotten.
"""

from enum import Enum
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from .camera_view import box_corners


class Share(Enum):
    """Which of the uploaded triangles are drawn."""

    ALL = "all"  # in their order
    BUMPED = "bumped"  # those with a corner where the bump map shows
    SMOOTH = "smooth"  # all others
    CHOSEN = "chosen"  # those that `choose` was told of first,
    OTHERS = "others"  # and second


_Ranges = dict[Share, tuple[int, int]]  # first triangle and how many, in a buffer of indices


class Stream:
    """One mesh of at most so many vertices and triangles, rewritten every frame.

    vertices: x y z, nx ny nz[, u v], shape (vertex_capacity, 6 or 8), float32; the borrower writes.
    triangles: vertex numbers, shape (triangle_capacity, 3), uint32; the borrower writes.
    source: number of the triangle that each one comes from, shape (triangle_capacity,), int32; the
        borrower writes; never uploaded.
    vertex_count, triangle_count: what the last `upload` handed over.
    has_bumps: whether that came with amounts of a bump map.
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
        self.has_bumps = False
        self._bump_buffers: tuple[moderngl.Buffer, moderngl.Buffer] | None = None
        self._value_buffer: moderngl.Buffer | None = None
        self._index_buffer = gl.buffer(reserve=self.triangles.nbytes, dynamic=True)
        self._chosen_buffer: moderngl.Buffer | None = None
        self._ranges: _Ranges = {}
        self._vertex_arrays: dict[
            tuple[moderngl.Program, moderngl.Buffer], moderngl.VertexArray
        ] = {}

    def upload(
        self,
        vertex_count: int,
        triangle_count: int,
        bump_amounts: npt.NDArray[np.float32] | None = None,
    ) -> None:
        """Hand the first `vertex_count` vertices and `triangle_count` triangles to OpenGL.

        bump_amounts: how much of a bump map shows, 0..1 in either slot of it, (vertex_count, 2).
        """
        if not 0 <= vertex_count <= len(self.vertices):
            raise ValueError(
                f"vertex_count is {vertex_count}; this stream holds 0 to {len(self.vertices)}"
            )
        if not 0 <= triangle_count <= len(self.triangles):
            raise ValueError(
                f"triangle_count is {triangle_count}; this stream holds 0 to {len(self.triangles)}"
            )
        if bump_amounts is not None and bump_amounts.shape != (vertex_count, 2):
            raise ValueError(
                f"bump_amounts has shape {bump_amounts.shape}; it must be ({vertex_count}, 2), two "
                "amounts for each uploaded vertex"
            )
        self.vertex_count, self.triangle_count = vertex_count, triangle_count
        self.has_bumps = bump_amounts is not None
        self._ranges = {Share.ALL: (0, triangle_count)}
        if vertex_count == 0 or triangle_count == 0:
            return
        self.corners = box_corners(self.vertices[:vertex_count, :3])
        # Orphaning gives the driver a fresh block while it may still draw from the old one.
        self._vertex_buffer.orphan()
        self._vertex_buffer.write(self.vertices[:vertex_count])
        self._index_buffer.orphan()
        self._index_buffer.write(self.triangles[:triangle_count])
        if bump_amounts is not None:
            self._upload_bumps(bump_amounts)

    def _upload_bumps(self, bump_amounts: npt.NDArray[np.float32]) -> None:
        """Upload amounts, and the triangles anew: first those that have bumps."""
        if self._bump_buffers is None:
            room = 2 * self.vertices.itemsize * len(self.vertices)
            self._bump_buffers = (
                self._gl.buffer(reserve=room, dynamic=True),
                self._gl.buffer(reserve=self.triangles.nbytes, dynamic=True),
            )
        triangles = self.triangles[: self.triangle_count]
        is_bumped = (bump_amounts.max(axis=1) > 0.0)[triangles].any(axis=1)
        parted = np.concatenate([triangles[is_bumped], triangles[~is_bumped]])
        count = int(is_bumped.sum())
        self._ranges[Share.BUMPED] = 0, count
        self._ranges[Share.SMOOTH] = count, len(triangles) - count
        for buffer, array in zip(self._bump_buffers, (bump_amounts, parted), strict=True):
            buffer.orphan()
            buffer.write(np.ascontiguousarray(array))

    def check_uv(self) -> None:
        """Raise ValueError where rows have no texture coordinates, but a texture comes."""
        if (columns := self.vertices.shape[1]) != 8:
            raise ValueError(
                f"a texture meets a stream of {columns} columns; it needs texture coordinates: "
                "lend a stream of 8 columns (position, normal, u v), or draw without texture"
            )

    def upload_values(self, values: npt.NDArray[np.float32] | None) -> None:
        """Hand two numbers for each uploaded vertex to OpenGL, (vertex_count, 2); None: zeros.

        ValueError for another shape. Programs that are first drawn with after that have in_values.
        """
        if values is None:
            values = np.zeros((self.vertex_count, 2), np.float32)
        if values.shape != (self.vertex_count, 2):
            raise ValueError(
                f"values has shape {values.shape}; it must be ({self.vertex_count}, 2), two "
                "numbers for each uploaded vertex"
            )
        if self._value_buffer is None:
            room = 2 * self.vertices.itemsize * len(self.vertices)
            self._value_buffer = self._gl.buffer(reserve=room, dynamic=True)
        self._value_buffer.orphan()
        self._value_buffer.write(np.ascontiguousarray(values, np.float32))

    def choose(self, is_chosen: npt.NDArray[np.bool_], is_other: npt.NDArray[np.bool_]) -> None:
        """Choose among the uploaded triangles, twice (triangle_count,), for `draw`."""
        if self._chosen_buffer is None:
            self._chosen_buffer = self._gl.buffer(reserve=self.triangles.nbytes, dynamic=True)
        triangles = self.triangles[: self.triangle_count]
        chosen, others = triangles[is_chosen], triangles[is_other]
        self._ranges[Share.CHOSEN] = 0, len(chosen)
        self._ranges[Share.OTHERS] = len(chosen), len(others)
        self._chosen_buffer.orphan()
        self._chosen_buffer.write(np.concatenate([chosen, others]))

    def draw(self, program: moderngl.Program, share: Share = Share.ALL) -> None:
        """Draw uploaded triangles; attributes in_position, in_normal, in_uv, as needed.

        `share`: BUMPED and SMOOTH need bump_amounts, and give the program in_bumps.
        """
        first, count = self._ranges.get(share, (0, 0))
        if self.vertex_count == 0 or count == 0:
            return
        indices = self._index_buffer
        if share in (Share.CHOSEN, Share.OTHERS):
            assert self._chosen_buffer is not None
            indices = self._chosen_buffer
        elif share is not Share.ALL:
            assert self._bump_buffers is not None
            indices = self._bump_buffers[1]
        array = self._vertex_arrays.get((program, indices))
        if array is None:
            names = ("in_position", "in_normal")
            layout = (
                ("3f 3f", *names) if self.vertices.shape[1] == 6 else ("3f 3f 2f", *names, "in_uv")
            )
            content: list[Any] = [(self._vertex_buffer, *layout)]
            if self._bump_buffers is not None:
                content.append((self._bump_buffers[0], "2f", "in_bumps"))
            if self._value_buffer is not None:
                content.append((self._value_buffer, "2f", "in_values"))
            array = self._gl.vertex_array(
                program,
                content,
                index_buffer=indices,
                index_element_size=4,
                skip_errors=True,  # flat shading has no use for normals, plain skin none for uv
            )
            self._vertex_arrays[program, indices] = array
        array.render(moderngl.TRIANGLES, vertices=3 * count, first=3 * first)
