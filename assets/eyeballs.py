"""The colours of eyeballs: sclera, limbus, iris and pupil.

The shadow of the upper lid is painted: the lid is too thin to cast one, and without it eyes stare.
The iris is painted on the cornea: one opaque surface that glints is enough at the size of a face on
a screen.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .model import Eye, Part
from .smooth import Points, Values, smooth_step, unit

EYE_RADIUS = 13.0  # [mm] for which all distances from the axis hold
PUPIL_RADIUS = 1.8  # in the light of a room
SCLERA = (0.86, 0.84, 0.82)
LID_SHADOW = 0.52  # of the light, lost below the upper lid
LOWER_SHADOW, CORNER_SHADOW = 0.12, 0.28  # the same above the lower one, and toward the corners
CAUSTIC = 0.45  # of the iris' light, gained below: the cornea gathers there what comes from above
CANTHUS = (0.80, 0.55, 0.51)
PUPIL = (0.015, 0.013, 0.013)


@dataclass(frozen=True)
class Iris:
    """Colours (sRGB 0..1) of an iris: around the pupil, farther out, and its dark edge."""

    inner: tuple[float, float, float]
    outer: tuple[float, float, float]
    limbus: tuple[float, float, float]


IRIS = Iris((0.53, 0.47, 0.36), (0.40, 0.475, 0.50), (0.16, 0.18, 0.20))  # of the shipped eyes
# Chosen by eye: melanin makes an iris brown; without it, it scatters blue light, and green or hazel
# lies between.
IRISES = {
    "brown": Iris((0.36, 0.20, 0.10), (0.235, 0.125, 0.065), (0.095, 0.055, 0.04)),
    "hazel": Iris((0.55, 0.36, 0.15), (0.40, 0.36, 0.19), (0.17, 0.15, 0.10)),
    "green": Iris((0.55, 0.48, 0.28), (0.41, 0.46, 0.34), (0.17, 0.20, 0.16)),
    "blue": Iris((0.54, 0.60, 0.64), (0.38, 0.49, 0.60), (0.15, 0.20, 0.28)),
    "grey": Iris((0.58, 0.60, 0.59), (0.44, 0.49, 0.52), (0.20, 0.23, 0.26)),
}


def _mix(first: npt.ArrayLike, second: npt.ArrayLike, share: Values) -> Points:
    """Blend colours: `share` 0 gives the first, 1 the second; shape (n, 3)."""
    share = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray(np.asarray(first) * (1.0 - share) + np.asarray(second) * share)


def _iris(beside: Values, around: Values, iris: Iris) -> npt.NDArray[np.float64]:
    """Fibres run outward; a warmer, ragged ring surrounds the pupil."""
    fibres = (
        0.50 * np.sin(13 * around + 0.6)
        + 0.30 * np.sin(21 * around + 2.1)
        + 0.25 * np.sin(29 * around + 4.0)
    )
    collar = 1.0 - smooth_step(3.0, 4.4, beside + 0.35 * fibres)
    colour = _mix(iris.outer, iris.inner, 0.75 * collar)
    middle = smooth_step(1.9, 2.8, beside) * (1.0 - smooth_step(4.8, 5.8, beside))
    below = -np.sin(around) * smooth_step(1.5, 4.5, beside)
    return colour * (1.0 + 0.20 * fibres * middle + CAUSTIC * below * (0.5 + 0.2 * below))[:, None]


def _colours(beside: Values, around: Values, ahead: Points, iris: Iris) -> npt.NDArray[np.float64]:
    aside = np.abs(ahead[:, 0])
    colour = _mix(SCLERA, CANTHUS, 0.75 * smooth_step(0.60, 0.93, aside))
    colour *= 1.0 - CORNER_SHADOW * smooth_step(0.3, 0.85, aside)[:, None]
    in_iris = 1.0 - smooth_step(5.6, 6.4, beside)
    colour = colour * (1.0 - in_iris[:, None]) + _iris(beside, around, iris) * in_iris[:, None]
    ring = smooth_step(4.6, 5.7, beside) * (1.0 - smooth_step(5.8, 6.6, beside))
    colour = _mix(colour, iris.limbus, 0.7 * ring)
    colour = _mix(colour, PUPIL, 1.0 - smooth_step(PUPIL_RADIUS - 0.2, PUPIL_RADIUS + 0.2, beside))
    lid_shadow = LID_SHADOW * smooth_step(-0.1, 0.38, ahead[:, 1])
    lower = LOWER_SHADOW * smooth_step(-0.2, -0.42, ahead[:, 1])
    return colour * (1.0 - lid_shadow - lower)[:, None]


def with_irises(
    parts: Sequence[Part], eyes: Sequence[Eye], name: str | None = None
) -> tuple[Part, ...]:
    """The parts of a head, its eyes painted: in a colour of `IRISES`, else ValueError; or its own.

    name: None for the shipped eyes.
    """
    if name is not None and name not in IRISES:
        raise ValueError(f"no eyes are {name!r}; allowed are {', '.join(IRISES)}")
    iris = IRIS if name is None else IRISES[name]
    centres = {f"eye_{eye.name}": eye.centre for eye in eyes}
    painted = []
    for part in parts:
        if part.name.startswith("eyeball"):
            ahead = unit(part.vertices - centres[part.bone])
            ahead[:, 0] *= 1.0 if part.bone == "eye_left" else -1.0
            beside = np.where(ahead[:, 2] > 0.0, EYE_RADIUS * np.hypot(*ahead[:, :2].T), EYE_RADIUS)
            colours = _colours(beside, np.arctan2(ahead[:, 1], ahead[:, 0]), ahead, iris)
            part = replace(part, colours=colours.astype(np.float32))
        painted.append(part)
    return tuple(painted)
