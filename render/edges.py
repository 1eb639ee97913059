"""Smooth the edges of a scene with one sample per pixel.

A first pass finds the edges, and a second pass smooths them. On software OpenGL both passes take
half the time of a single pass, because the early depth test skips pixels without edges.
"""

import moderngl

from .programs import compile_program
from .render_target import PICTURE_UNIT, NewTexture, Rectangle, RenderTarget


class EdgeSmoother:
    """A copy of a scene with smooth edges, for scenes of one size.

    colour: texture with the copy. frame: framebuffer of this texture.
    """

    def __init__(
        self, gl: moderngl.Context, size: tuple[int, int], new_texture: NewTexture
    ) -> None:
        self.size = size
        self._gl = gl
        self.colour = new_texture(size)
        found = gl.depth_renderbuffer(size)
        self.frame = gl.framebuffer([self.colour], found)
        self._edges = gl.framebuffer(depth_attachment=found)
        self._find = self._pass("FIND")
        self._smooth = self._pass()
        self._smoothed: tuple[RenderTarget, int, Rectangle | None] | None = None

    def _pass(self, *defines: str) -> moderngl.VertexArray:
        """Make a pass over all pixels of the scene with some defines."""
        program = compile_program(self._gl, "edges.glsl", *defines)
        program["scene"] = PICTURE_UNIT
        return self._gl.vertex_array(program, [])

    def smooth(self, scene: RenderTarget, area: Rectangle | None) -> None:
        """Copy a scene, and smooth its edges in an area; None smooths all.

        A second call for the same frame and area does nothing.
        """
        frame = scene, scene.frame_number, area
        if self._smoothed == frame:
            return
        self._smoothed = frame
        gl = self._gl
        gl.scissor = None
        gl.copy_framebuffer(self.frame, scene.frame)
        scene.colour.use(PICTURE_UNIT)
        gl.enable_only(moderngl.DEPTH_TEST)
        self._edges.use()
        self._edges.clear(depth=1.0)
        gl.viewport = 0, 0, *self.size
        gl.scissor = area
        self._find.render(moderngl.TRIANGLES, vertices=3)
        self.frame.depth_mask = False
        self.frame.use()
        gl.viewport = 0, 0, *self.size
        gl.scissor = area
        gl.depth_func = "=="
        self._smooth.render(moderngl.TRIANGLES, vertices=3)
        gl.depth_func = "<="
        gl.scissor = None
