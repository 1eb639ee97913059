"""Screen colours (sRGB, IEC 61966-2-1) and linear light, both 0..1."""

import numpy as np
import numpy.typing as npt

from .arrays import Floats64


def to_linear(screen: npt.ArrayLike) -> Floats64:
    """Screen colours of any shape as linear light."""
    values = np.asarray(screen, dtype=np.float64)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def to_screen(light: npt.ArrayLike) -> Floats64:
    """Linear light of any shape as screen colours; colours brighter than white become white."""
    values = np.clip(np.asarray(light, dtype=np.float64), 0.0, 1.0)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1.0 / 2.4) - 0.055)
