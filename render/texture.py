"""Textures of a surface: its albedo, and maps of its fine shape.

The albedo is given as sRGB, and stored as square roots of linear light, which shaders square. Bytes
hold these roots as precisely as sRGB. Software OpenGL blends such bytes directly, in two thirds of
the time of decoding sRGB texel by texel, and blended roots are close to blended light. Mipmaps are
means of linear light, so black and white texels together do not become too dark in the distance.
"""

import moderngl
import numpy as np

from ..geometry.arrays import Floats32
from ..geometry.colour import to_linear
from .surface import Image, Surface, is_software

_SAMPLED_TEXELS = 10_000  # approximate number of texels for the median of redness
LIGHTNESS_WEIGHTS = 0.3, 0.6, 0.1  # weights of red, green and blue in lightness
# Texture units; 4 is `render_target.PICTURE_UNIT`.
_BUMP_UNIT = 5
_AROUND_UNIT = 6
_FINE_UNIT = 7
_AROUND_LEVEL = 5  # highest mipmap level of the mean lightness: of 32 x 32 texels
_AROUND_BITS = 6  # bits of the width of the map of mean lightness; larger pictures have more
MOST_ANISOTROPY = 8.0  # greatest ratio of anisotropic filtering


class _Mipmaps:
    """A texture of bytes with mipmaps.

    size: width and height [texels].
    """

    def __init__(self, surface: Surface, texels: Image) -> None:
        """Upload texels, top row first, (H, W, 2) or (H, W, 4), uint8."""
        surface.make_current()
        self.size = texels.shape[1], texels.shape[0]
        rows = np.ascontiguousarray(texels[::-1])  # OpenGL counts rows, and v, from below
        self._texture = surface.gl.texture(self.size, rows.shape[2], rows)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._texture.build_mipmaps()
        self._texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR


class SkinTexture(_Mipmaps):
    """The albedo of a skin, with ambient occlusion and fine shape.

    - redness: median ratio of red to green light; redder texels are lips, which are glossy.
    - fine_shape: map of two channels, or None.
    """

    def __init__(
        self,
        surface: Surface,
        image: Image,
        occlusion: Image | None = None,
        fine_shape: "BumpMap | None" = None,
        oil: Image | None = None,
    ) -> None:
        """Upload an image to the OpenGL of a surface.

        - image: albedo, sRGB, top row first, (H, W, 3), uint8. Texture coordinate v is 1 at the
          top.
        - occlusion: ambient occlusion, 255 where all ambient light arrives, (H, W), uint8.
        - fine_shape: a map of two channels. Only per-pixel shading shows it, on streams of at least
          16 columns.
        - oil: strength of the highlight, 255 is full, in the layout of the image, (h, w), uint8;
          None: full everywhere.

        Raises ValueError for an image of another shape or type, or beyond the driver's limit.
        """
        gl = surface.gl
        _check_image(image, "texture's image", 3, "sRGB")
        if max(image.shape) > (limit := int(gl.info["GL_MAX_TEXTURE_SIZE"])):
            raise ValueError(
                f"the texture's image has {image.shape[1]} x {image.shape[0]} texels; this driver "
                f"takes at most {limit} in width and height: shrink the image"
            )
        self.redness = _median_redness(image)
        lit = np.full((1, 1), 255, np.uint8) if occlusion is None else occlusion
        if occlusion is not None and occlusion.shape != image.shape[:2]:
            raise ValueError(
                f"the ambient occlusion has shape {occlusion.shape}; it must be "
                f"{image.shape[:2]}, as the texture's image"
            )
        super().__init__(surface, _lit_texels(image, lit))
        texels = _first_halved(image, lit)
        for level in range(1, max(self.size).bit_length()):
            self._texture.write(_square_roots(texels)[::-1].tobytes(), level=level)
            texels = _halved_image(texels)
        # Drivers without this extension report 0. In software OpenGL it is several times slower.
        if gl.max_anisotropy > 1.0 and not is_software(gl.info["GL_RENDERER"]):
            self._texture.anisotropy = min(MOST_ANISOTROPY, gl.max_anisotropy)
        self._around = self._means(gl, oil)
        self.fine_shape = fine_shape

    def _means(self, gl: moderngl.Context, oil: Image | None) -> moderngl.Texture:
        """Make a texture of two channels: the mean lightness around each texel, and its oil."""
        bits = max(self.size).bit_length()
        level = min(max(bits - _AROUND_BITS, 0), _AROUND_LEVEL)
        width, height = (max(each >> level, 1) for each in self.size)
        texels = np.frombuffer(self._texture.read(level=level), np.uint8).reshape(-1, 4)
        values = np.ones((height, width, 2), np.float16)
        means = np.square(texels[:, :3] / 255.0) @ LIGHTNESS_WEIGHTS
        values[..., 0] = means.reshape(height, width)
        if oil is not None:
            rows = np.arange(height) * len(oil) // height
            columns = np.arange(width) * oil.shape[1] // width
            values[..., 1] = oil[::-1][rows[:, None], columns] / 255.0
        around = gl.texture((width, height), 2, values.tobytes(), dtype="f2", alignment=1)
        around.repeat_x = around.repeat_y = False
        return around

    def set_uniforms(self, program: moderngl.Program, unit: int, occlusion: float) -> None:
        """Bind the textures to a program.

        - unit: texture unit of the albedo.
        - occlusion: strength of the ambient occlusion, 0 or 1.
        """
        program["albedo_texture"] = unit
        program["around_texture"] = _AROUND_UNIT
        self._texture.use(unit)
        self._around.use(_AROUND_UNIT)
        program["redness"] = self.redness
        program["lightness_weights"] = LIGHTNESS_WEIGHTS
        program["occlusion"] = occlusion


