"""Geometry beside the lent streams: polylines, and one number per triangle."""

from collections.abc import Sequence
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from .style import Colour

VALUES_PER_ROW = 1024  # texels per row of the value texture; surface.glsl reads it so


class ValueTexture:
    """One small number per triangle, for the fragment shader to look up by gl_PrimitiveID."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._texture: moderngl.Texture | None = None
        self._rows = np.zeros((0, VALUES_PER_ROW), np.uint8)

    def upload(self, values: npt.NDArray[np.uint8]) -> None:
        """Hand over the numbers, shape (M,), uint8; the texture grows only when it must."""
        row_count = max(-(-len(values) // VALUES_PER_ROW), 1)
        if self._texture is None or row_count > len(self._rows):
            rows = max(row_count, 2 * len(self._rows))
            self._rows = np.zeros((rows, VALUES_PER_ROW), np.uint8)
            self._texture = self._gl.texture((VALUES_PER_ROW, rows), 1, dtype="u1", alignment=1)
        self._rows.reshape(-1)[: len(values)] = values
        self._texture.write(
            self._rows[:row_count], viewport=(0, 0, VALUES_PER_ROW, row_count), alignment=1
        )

    def bind(self, unit: int) -> int:
        """Bind the texture to a texture unit, and return that unit."""
        if self._texture is not None:
            self._texture.use(unit)
        return unit


def checked_values(
    values: npt.NDArray[np.uint8] | None, triangle_count: int
) -> npt.NDArray[np.uint8]:
    """The numbers to colour so many triangles by; ValueError where they are no such thing."""
    if values is None:
        raise ValueError("the style colours by values, so draw_mesh needs values, one per triangle")
    if values.shape != (triangle_count,) or values.dtype != np.uint8:
        raise ValueError(
            f"values has shape {values.shape} and dtype {values.dtype}; it must be "
            f"({triangle_count},) uint8, one per uploaded triangle"
        )
    return values


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
