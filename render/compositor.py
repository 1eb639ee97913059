"""Compose the picture of a window from a scene and panels.

Software OpenGL takes time for every sample, so a moving scene may be drawn with fewer samples and
pixels (`Detail`). Then edges.py smooths its edges, and this module enlarges it. The pixels of the
scene are kept: if only a panel changes, they are copied instead of drawn again.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import moderngl

from .edges import EdgeSmoother
from .programs import compile_program
from .render_target import PICTURE_UNIT, NewTexture, Rectangle, RenderTarget, scaled


@dataclass(frozen=True)
class Detail:
    """The resolution of the scene in a window.

    - samples: number of samples per pixel; 0: edges are not smoothed by samples.
    - scale: pixels of the scene per pixel of the window, 0 to 1.
    """

    samples: int = 4
    scale: float = 1.0

    def scaled(self, size: tuple[int, int]) -> tuple[int, int]:
        """Return the scene's width and height in a window of `size` pixels."""
        return max(round(self.scale * size[0]), 1), max(round(self.scale * size[1]), 1)


class Compositor:
    """A framebuffer of the window's size, into which the scene is copied and panels are drawn.

    frame: the framebuffer.
    """

    def __init__(
        self, gl: moderngl.Context, size: tuple[int, int], new_texture: NewTexture
    ) -> None:
        self.size = size
        self._gl = gl
        self._new_texture = new_texture
        self._colour = new_texture(size)
        self.frame = gl.framebuffer([self._colour])
        program = compile_program(gl, "stretch.glsl")
        program["scene"] = PICTURE_UNIT
        self._plain = gl.vertex_array(program, [])
        self._smoother: EdgeSmoother | None = None

    def compose(
        self,
        scene: RenderTarget,
        area: Rectangle | None,
        target: moderngl.Framebuffer | None = None,
    ) -> None:
        """Copy the scene into an area of this frame or of `target`, and bind the framebuffer.

        area: None copies the whole scene.
        """
        gl = self._gl
        target = target or self.frame
        frame = scene.frame
        colour = scene.colour
        if not scene.samples:
            smoother = self._smoother_of(scene.size)
            smoother.smooth(scene, self._in_scene(scene, area))
            frame = smoother.frame
            colour = smoother.colour
        target.use()
        gl.viewport = (0, 0, *self.size)  # set for the bound framebuffer
        gl.scissor = area
        if scene.size == self.size and target is self.frame:
            gl.copy_framebuffer(target, frame)
        else:
            self._draw(colour)
            if area is not None:
                self._mend_borders(area, colour)
        gl.scissor = None

    def _mend_borders(self, area: Rectangle, picture: moderngl.Texture) -> None:
        """Draw the borders of an enlarged area anew, with pixels from further inside.

        Enlargement mixes the outermost pixels of the area with black pixels beside it. To clamp its
        texture coordinates would take twice as long on software OpenGL: 5.8 ms instead of 2.5.
        """
        width, height = self.size
        for strip, (x, y) in _inner_border_strips(area, self.size, picture.size[0] / width):
            self._gl.scissor = strip
            self._gl.viewport = x, y, width, height
            self._draw(picture)
        self._gl.viewport = 0, 0, width, height

    def _draw(self, picture: moderngl.Texture) -> None:
        """Draw a picture over the viewport.

        Windows have their first row at the top, so software OpenGL copies no block of a
        framebuffer into them, and draws faster than it copies row by row.
        """
        gl = self._gl
        is_enlarged = picture.size != self.size
        picture.filter = (moderngl.LINEAR if is_enlarged else moderngl.NEAREST,) * 2
        gl.disable(moderngl.DEPTH_TEST)
        picture.use(PICTURE_UNIT)
        self._plain.render(moderngl.TRIANGLES, vertices=3)
        gl.enable(moderngl.DEPTH_TEST)

    def _smoother_of(self, size: tuple[int, int]) -> EdgeSmoother:
        """Return the smoother for scenes of some size; the last smoother is kept."""
        if self._smoother is None or self._smoother.size != size:
            self._smoother = EdgeSmoother(self._gl, size, self._new_texture)
        return self._smoother

    def _in_scene(self, scene: RenderTarget, area: Rectangle | None) -> Rectangle | None:
        """Convert an area of this frame to pixels of the scene, without its outermost pixels.

        They are left unsmoothed: smoothing would find an edge to black pixels beside the area.
        """
        if area is None:
            return None
        x, y, width, height = scaled(area, scene.size[0] / self.size[0])
        return x + 1, y + 1, max(width - 2, 0), max(height - 2, 0)

    def draw_label(self, x: int, y: int, image: Any) -> None:
        """Draw a label (h, w, 4) into the bound framebuffer; see `WindowSurface.labels`."""
        gl = self._gl
        (height, width, _) = image.shape
        gl.texture((width, height), 4, image[::-1].tobytes()).use(PICTURE_UNIT)
        gl.viewport = x, y, width, height
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._plain.render(moderngl.TRIANGLES, vertices=3)
        gl.enable_only(moderngl.DEPTH_TEST)
        gl.viewport = 0, 0, *self.size

    def copy_to(self, target: moderngl.Framebuffer, around: Rectangle = (0, 0, 0, 0)) -> None:
        """Copy this frame, except the rectangle `around`, to a framebuffer of the same size."""
        target.use()
        self._gl.viewport = (0, 0, *self.size)
        width, height = self.size
        left, bottom, right, top = *around[:2], around[0] + around[2], around[1] + around[3]
        for rectangle in (
            (0, 0, left, height),
            (right, 0, width - right, height),
            (left, 0, right - left, bottom),
            (left, top, right - left, height - top),
        ):
            if rectangle[2] > 0 and rectangle[3] > 0:
                self._gl.scissor = rectangle  # limits the copy
                self._draw(self._colour)
        self._gl.scissor = None

    def read(self) -> bytes:
        """Return the pixels, bottom row first, three bytes each."""
        return bytes(self.frame.read(components=3, alignment=1))


def _inner_border_strips(
    area: Rectangle, size: tuple[int, int], scale: float
) -> Iterator[tuple[Rectangle, tuple[int, int]]]:
    """Yield strips [pixels] inside the borders of an area that are not borders of the frame.

    The second value is how far the picture moves out, so that a strip shows pixels beside it.
    """
    if scale == 1.0:
        return
    depth = math.ceil(0.5 / scale)  # as far as an enlarged pixel is mixed with the next one
    for x, width, right in _bands_with_motion(area[0], area[2], size[0], depth):
        for y, height, up in _bands_with_motion(area[1], area[3], size[1], depth):
            if min(width, height) > 0 and (right or up):
                yield (x, y, width, height), (right, up)


def _bands_with_motion(
    start: int, length: int, frame: int, depth: int
) -> tuple[tuple[int, int, int], ...]:
    """Return first pixel, number of pixels and motion of an area's two borders and its middle."""
    before = depth if start > 0 else 0
    after = depth if start + length < frame else 0
    return (
        (start, before, -before),
        (start + before, length - before - after, 0),
        (start + length - after, after, after),
    )
