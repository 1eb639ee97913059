"""Draw the depths of dense hair first, so that skin below it is not shaded."""

from collections.abc import Sequence

import moderngl

from .camera import PlacedView
from .parts import PlacedBuffers
from .programs import write_uniform
from .render_target import RenderTarget
from .translucency import changing_depth_alone

POLYGON_OFFSET = 1.0, 4.0  # factor and units of glPolygonOffset


def hide_below(
    parts: Sequence[PlacedBuffers],
    view: PlacedView,
    target: RenderTarget,
    program: moderngl.Program,
) -> None:
    """Write the depths of dense hair, so that skin below it is not shaded.

    parts: all parts except hair are ignored. program: shadow.glsl with the define SHELLS.
    """
    # These depths equal those of the lowest layer of hair, so rounding would hide parts of it.
    program.ctx.polygon_offset = POLYGON_OFFSET
    for each in parts:
        if each.buffers.kind != "SHELLS":
            continue
        covered = view.covered_pixels(each.corners)
        if min(covered[2:]) <= 0:
            continue
        write_uniform(program, "to_clip", each.part.transform.T @ view.world_to_clip)
        target.use(view.viewport, covered)
        with changing_depth_alone(program.ctx):
            each.buffers.draw_hiding(program, view)
    program.ctx.polygon_offset = 0.0, 0.0
