"""The target into which a scene is drawn: the colour, and the surface number, of each pixel.

Each pixel is shaded once. If a pixel shows several surfaces, `sample_mixer.py` mixes their colours.
"""

import math
from collections.abc import Callable, Sequence
from functools import partial

import moderngl
import numpy as np

from ..geometry.arrays import Unsigned8
from .errors import GLError

Rectangle = tuple[int, int, int, int]  # x, y, width, height [pixels], from the lower left corner
NewTexture = Callable[[tuple[int, int]], moderngl.Texture]
"""Makes a texture of four bytes per texel that is clamped at its borders, of a size [pixels]."""
PICTURE_UNIT = 4  # texture unit of the picture that a pass reads or makes, beside those of the skin


class RenderTarget:
    """Textures of `size` pixels, into which a scene is drawn.

    samples: number of samples per pixel that smooth edges; 0: edges are not smoothed.
    colour: texture with the picture.
    surfaces: texture with surface numbers and depths, see surface_number.glsl.
    frame: framebuffer with the colour and a depth buffer.
    new_texture: makes textures to and from which the colour is copied.
    """

    def __init__(
        self,
        gl: moderngl.Context,
        size: tuple[int, int],
        samples: int,
        new_texture: NewTexture | None = None,
    ) -> None:
        limit = min(int(gl.info[f"GL_MAX_{kind}_SIZE"]) for kind in ("RENDERBUFFER", "TEXTURE"))
        if max(size) > limit:
            raise GLError(
                f"a frame of {size[0]} x {size[1]} pixels: this driver draws at most {limit} "
                "in width and height. Cure: ask for a smaller frame"
            )
        self.size = size
        self.samples = samples
        self._gl = gl
        self.frame_number = 0  # number of frames since the target was made
        self.new_texture = new_texture or partial(clamped_texture, gl)
        self.colour = self.new_texture(size)
        self.surfaces = clamped_texture(gl, size)
        depth = gl.depth_renderbuffer(size)
        self.frame = gl.framebuffer([self.colour], depth)
        self._numbered = gl.framebuffer([self.surfaces])
        both = [self.colour, self.surfaces] if samples else [self.colour]
        self._both = gl.framebuffer(both, depth)

    def release(self) -> None:
        """Release all textures and framebuffers; afterwards no drawing is possible."""
        # moderngl binds the last bound framebuffer again when it makes a new one, so unbind ours.
        self._gl.detect_framebuffer(0).use()
        for each in (self.frame, self._numbered, self._both, self.colour, self.surfaces):
            each.release()

    def start(self) -> None:
        """Clear the target and bind its frame."""
        self.frame_number += 1
        self.forget_surfaces()
        self.use_frame()
        self.frame.clear(0.0, 0.0, 0.0, 1.0, depth=1.0)

    def forget_surfaces(self) -> None:
        """Make all earlier drawings background, so that their edges are not smoothed again."""
        if self.samples:
            self._gl.scissor = None
            self._numbered.clear(green=1.0)  # the number 0, and the greatest depth

    def use_frame(self) -> None:
        """Draw into the whole frame from now on, over all earlier drawings."""
        self.use((0, 0, *self.size), None)

    def use(
        self, viewport: Rectangle, part: Rectangle | None, *, has_numbers: bool = False
    ) -> None:
        """Draw into a viewport of the frame from now on.

        part: rectangle to which drawing is limited; None: the whole viewport.
        has_numbers: whether programs also write surface numbers.
        """
        (self._both if has_numbers else self.frame).use()
        self._gl.viewport = viewport
        self._gl.scissor = part

    def read(self, components: int = 3) -> bytes:
        """Return the pixels of the frame, bottom row first; components: bytes per pixel, 3 or 4."""
        return bytes(self.frame.read(components=components, alignment=1))

    def read_area(self, area: Rectangle) -> tuple[Unsigned8, Unsigned8]:
        """Return colours and surfaces of an area, bottom row first, both (H, W, 4), uint8."""
        shape = area[3], area[2], 4
        colours = self.frame.read(viewport=area, components=4)
        surfaces = self._numbered.read(viewport=area, components=4)
        return (
            np.frombuffer(colours, np.uint8).reshape(shape),
            np.frombuffer(surfaces, np.uint8).reshape(shape),
        )


def clamped_texture(gl: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    """Return a texture of four bytes per texel that is clamped at its borders."""
    texture = gl.texture(size, 4)
    texture.repeat_x = texture.repeat_y = False
    return texture


def scaled(viewport: Rectangle, scale: float) -> Rectangle:
    """Return a viewport, scaled and rounded outward; raises ValueError if it has no pixels."""
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


def around(rectangles: Sequence[Rectangle]) -> Rectangle:
    """Return the smallest rectangle that contains all given rectangles."""
    left = min(each[0] for each in rectangles)
    bottom = min(each[1] for each in rectangles)
    right = max(each[0] + each[2] for each in rectangles)
    top = max(each[1] + each[3] for each in rectangles)
    return left, bottom, right - left, top - bottom


def intersection(first: Rectangle, second: Rectangle) -> Rectangle:
    """Return the intersection of two rectangles; its width or height is 0 if it is empty."""
    left = max(first[0], second[0])
    bottom = max(first[1], second[1])
    right = min(first[0] + first[2], second[0] + second[2])
    top = min(first[1] + first[3], second[1] + second[3])
    return left, bottom, max(right - left, 0), max(top - bottom, 0)
