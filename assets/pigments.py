"""Skin colour from its pigments: melanin and blood absorb light.

Densities add up, and light falls exponentially with them. So one description of a face - places
with more blood, tanned places - gives every complexion, and no tone is a tinted copy of another.
The three spectra are rounded to the red, green and blue of a screen. Source: the idea of Tsumura et
al. 2003, "Image-based skin color and texture analysis/synthesis by extracting hemoglobin and
melanin information in the skin"; numbers chosen by eye.
"""

from dataclasses import dataclass

import numpy as np

MELANIN = np.array([0.64, 0.87, 1.13])
BLOOD = np.array([0.07, 0.56, 0.47])
SHADOW = np.array([0.47, 0.47, 0.42])  # shaved hair: grey, a little blue


@dataclass(frozen=True)
class Complexion:
    """The pigments of a tone: amounts of melanin and blood, and the colour of hair (sRGB)."""

    melanin: float
    blood: float
    hair: tuple[float, float, float]


OWN = Complexion(0.40, 1.0, (0.20, 0.14, 0.105))  # that of the shipped picture
COMPLEXIONS = (  # from light to dark
    Complexion(0.17, 1.05, (0.33, 0.235, 0.165)),
    OWN,
    Complexion(0.75, 0.95, (0.135, 0.095, 0.075)),
    Complexion(1.55, 0.85, (0.075, 0.058, 0.052)),
)
