"""How much daylight reaches a place within the mouth: baked into the colours of teeth and flesh.

The renderer casts the shadows of one lamp; what keeps the back of a mouth dark is that lips and
cheeks cover most of the sky there (ambient occlusion). At the depth of the first molars little more
than a narrow window is left.
"""

import numpy as np

from .smooth import Points, Values, smooth_step

DAYLIGHT, GLOOM = 88.0, 30.0  # z [mm]: at the incisors, at the root of the tongue
INCISORS = 92.5  # z [mm] of the front of the upper ones
LEAST = 0.34  # chosen: the throat is dark, not black
REDDENING = (0.92, 1.25, 1.3)  # powers for red, green, blue; chosen
FALL = 1.1  # chosen: how fast the molars get dark
BESIDE, BESIDE_SHARE = 27.0, 0.5  # [mm], chosen: cheeks and corners of the mouth cover the sides


def mouth_light(points: Points) -> Values:
    """Factor on sRGB colours at places within the mouth, LEAST to 1, shape (n,)."""
    inward = np.clip((points[:, 2] - GLOOM) / (DAYLIGHT - GLOOM), 0.0, 1.0) ** FALL
    side = 1.0 - BESIDE_SHARE * smooth_step(0.4 * BESIDE, BESIDE, np.abs(points[:, 0]))
    return LEAST + (1.0 - LEAST) * inward * side


def in_mouth_light(points: Points, colours: Points) -> Points:
    """Colours as they look at their places within the mouth, shape (n, 3).

    What light is left there has met red flesh before: green and blue fall faster.
    """
    dimmed: Points = colours * mouth_light(points)[:, None] ** np.array(REDDENING)
    return dimmed
