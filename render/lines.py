"""Polylines over a scene, and smooth outlines where a pixel has but one sample.

Outlines are fading fringes along the contours of a mesh: the edges between a triangle that turns to
the eye and one that turns away, and the mesh's borders. Along each a fringe of one pixel is drawn
outward, shaded as the skin beside it, that fades over what lies behind. Only these pixels are
shaded; no picture is filtered afterwards.
Source: Sander, Hoppe, Snyder, Gortler 2001, "Discontinuity edge overdraw".
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import moderngl
import numpy as np
import numpy.typing as npt

from .camera import CameraView
from .style import Colour

WIDTH = 1.0  # [pixels] in which a fringe fades: as far as the steps of its edge reach
_SHORTEST = 1e-3  # [pixels] of an edge that has a direction
# The corners of a fringe's two triangles: at which end of the edge, and whether on the outer side.
_ENDS = np.array([0, 0, 1, 0, 1, 1])
_SIDES = np.array([0, 1, 1, 0, 1, 0])

IN_PLACE = np.eye(4)
Floats = npt.NDArray[np.float32]


class Lines(NamedTuple):
    """Polylines, which shine through what hides them."""

    polylines: Sequence[npt.NDArray[Any]]
    """Points of each line, shape (n, 3)."""
    colour: Colour | npt.NDArray[Any]
    """sRGB of all lines, or one row per line, shape (len(polylines), 3)."""
    width: float = 1.6
    """[pixels at scale 1]"""
    hidden_opacity: float = 0.45
    """0 to 1, behind something."""
    opacity: float = 1.0
    """0 to 1, in front."""

    def segments(self) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]:
        """Position and sRGB of all points, (n, 6), and the ends of each segment, (s, 2).

        Raises ValueError for another number of colours.
        """
        polylines, colours = self.polylines, np.asarray(self.colour, np.float32)
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
        is_last = np.zeros(len(rows), bool)
        is_last[np.cumsum(counts)[counts > 0] - 1] = True
        starts = np.flatnonzero(~is_last).astype(np.uint32)
        return rows, np.stack([starts, starts + 1], axis=1)


def draw_fringes(gl: moderngl.Context, program: moderngl.Program, rows: Floats) -> None:
    """Draw rows of `fringes` with a program that has in_fringe and what a mesh or a part has."""
    layout, *more = {9: ("",), 11: ("2f ", "in_uv"), 12: ("3f ", "in_colour")}[rows.shape[1]]
    names = "in_position", "in_normal", *more, "in_fringe"
    content: list[Any] = [(gl.buffer(rows), f"3f 3f {layout}3f", *names)]
    gl.vertex_array(program, content, skip_errors=True).render(moderngl.TRIANGLES)


def fringes(
    vertices: Floats, triangles: npt.NDArray[Any], view: CameraView, bone: npt.ArrayLike = IN_PLACE
) -> Floats:
    """Two triangles for each contour: the mesh's columns, offset in clip space x y, coverage.

    bone: what moves the vertices, for column vectors, shape (4, 4).
    """
    matrix = (np.transpose(bone) @ view.world_to_clip).astype(np.float32)
    clip = matrix[:3].T @ vertices[:, :3].T + matrix[3][:, None]  # by column
    half_size = 0.5 * np.array(view.viewport[2:], np.float32)
    x, y = clip[:2] / np.maximum(clip[3], np.float32(1e-6)) * half_size[:, None]
    a, b, c = np.ascontiguousarray(triangles.T)
    area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
    is_front = area > 0.0
    if clip[3].min(initial=1.0) <= 0.0:  # behind the eye
        is_front &= (clip[3] > 0.0)[triangles].all(axis=1)
    ends = contours(triangles[is_front])
    along = np.stack([x[ends[1]] - x[ends[0]], y[ends[1]] - y[ends[0]]], axis=1)
    length = np.hypot(along[:, 0], along[:, 1])
    is_long = length > _SHORTEST
    ends, along, length = ends[:, is_long], along[is_long], length[is_long]
    rows = np.zeros((2, 2, len(length), vertices.shape[1] + 3), np.float32)  # by end and side
    rows[:, :, :, :-3] = vertices[ends][:, None]
    # Seen from the front a triangle lies to the left of its edges: outward is right.
    rows[:, 1, :, -3] = along[:, 1] * (WIDTH / half_size[0]) / length
    rows[:, 1, :, -2] = along[:, 0] * (-WIDTH / half_size[1]) / length
    rows[:, 0, :, -1] = 1.0
    return np.ascontiguousarray(rows[_ENDS, _SIDES].swapaxes(0, 1).reshape(-1, rows.shape[3]))


def contours(front: npt.NDArray[np.uint32]) -> npt.NDArray[np.intp]:
    """First and last vertex of the edges that only one of these triangles has, shape (2, n).

    They run as in that triangle. Of all triangles that turn to the eye these are the contours.
    """
    first = front.astype(np.int64)
    last = first[:, [1, 2, 0]].ravel()
    first = first.ravel()
    # Sorted by their ends, edges between two triangles stand side by side.
    size, count = int(first.max(initial=0)) + 1, max(len(first), 1)
    order = (np.minimum(first, last) * size + np.maximum(first, last)) * count
    order += np.arange(len(first))
    order.sort()
    edge = order // count
    is_other = np.ones(len(edge) + 1, np.bool_)
    np.not_equal(edge[1:], edge[:-1], out=is_other[1:-1])
    found = order[is_other[1:] & is_other[:-1]] % count
    return np.stack([first[found], last[found]])