class BumpMap(_Mipmaps):
    """A bump map: furrows of variable strength (4 channels), or constant fine shape (2 channels).

    - texels: the uploaded array, (H, W, channels).
    - steepest: slope for the byte 255 [unit of the scene per unit of texture coordinates].
    - define: preprocessor name with which programs include the map.
    """

    def __init__(self, surface: Surface, texels: Image, steepest: float, channels: int = 4) -> None:
        """Upload texels to the OpenGL of a surface, top row first, (H, W, channels), uint8.

        The first two channels are slopes of the height along u and v; 128 is flat. The third is
        the depth of the furrow. The fourth blends the two strengths of the stream: 0 takes the
        first, 255 the second. Raises ValueError for another shape or type.
        """
        kind, more = ("fine shape", "") if channels == 2 else ("bump map", ", depth, slot")
        _check_image(texels, kind, channels, f"slopes along u and v{more}")
        self.texels = texels
        self.steepest = steepest
        self.define, self._unit = ("FINE", _FINE_UNIT) if channels == 2 else ("BUMPS", _BUMP_UNIT)
        super().__init__(surface, texels)

    def set_uniforms(self, program: moderngl.Program, strength: float) -> None:
        """Bind the map to a program that includes bumps.glsl; strength: 0 to 1."""
        name = self.define.lower()
        self._texture.use(self._unit)
        program[f"{name}_map"] = self._unit
        program[f"{name}_slope"] = self.steepest
        program[f"{name}_strength"] = strength


def _linear_values() -> Floats32:
    """Return linear light of the 256 sRGB bytes, then 256 equal steps from 0 to 1, (512,)."""
    lights = to_linear(np.arange(256) / 255.0).astype(np.float32)
    fractions = np.arange(256, dtype=np.float32) / np.float32(255.0)
    return np.concatenate([lights, fractions])


def _lit_texels(image: Image, occlusion: Image) -> Image:
    """Return roots of light and of occlusion as bytes, (H, W, 4); occlusion: (H, W) or (1, 1)."""
    from .texture_kernels import write_roots  # here, because numba takes long to import

    texels = np.empty((*image.shape[:2], 4), np.uint8)
    write_roots(image, occlusion, _square_roots(_linear_values()), texels)
    return texels


def _first_halved(image: Image, occlusion: Image) -> Floats32:
    """Light and ambient occlusion of the first mipmap, (H // 2, W // 2, 4)."""
    from .texture_kernels import write_halved

    height, width = image.shape[:2]
    if min(height, width) == 1:
        indices = np.empty((height, width, 4), np.intp)  # indices of `_linear_values()`
        indices[..., :3] = image
        indices[..., 3] = 256 + occlusion.astype(np.intp)
        return _halved_image(_linear_values().take(indices))
    found = np.empty((height // 2, width // 2, 4), np.float32)
    write_halved(image, occlusion, _linear_values(), found)
    return found


def _square_roots(values: Floats32) -> Image:
    """Return square roots of values from 0 to 1, as bytes."""
    return np.rint(255.0 * np.sqrt(values)).astype(np.uint8)


def _halved_image(values: Floats32) -> Floats32:
    """Average blocks of 2 x 2 values, (H, W, C) -> (H // 2, W // 2, C).

    An odd last row or column is left out. A single row or column is kept.
    """
    height, width, channels = values.shape
    half = np.float32(0.5)
    if height > 1:
        values = half * (values[: height // 2 * 2 : 2] + values[1::2])
    if width > 1:
        end = width // 2 * 2
        pairs = np.empty((len(values), width // 2, channels), np.float32)
        for channel in range(channels):  # numpy adds few long rows faster than many short rows
            np.add(values[:, :end:2, channel], values[:, 1:end:2, channel], out=pairs[..., channel])
        values = half * pairs
    return values


def _median_redness(image: Image) -> float:
    """Return the median ratio of red to green light of an image (H, W, 3)."""
    every = max(1, image.shape[0] * image.shape[1] // _SAMPLED_TEXELS)
    light = to_linear(image.reshape(-1, 3)[::every] / 255.0)
    return float(np.median(light[:, 0] / np.maximum(light[:, 1], 1e-3)))


def _check_image(image: Image, name: str, channels: int, meaning: str) -> None:
    """Raise ValueError unless an array is an image with some number of channels."""
    is_image = image.ndim == 3 and image.shape[2] == channels and image.size > 0
    if not is_image or image.dtype != np.uint8:
        raise ValueError(
            f"the {name} has shape {image.shape} and dtype {image.dtype}; it must be "
            f"(height, width, {channels}) uint8: {meaning}, top row first"
        )
