"""Smooth outlines where a pixel has but one sample: a fading fringe along each contour of the mesh.

Contours are the edges between a triangle that turns to the eye and one that turns away, and the
mesh's borders. Along each a fringe of one pixel is drawn outward, shaded as the skin beside it,
that fades over what lies behind. Only these pixels are shaded; no picture is filtered afterwards.
Source: Sander, Hoppe, Snyder, Gortler 2001, "Discontinuity edge overdraw".
"""

from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from .camera_view import CameraView

WIDTH = 1.0  # [pixels] in which a fringe fades: as far as the steps of its edge reach
_SHORTEST = 1e-3  # [pixels] of an edge that has a direction
# The corners of a fringe's two triangles: at which end of the edge, and whether on the outer side.
_ENDS = np.array([0, 0, 1, 0, 1, 1])
_SIDES = np.array([0, 1, 1, 0, 1, 0])

IN_PLACE = np.eye(4)
Floats = npt.NDArray[np.float32]


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
