"""Depths of dense hair, drawn first so that hidden skin is not shaded."""

from collections.abc import Sequence

import moderngl

from .camera import PlacedView
from .parts import PlacedBuffers
from .programs import write_uniform
from .render_target import RenderTarget
from .translucency import changing_depth_alone

FARTHER = 1.0, 4.0  # as glPolygonOffset takes it: of a pixel's slope, and least steps of depth


def hide_below(
    parts: Sequence[PlacedBuffers],
    view: PlacedView,
    target: RenderTarget,
    program: moderngl.Program,
) -> None:
    """Draw the depth of dense hair among parts, by shadow.glsl with SHELLS."""
    # It is so near to the lowest layer of hair that rounding would also hide parts of this layer.
    program.ctx.polygon_offset = FARTHER
    for each in parts:
        covered = view.covered_pixels(each.corners)
        if each.buffers.kind != "SHELLS" or min(covered[2:]) <= 0:
            continue
        write_uniform(program, "to_clip", each.part.transform.T @ view.world_to_clip)
        target.use(view.viewport, covered)
        with changing_depth_alone(program.ctx):
            each.buffers.draw_hiding(program, view)
    program.ctx.polygon_offset = 0.0, 0.0
