"""Where a scene is drawn: a plain frame, and a multisampled layer that is averaged onto it.

Backgrounds and panels go straight to the plain frame, geometry goes to the layer. Only the
rectangle that geometry touched is averaged: on software OpenGL, where a head fills a third of a
frame, that halves the cost of multisampling (measured: 16 -> 7.5 ms at 1280 x 720). The layer is
wiped just before it is drawn on, when software OpenGL does both tile by tile in the cache.

Invariant: unless `_is_stale`, the layer is transparent and its depth is 1 outside `_drawn_on`.
"""

import math

import moderngl

from .errors import GLError
from .programs import compile_program

Rectangle = tuple[int, int, int, int]  # x, y, width, height [pixels], from the lower left corner

_UNIT = 1  # texture unit of the layer; 0 belongs to the meshes


class RenderTarget:
    """Frame and layer of `size` pixels; with samples 0 the frame is the layer."""

    def __init__(self, gl: moderngl.Context, size: tuple[int, int], samples: int) -> None:
        limit = min(int(gl.info[f"GL_MAX_{kind}_SIZE"]) for kind in ("RENDERBUFFER", "TEXTURE"))
        if max(size) > limit:
            raise GLError(
                f"a frame of {size[0]} x {size[1]} pixels: this driver draws at most {limit} "
                "each way. Cure: ask for a smaller frame"
            )
        self.size = size
        self.samples = samples
        self._gl = gl
        self.frame_number = 0  # counts the frames since the target was made
        self.layer_number = 0  # counts how often the layer was averaged, and so begun anew
        self._drawn_on: Rectangle | None = None
        self._is_stale = False
        self.colour = gl.texture(size, 4)
        self.colour.repeat_x = self.colour.repeat_y = False
        if not samples:
            self.frame = gl.framebuffer([self.colour], gl.depth_renderbuffer(size))
            self._layer = self.frame
            return
        self.frame = gl.framebuffer([self.colour])
        self._layer_colour = gl.texture(size, 4, samples=samples)
        self.layer_depth = gl.depth_texture(size, samples=samples)
        self._layer = gl.framebuffer([self._layer_colour], self.layer_depth)
        self._layer.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        self._average_program = compile_program(gl, "average.glsl", f"SAMPLES {samples}")
        self._average_program["layer"] = _UNIT
        self._average = gl.vertex_array(self._average_program, [])

    def release(self) -> None:
        """Give back everything to OpenGL; nothing can be drawn here any more."""
        # moderngl binds the last bound framebuffer again whenever it makes one.
        self._gl.detect_framebuffer(0).use()
        self.frame.release()
        self.colour.release()
        if self.samples:
            self._layer.release()
            self._layer_colour.release()
            self.layer_depth.release()
            self._average.release()
            self._average_program.release()

    def start(self) -> None:
        """Empty both; the frame is bound."""
        self.frame_number += 1
        self.use_frame()
        self.frame.clear(0.0, 0.0, 0.0, 1.0, depth=1.0)

    def use_frame(self) -> None:
        """Direct drawing to the frame, over all that was drawn so far."""
        self.flush()
        self.frame.use()
        self._gl.viewport = (0, 0, *self.size)
        self._gl.scissor = None

    def use_layer(self, viewport: Rectangle, part: Rectangle) -> None:
        """Direct drawing to the layer, within `part` of the viewport."""
        self._clear_layer()
        self._layer.use()
        self._gl.viewport = viewport
        self._gl.scissor = part
        drawn_on = self._drawn_on
        self._drawn_on = part if drawn_on is None else bounding_rectangle(drawn_on, part)

    def flush(self) -> None:
        """Average the layer onto the frame where it was touched."""
        rectangle, self._drawn_on = self._drawn_on, None
        if not self.samples or rectangle is None:
            return
        gl = self._gl
        self.frame.use()
        gl.viewport = 0, 0, *self.size
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA  # the layer is premultiplied
        self._layer_colour.use(_UNIT)
        gl.scissor = rectangle
        self._average.render(moderngl.TRIANGLES, vertices=3)
        gl.enable_only(moderngl.DEPTH_TEST)
        gl.scissor = None
        self._is_stale = True
        self.layer_number += 1

    def _clear_layer(self) -> None:
        """Empty the layer, if all that is on it was averaged onto the frame."""
        if not self._is_stale:
            return
        self._layer.use()
        self._gl.scissor = None
        self._layer.depth_mask = True
        self._layer.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        self._is_stale = False

    def read(self, components: int = 3) -> bytes:
        """The frame, bottom row first, three bytes per pixel, or four."""
        self.flush()
        return bytes(self.frame.read(components=components, alignment=1))


def scaled(viewport: Rectangle, scale: float) -> Rectangle:
    """The pixels of a viewport on a target of another scale; ValueError for one without any."""
    left, bottom, width, height = viewport
    if width < 1 or height < 1:
        raise ValueError(
            f"viewport is {viewport}; it must be (x, y, width, height) of 1 pixel or more"
        )
    if scale == 1.0:
        return viewport
    x = math.floor(scale * left)
    y = math.floor(scale * bottom)
    right = math.ceil(scale * (left + width))
    top = math.ceil(scale * (bottom + height))
    return x, y, right - x, top - y


def intersection(first: Rectangle, second: Rectangle) -> Rectangle:
    """The pixels of both rectangles; a width or height of 0 where they share none."""
    left = max(first[0], second[0])
    bottom = max(first[1], second[1])
    right = min(first[0] + first[2], second[0] + second[2])
    top = min(first[1] + first[3], second[1] + second[3])
    return left, bottom, max(right - left, 0), max(top - bottom, 0)


def bounding_rectangle(first: Rectangle, second: Rectangle) -> Rectangle:
    """The smallest rectangle that holds both."""
    left = min(first[0], second[0])
    bottom = min(first[1], second[1])
    right = max(first[0] + first[2], second[0] + second[2])
    top = max(first[1] + first[3], second[1] + second[3])
    return left, bottom, right - left, top - bottom
