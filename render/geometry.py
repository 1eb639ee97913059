"""Geometry beside the lent streams: polylines, and one number per triangle."""

from collections.abc import Sequence
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from .style import Colour

VALUES_PER_ROW = 1024  # texels per row of the value texture; surface.glsl reads it so


def value_texture(gl: moderngl.Context, values: npt.NDArray[np.uint8]) -> moderngl.Texture:
    """One small number per triangle, shape (M,), to be looked up by gl_PrimitiveID."""
    rows = np.zeros((max(-(-len(values) // VALUES_PER_ROW), 1), VALUES_PER_ROW), np.uint8)
    rows.reshape(-1)[: len(values)] = values
    return gl.texture((VALUES_PER_ROW, len(rows)), 1, rows.tobytes(), dtype="u1", alignment=1)


def check_columns(columns: int) -> None:
    """Raise ValueError where rows of a mesh have no texture coordinates, but a texture comes."""
    if columns != 8:
        raise ValueError(
            f"a texture meets a stream of {columns} columns; it needs texture coordinates: "
            "lend a stream of 8 columns (position, normal, u v), or draw without texture"
        )


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
