"""The map of wrinkles: what shape the skin's furrows have, over the texture coordinates."""

import moderngl
import numpy as np
import numpy.typing as npt


class WrinkleMap:
    """A map on the graphics card; `Renderer.load_wrinkles` makes it.

    steepest: slope of a full byte [scene's unit for one unit of the texture coordinates].
    """

    def __init__(
        self, gl: moderngl.Context, texels: npt.NDArray[np.uint8], steepest: float
    ) -> None:
        texels = np.asarray(texels)
        if texels.ndim != 3 or texels.shape[2] != 4 or not texels.size or texels.dtype != np.uint8:
            raise ValueError(
                f"the map of wrinkles has shape {texels.shape} and dtype {texels.dtype}; it must "
                "be (height, width, 4) uint8: slopes along u and v, depth, slot; top row first"
            )
        self.steepest = steepest
        height, width = texels.shape[:2]
        # OpenGL counts rows, and v, from below.
        self._texture = gl.texture((width, height), 4, np.ascontiguousarray(texels[::-1]).tobytes())
        self._texture.repeat_x = self._texture.repeat_y = False
        self._texture.build_mipmaps()
        self._texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR

    def bind(self, unit: int) -> int:
        """Bind the map to a texture unit, and return that unit."""
        self._texture.use(unit)
        return unit

    def release(self) -> None:
        """Give the map back to OpenGL; it can no longer be drawn."""
        self._texture.release()
