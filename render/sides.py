"""Draw the sides of a mesh one after another."""

from collections.abc import Sequence

import moderngl

from .stream import MeshBuffers, TriangleGroup
from .translucency import blending, changing_depth_alone

DrawnGroups = Sequence[tuple[moderngl.Program, TriangleGroup]]
"""Programs, and the groups of triangles that they draw."""


def draw_sides(
    gl: moderngl.Context, stream: MeshBuffers, front: DrawnGroups, back: DrawnGroups
) -> None:
    """Draw front faces first; then most back faces are hidden, and software skips them.

    Software computes both branches of a condition for every pixel, so front faces have programs
    without the inner side.
    """
    gl.enable(moderngl.CULL_FACE)
    for culled, drawn in (("back", front), ("front", back)):
        gl.cull_face = culled
        for program, group in drawn:
            stream.draw(program, group)
    gl.cull_face = "back"
    gl.disable(moderngl.CULL_FACE)


def draw_nearest(
    gl: moderngl.Context,
    stream: MeshBuffers,
    groups: DrawnGroups,
    *,
    is_cut: bool,
) -> None:
    """Blend only the nearest layer of a mesh: draw depths first, then colours at these depths.

    is_cut: whether a part of the mesh is opaque; its inner side is then drawn first.
    """
    gl.enable(moderngl.CULL_FACE)
    if is_cut:
        gl.cull_face = "front"
        for program, group in groups:
            stream.draw(program, group)
    gl.cull_face = "back"
    with changing_depth_alone(gl):
        for program, group in groups:
            stream.draw(program, group)
    with blending(gl):
        for program, group in groups:
            stream.draw(program, group)
    gl.disable(moderngl.CULL_FACE)
