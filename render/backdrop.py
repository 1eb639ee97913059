"""The background of all viewports, painted once and copied into every frame.

On software OpenGL a copy of the whole frame costs a fiftieth of painting it (measured: 0.16 ms
against 8 ms at 1280 x 720), and a tenth of a copy of a part, which is no plain copying of memory.
"""

import moderngl

from .programs import compile_program
from .render_target import Rectangle, RenderTarget
from .style import Background


class Backdrop:
    """Paints backgrounds into the frame of a surface's target."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._program = compile_program(gl, "background.glsl")
        self._triangle = gl.vertex_array(self._program, [])
        self._store: moderngl.Framebuffer | None = None
        self._stored: tuple[tuple[Rectangle, ...], Background] | None = None

    def paint(
        self, target: RenderTarget, viewports: tuple[Rectangle, ...], background: Background | None
    ) -> None:
        """Paint the background over each viewport; what was drawn there is gone.

        None: nothing is there, not even black.
        """
        if background is None:
            for viewport in viewports:
                target.use_frame(viewport)
                target.frame.clear(0.0, 0.0, 0.0, 0.0, depth=1.0, viewport=viewport)
            target.is_empty = False
            return
        if self._store is None or self._store.size != target.size:
            self._store = self._gl.framebuffer([self._gl.renderbuffer(target.size, 4)])
            self._stored = None
        if self._stored != (viewports, background):
            self._store.use()
            self._gl.scissor = None
            self._store.clear(0.0, 0.0, 0.0, 1.0)  # around them, as an empty frame
            for viewport in viewports:
                self._paint(viewport, background)
            self._stored = viewports, background
        if target.is_empty:
            target.use_frame((0, 0, *target.size))
            self._gl.scissor = None
            self._gl.copy_framebuffer(target.frame, self._store)
            target.is_empty = False
            return
        for viewport in viewports:
            target.use_frame(viewport)  # its scissor restricts the copy to the viewport
            self._gl.copy_framebuffer(target.frame, self._store)
            if not target.samples:  # the frame has depth, and it was drawn on
                target.frame.color_mask = False, False, False, False
                target.frame.clear(depth=1.0, viewport=viewport)
                target.frame.color_mask = True, True, True, True

    def _paint(self, viewport: Rectangle, background: Background) -> None:
        gl = self._gl
        gl.viewport = gl.scissor = viewport
        self._program["centre"] = background.centre
        self._program["edge"] = background.edge
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
