"""A picture on the skin: the albedo at each texture coordinate.

The picture is sRGB and stays so in memory; OpenGL decodes each texel before it filters, so that the
mean of black and white is what the eye sees from afar, not a darker grey.
"""

import moderngl
import numpy as np
import numpy.typing as npt

from .style import linear
from .surface import is_software

_SRGB8_ALPHA8 = 0x8C43  # the constant of OpenGL; moderngl has no name for it
_LOOKED_AT = 10_000  # about so many texels decide what is red
ANISOTROPY = 8.0  # most texels that one sample averages along its longest axis


class Texture:
    """A picture on the graphics card; `Renderer.load_texture` makes it.

    size: width and height [texels].
    redness: median of red over green light; where the picture is redder, lips are, and they gloss.
    """

    def __init__(
        self,
        gl: moderngl.Context,
        image: npt.NDArray[np.uint8],
        openness: npt.NDArray[np.uint8] | None = None,
    ) -> None:
        rows = _checked(image, int(gl.info["GL_MAX_TEXTURE_SIZE"]))
        if openness is not None and (
            openness.shape != rows.shape[:2] or openness.dtype != np.uint8
        ):
            raise ValueError(
                f"openness has shape {openness.shape} and dtype {openness.dtype}; it must be "
                f"{rows.shape[:2]} uint8, as the texture's image"
            )
        self.size = rows.shape[1], rows.shape[0]
        self.redness = _median_redness(rows)
        texels = np.full((*rows.shape[:2], 4), 255, np.uint8)
        texels[:, :, :3] = rows[::-1]  # OpenGL counts rows, and v, from below
        if openness is not None:
            texels[:, :, 3] = openness[::-1]  # alpha is not decoded as sRGB is
        self._texture = gl.texture(self.size, 4, texels.tobytes(), internal_format=_SRGB8_ALPHA8)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._texture.build_mipmaps()
        self._texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        # Drivers without the extension report 0. Software has it, at several times the cost.
        if gl.max_anisotropy > 1.0 and not is_software(gl.info["GL_RENDERER"]):
            self._texture.anisotropy = min(ANISOTROPY, gl.max_anisotropy)

    def bind(self, unit: int) -> int:
        """Bind the picture to a texture unit, and return that unit."""
        self._texture.use(unit)
        return unit

    def release(self) -> None:
        """Give the picture back to OpenGL; it can no longer be drawn."""
        self._texture.release()


def _median_redness(image: npt.NDArray[np.uint8]) -> float:
    every = max(1, image.shape[0] * image.shape[1] // _LOOKED_AT)
    light = linear(image.reshape(-1, 3)[::every] / 255.0)
    return float(np.median(light[:, 0] / np.maximum(light[:, 1], 1e-3)))


def _checked(image: npt.NDArray[np.uint8], limit: int) -> npt.NDArray[np.uint8]:
    image = np.asarray(image)
    if image.ndim != 3 or image.shape[2] != 3 or not image.size or image.dtype != np.uint8:
        raise ValueError(
            f"the texture's image has shape {image.shape} and dtype {image.dtype}; it must be "
            "(height, width, 3) uint8: sRGB, top row first"
        )
    if max(image.shape) > limit:
        raise ValueError(
            f"the texture's image has {image.shape[1]} x {image.shape[0]} texels; this driver "
            f"takes at most {limit} each way: shrink the image"
        )
    return image
