"""Skin colour from its pigments: melanin and blood absorb light.

Densities add up, and light falls exponentially with their sum. So one description of a face
(regions with more blood, tanned regions) is enough for every complexion, and no tone is a tinted
copy of another. The three spectra are rounded to the red, green and blue of a screen. Source: the
idea of Tsumura et al. 2003, "Image-based skin color and texture analysis/synthesis by extracting
hemoglobin and melanin information in the skin"; numbers chosen by eye.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from ..geometry.colour import to_linear
from ..geometry.polylines import polyline_at

MELANIN = np.array([0.64, 0.87, 1.13])
BLOOD = np.array([0.07, 0.56, 0.47])
SHAVED_HAIR = np.array([0.47, 0.47, 0.42])  # shaved hair: grey, a little blue
SHIPPED_BEARD = 0.12  # density of a shaved beard in the shipped picture


@dataclass(frozen=True)
class Complexion:
    """The pigments of a tone: amounts of melanin and blood, and the colour of hair (sRGB)."""

    melanin: float
    blood: float
    hair: tuple[float, float, float]


# The complexion of the shipped picture.
SHIPPED_COMPLEXION = Complexion(0.40, 1.0, (0.20, 0.14, 0.105))
COMPLEXIONS = (  # from light to dark
    Complexion(0.17, 1.05, (0.33, 0.235, 0.165)),
    SHIPPED_COMPLEXION,
    Complexion(0.75, 0.95, (0.135, 0.095, 0.075)),
    Complexion(1.55, 0.85, (0.075, 0.058, 0.052)),
)


def changes_of(melanin: float, blood: float) -> tuple[Floats64, Floats64, Floats64]:
    """Added densities of melanin and blood, and light of hair, (3,) each."""
    amounts = [complexion.melanin for complexion in COMPLEXIONS]
    usual = np.interp(melanin, amounts, [complexion.blood for complexion in COMPLEXIONS])
    hairs = to_linear(np.array([complexion.hair for complexion in COMPLEXIONS]))
    hair = polyline_at(melanin, amounts, hairs)
    more = max(melanin - amounts[-1], 0.0)
    dark_melanin = np.array([0.80, 0.88, 0.90])  # beyond the darkest complexion; chosen by eye
    density = (melanin - more - SHIPPED_COMPLEXION.melanin) * MELANIN + more * dark_melanin
    return density, (blood * usual - SHIPPED_COMPLEXION.blood) * BLOOD, hair


def paleness_of_lips(pale: float, density: Floats64) -> Floats64:
    """Additional density of lips that lack a fraction of the skin's additional melanin, shape (3,).

    Blood shows where melanin is missing, so such lips are pinker, not the colour of lighter skin.
    """
    most_lacking = 0.65  # factor on that share: the full share looked like paint
    redness = 0.45  # of blood in lips, for each unit of density that they lack
    lacking = pale * np.maximum(density, 0.0)
    return np.asarray(redness * lacking.mean() * BLOOD - most_lacking * lacking)


def typology_angle(light: npt.ArrayLike) -> Floats64:
    """Compute the ITA [deg], (...), of linear sRGB light, 0 to 1, (..., 3), by L* and b*."""
    # Rows Y and Z of the matrix from linear sRGB (D65) to CIE XYZ.
    to_yz = np.array([[0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    relative = np.asarray(light, dtype=np.float64) @ to_yz.T / to_yz.sum(axis=1)
    root = np.where(relative > 0.008856, np.cbrt(relative), 7.787 * relative + 16.0 / 116.0)
    y, z = np.moveaxis(root, -1, 0)
    return np.asarray(np.degrees(np.arctan2(116.0 * y - 66.0, 200.0 * (y - z))))
