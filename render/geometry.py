"""Geometry that is not a lent stream: rigid parts, polylines, and one number per triangle."""

from collections.abc import Sequence
from typing import Any, Protocol

import moderngl
import numpy as np
import numpy.typing as npt

from .sight import box_corners
from .style import Colour, linear

SPLITS_PER_ROW = 1024  # texels per row of the split texture; surface.glsl reads it so


class Part(Protocol):
    """What is read of a rigid part.

    name: for messages. vertices, normals: shape (n, 3), float32.
    faces: counter-clockwise from the side that is seen, shape (m, 3), int32; the other side is not
        drawn. colours: sRGB 0..1, shape (n, 3), float32.
    bone: whose transform moves it. shine: 0 dull, 1 wet.
    """

    @property
    def name(self) -> str: ...
    @property
    def vertices(self) -> npt.NDArray[np.float32]: ...
    @property
    def normals(self) -> npt.NDArray[np.float32]: ...
    @property
    def faces(self) -> npt.NDArray[np.int32]: ...
    @property
    def colours(self) -> npt.NDArray[np.float32]: ...
    @property
    def bone(self) -> str: ...
    @property
    def shine(self) -> float: ...


class PartBuffers:
    """A rigid part on the graphics card, uploaded once; keeps the part alive, and so its id."""

    def __init__(self, gl: moderngl.Context, part: Part) -> None:
        self.part = part
        shapes = {np.shape(part.vertices), np.shape(part.normals), np.shape(part.colours)}
        if len(shapes) != 1 or np.shape(part.vertices)[1:] != (3,):
            raise ValueError(
                f"part '{part.name}': vertices {np.shape(part.vertices)}, normals "
                f"{np.shape(part.normals)} and colours {np.shape(part.colours)} must all be (n, 3)"
            )
        self.corners = box_corners(part.vertices)
        rows = np.hstack([part.vertices, part.normals, linear(part.colours)]).astype(np.float32)
        self._gl = gl
        self._vertices = gl.buffer(rows.tobytes())
        self._indices = gl.buffer(np.ascontiguousarray(part.faces, np.uint32).tobytes())
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def draw(self, program: moderngl.Program) -> None:
        """Draw it with a program that has in_position, in_normal and in_colour."""
        if program not in self._arrays:
            self._arrays[program] = self._gl.vertex_array(
                program,
                [(self._vertices, "3f 3f 3f", "in_position", "in_normal", "in_colour")],
                index_buffer=self._indices,
                index_element_size=4,
            )
        self._gl.enable(moderngl.CULL_FACE)
        self._arrays[program].render(moderngl.TRIANGLES)
        self._gl.disable(moderngl.CULL_FACE)


class SplitTexture:
    """One small number per triangle, for the fragment shader to look up by gl_PrimitiveID."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._texture: moderngl.Texture | None = None
        self._rows = np.zeros((0, SPLITS_PER_ROW), np.uint8)

    def upload(self, values: npt.NDArray[np.uint8]) -> None:
        """Hand over the numbers, shape (M,), uint8; the texture grows only when it must."""
        row_count = max(-(-len(values) // SPLITS_PER_ROW), 1)
        if self._texture is None or row_count > len(self._rows):
            if self._texture is not None:
                self._texture.release()
            rows = max(row_count, 2 * len(self._rows))
            self._rows = np.zeros((rows, SPLITS_PER_ROW), np.uint8)
            self._texture = self._gl.texture((SPLITS_PER_ROW, rows), 1, dtype="u1", alignment=1)
        self._rows.reshape(-1)[: len(values)] = values
        self._texture.write(
            self._rows[:row_count], viewport=(0, 0, SPLITS_PER_ROW, row_count), alignment=1
        )

    def bind(self, unit: int) -> int:
        """Bind the texture to a texture unit, and return that unit."""
        if self._texture is not None:
            self._texture.use(unit)
        return unit


class LineBuffer:
    """Polylines as coloured segments, rewritten whenever lines are drawn."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._vertices: moderngl.Buffer | None = None
        self._indices: moderngl.Buffer | None = None
        self._array: moderngl.VertexArray | None = None
        self._index_count = 0
        self.corners = np.zeros((8, 3))

    def upload(
        self,
        program: moderngl.Program,
        polylines: Sequence[npt.NDArray[Any]],
        colour: Colour | npt.NDArray[Any],
    ) -> bool:
        """Hand over the lines; whether there is any segment to draw."""
        rows, segments = line_segments(polylines, colour)
        self._index_count = segments.size
        if not self._index_count:
            return False
        self.corners = box_corners(rows[:, :3])
        if (
            self._vertices is None
            or self._indices is None
            or rows.nbytes > self._vertices.size
            or segments.nbytes > self._indices.size
        ):
            self._allocate(program, 2 * rows.nbytes, 2 * segments.nbytes)
        assert self._vertices is not None and self._indices is not None
        self._vertices.orphan()
        self._vertices.write(rows)
        self._indices.orphan()
        self._indices.write(segments)
        return True

    def draw(self) -> None:
        """Draw the lines with the program they were uploaded for."""
        if self._array is not None:
            self._array.render(moderngl.LINES, vertices=self._index_count)

    def _allocate(self, program: moderngl.Program, vertex_bytes: int, index_bytes: int) -> None:
        for resource in (self._array, self._vertices, self._indices):
            if resource is not None:
                resource.release()
        self._vertices = self._gl.buffer(reserve=vertex_bytes, dynamic=True)
        self._indices = self._gl.buffer(reserve=index_bytes, dynamic=True)
        self._array = self._gl.vertex_array(
            program,
            [(self._vertices, "3f 3f", "in_position", "in_colour")],
            index_buffer=self._indices,
            index_element_size=4,
        )


def line_segments(
    polylines: Sequence[npt.NDArray[Any]], colour: Colour | npt.NDArray[Any]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]:
    """Return position and sRGB of all points, (n, 6) float32, and segments, (s, 2) uint32."""
    colours = np.asarray(colour, np.float32)
    if colours.shape not in ((3,), (len(polylines), 3)):
        raise ValueError(
            f"colour has shape {colours.shape}; it must be (3,), or one row per line: "
            f"({len(polylines)}, 3)"
        )
    counts = np.array([len(line) for line in polylines], np.int64)
    if not counts.sum():
        return np.zeros((0, 6), np.float32), np.zeros((0, 2), np.uint32)
    rows = np.empty((int(counts.sum()), 6), np.float32)
    np.concatenate([np.reshape(line, (-1, 3)) for line in polylines], out=rows[:, :3])
    rows[:, 3:] = colours if colours.ndim == 1 else np.repeat(colours, counts, axis=0)
    starts = np.arange(len(rows) - 1, dtype=np.uint32)
    ends_of_lines = np.cumsum(counts)[:-1] - 1
    is_segment = np.ones(len(starts), bool)
    is_segment[ends_of_lines[(ends_of_lines >= 0) & (ends_of_lines < len(starts))]] = False
    starts = starts[is_segment]
    return rows, np.stack([starts, starts + 1], axis=1)
