"""Lines and shades that are drawn over a finished picture."""

from collections.abc import Callable

import moderngl

from .camera import PlacedView, box_corners
from .lines import Lines
from .programs import write_uniform
from .shade import Shade
from .surface import Surface
from .translucency import blending

Overlay = Lines | Shade


class OverlayPainter:
    """Draws overlays on a surface, after the surface's depths are known."""

    def __init__(self, surface: Surface, program: Callable[[str], moderngl.Program]) -> None:
        """program: returns the program of a shader file."""
        self._surface = surface
        self._program = program

    def draw(self, overlay: Overlay, view: PlacedView) -> None:
        """Draw one overlay."""
        if isinstance(overlay, Lines):
            self._draw_lines(overlay, view)
        else:
            self._draw_shade(overlay, view)

    def _draw_lines(self, lines: Lines, view: PlacedView) -> None:
        """Draw polylines; they shine through surfaces in front of them."""
        surface = self._surface
        program = self._program("lines.glsl")
        rows, segments = lines.segments()
        if not len(segments):
            return
        width = lines.width * surface.pixel_scale * surface.scale
        write_uniform(program, "world_to_clip", view.world_to_clip)
        program["viewport_size"] = view.viewport[2:]
        program["half_width"] = 0.5 * width
        covered = view.covered_pixels(box_corners(rows[:, :3]), 2.0 + width)
        if min(covered[2:]) <= 0:
            return
        surface.target.use(view.viewport, covered)
        gl = surface.gl
        content = [(gl.buffer(rows), "3f 3f", "in_position", "in_colour")]
        drawn = gl.vertex_array(program, content, gl.buffer(segments))
        with blending(gl):
            for depth_func, opacity in ((">", lines.hidden_opacity), ("<=", lines.opacity)):
                if opacity > 0.0:
                    gl.depth_func = depth_func
                    program["opacity"] = opacity
                    drawn.render(moderngl.LINES)

    def _draw_shade(self, shade: Shade, view: PlacedView) -> None:
        """Draw a shade where nothing hides its surface."""
        rows, triangles = shade.triangles(view.camera.eye)
        if not len(triangles):
            return
        covered = view.covered_pixels(box_corners(rows[:, :3]))
        if min(covered[2:]) <= 0:
            return
        surface = self._surface
        program = self._program("shade.glsl")
        write_uniform(program, "world_to_clip", view.world_to_clip)
        program["colour"] = shade.colour
        surface.target.use(view.viewport, covered)
        gl = surface.gl
        content = [(gl.buffer(rows), "3f 1f", "in_position", "in_opacity")]
        drawn = gl.vertex_array(program, content, gl.buffer(triangles))
        with blending(gl):
            gl.depth_func = "<="
            drawn.render(moderngl.TRIANGLES)
