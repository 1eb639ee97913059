"""An eyeball: sclera, limbus, iris, pupil and the bulge of the cornea, as one surface.

The shadow of the upper lid is painted: the lid is too thin to cast one, and without it eyes stare.

The pole lies at the pupil, so that pupil and iris are round at any resolution. The iris is painted
on the cornea: one opaque surface that glints is enough at the size of a face on a screen.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .model import Part
from .smooth import Points, Values, smooth_step
from .solids import Solid, ball, joined, mix, welded

EYE_RADIUS = 13.0  # [mm] of the shipped eyes; larger than in life, to fill their opening
PUPIL_RADIUS = 1.8  # in the light of a room
CORNEA_RADIUS, CORNEA_RISE = 6.4, 1.1  # [mm]; less than in anatomy: the lids are thin
FINE_SEGMENTS, COARSE_SEGMENTS = 60, 30  # as far as the limbus, beyond it
RING_DISTANCES = (0.0, 1.6, 1.95, 2.6, 3.3, 4.0, 4.7, 5.2, 5.6, 6.0, 6.5)  # [mm] from the axis
LAST_ANGLE_DEG, COARSE_RINGS = 100.0, 5  # the rest is never seen

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


def _radii(angles: Values) -> Values:
    """Distance of the surface from the eye's centre: a ball with a bulge in front [mm]."""
    beside = np.minimum(EYE_RADIUS * np.sin(np.minimum(angles, np.pi / 2)), CORNEA_RADIUS)
    bulge = CORNEA_RISE * (1.0 - (beside / CORNEA_RADIUS) ** 2) ** 1.5
    return EYE_RADIUS + np.where(angles < np.pi / 2, bulge, 0.0)


def _iris(beside: Values, around: Values, iris: Iris) -> npt.NDArray[np.float64]:
    """Fibres run outward; a warmer, ragged ring surrounds the pupil."""
    fibres = (
        0.50 * np.sin(13 * around + 0.6)
        + 0.30 * np.sin(21 * around + 2.1)
        + 0.25 * np.sin(29 * around + 4.0)
    )
    collar = 1.0 - smooth_step(3.0, 4.4, beside + 0.35 * fibres)
    colour = mix(iris.outer, iris.inner, 0.75 * collar)
    middle = smooth_step(1.9, 2.8, beside) * (1.0 - smooth_step(4.8, 5.8, beside))
    below = -np.sin(around) * smooth_step(1.5, 4.5, beside)
    return colour * (1.0 + 0.20 * fibres * middle + CAUSTIC * below * (0.5 + 0.2 * below))[:, None]


def _colours(beside: Values, around: Values, ahead: Points, iris: Iris) -> npt.NDArray[np.float64]:
    aside = np.abs(ahead[:, 0])
    colour = mix(SCLERA, CANTHUS, 0.75 * smooth_step(0.60, 0.93, aside))
    colour *= 1.0 - CORNER_SHADOW * smooth_step(0.3, 0.85, aside)[:, None]
    in_iris = 1.0 - smooth_step(5.6, 6.4, beside)
    colour = colour * (1.0 - in_iris[:, None]) + _iris(beside, around, iris) * in_iris[:, None]
    ring = smooth_step(4.6, 5.7, beside) * (1.0 - smooth_step(5.8, 6.6, beside))
    colour = mix(colour, iris.limbus, 0.7 * ring)
    colour = mix(colour, PUPIL, 1.0 - smooth_step(PUPIL_RADIUS - 0.2, PUPIL_RADIUS + 0.2, beside))
    lid_shadow = LID_SHADOW * smooth_step(-0.1, 0.38, ahead[:, 1])
    lower = LOWER_SHADOW * smooth_step(-0.2, -0.42, ahead[:, 1])
    return colour * (1.0 - lid_shadow - lower)[:, None]


def _ball(angles: Values, segments: int, iris: Iris) -> Solid:
    """Rings at angles from the optical axis [rad], around the origin."""
    ahead, faces, around = ball(angles, segments)
    away = np.repeat(angles, segments)
    beside = np.where(
        away < np.pi / 2, EYE_RADIUS * np.sin(np.minimum(away, np.pi / 2)), EYE_RADIUS
    )
    return Solid(ahead * _radii(away)[:, None], faces, _colours(beside, around, ahead, iris))


def eyeball(iris: Iris = IRIS) -> Solid:
    """Return the left eyeball around the origin, looking along +z."""
    front = np.arcsin(np.array(RING_DISTANCES) / EYE_RADIUS)
    back = np.linspace(front[-1], np.radians(LAST_ANGLE_DEG), COARSE_RINGS + 1)
    fine, coarse = _ball(front, FINE_SEGMENTS, iris), _ball(back[1:], COARSE_SEGMENTS, iris)
    start = (len(front) - 1) * FINE_SEGMENTS
    end = len(fine.vertices)
    seam = []
    for k in range(COARSE_SEGMENTS):
        a, b = start + 2 * k, start + (2 * k + 2) % FINE_SEGMENTS
        c, d = end + k, end + (k + 1) % COARSE_SEGMENTS
        seam += [[a + 1, a, c], [a + 1, c, d], [a + 1, d, b]]
    both = joined([fine, coarse])
    both.faces = np.vstack([both.faces, np.array(seam, dtype=np.int32)])
    return welded(both)


def with_irises(parts: Sequence[Part], name: str | None = None) -> tuple[Part, ...]:
    """The parts of a head, its eyes painted: in a colour of `IRISES`, else ValueError; or its own.

    name: None for the shipped eyes.
    """
    if name is not None and name not in IRISES:
        raise ValueError(f"no eyes are {name!r}; allowed are {', '.join(IRISES)}")
    left = eyeball(IRIS if name is None else IRISES[name])
    colours = {"eyeball_left": left.colours, "eyeball_right": left.mirrored().colours}
    return tuple(
        replace(part, colours=colours[part.name].astype(np.float32))
        if part.name in colours
        else part
        for part in parts
    )
