"""Which side of the mouth and of an eye each vertex lies on.

Closed lips and lids are a millimetre apart, so distance in space does not separate upper from
lower, but distance along the skin does. From a vertex of the upper lip, the upper lip's landmarks
are near, and the path to the lower lip's landmarks leads around the mouth corner.

Source: our own; the gates of Kähler et al. 2001 are painted by hand.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats64
from ..geometry.steps import smoothstep
from .landmarks import (
    EYE_LANDMARKS,
    INNER_CORNERS,
    LOWER_LIP_MIDDLE,
    UPPER_LIP_MIDDLE,
    Side,
)
from .surface import SkinSurface


def lip_side(surface: SkinSurface, landmarks: Floats64) -> Floats64:
    """+1 on the upper lip .. -1 on the lower lip, smooth around the corners, shape (V,)."""
    upper = _distance(surface, landmarks, UPPER_LIP_MIDDLE)
    lower = _distance(surface, landmarks, LOWER_LIP_MIDDLE)
    lip_reach = 20.0  # mm from the middle of a lip within which skin belongs to it
    inside = np.flatnonzero(np.minimum(upper, lower) < lip_reach)
    # On a lip the two path lengths differ by about twice the distance to the mouth corner; at the
    # corner they are equal, except for the lips' shape.
    longer = lower - upper
    longer = longer - longer[surface.nearest(landmarks[list(INNER_CORNERS)])].mean()
    corner_fade = 10.0  # mm from the mouth corner where a lip moves fully on its own
    ramp = np.clip(longer[inside] / (2.0 * corner_fade), -1.0, 1.0)
    ends = surface.nearest(landmarks[[33, 30, 8]])
    vertices = np.concatenate([inside, ends])
    values = np.concatenate([ramp, [1.0, 1.0, -1.0]])
    return np.clip(surface.harmonic(vertices, values), -1.0, 1.0)


def lid_side(surface: SkinSurface, landmarks: Floats64, side: Side) -> Floats64:
    """+1 on the upper lid .. -1 on the lower lid of one eye, 0 at its corners, shape (V,)."""
    outer, upper_outer, upper_inner, inner, lower_inner, lower_outer = EYE_LANDMARKS[side]
    upper = _distance(surface, landmarks, (upper_outer, upper_inner))
    lower = _distance(surface, landmarks, (lower_outer, lower_inner))
    lid_reach = 14.0  # mm from the lid landmarks
    near = np.minimum(upper, lower) < lid_reach
    certain_distance = 3.0  # mm by which one lid must be nearer; it is less only at the corners
    longer = lower - upper
    ramp = np.sign(longer) * smoothstep(np.abs(longer) / certain_distance)
    vertices = np.concatenate([np.flatnonzero(near), surface.nearest(landmarks[[outer, inner]])])
    values = np.concatenate([ramp[near], [0.0, 0.0]])
    return np.clip(surface.harmonic(vertices, values), -1.0, 1.0)


def _distance(surface: SkinSurface, landmarks: Floats64, numbers: tuple[int, ...]) -> Floats64:
    """Distance along the skin [mm] to the nearest landmark; a large number without a path."""
    start = surface.nearest(landmarks[list(numbers)]).astype(np.int64)
    return np.minimum(surface.distances_from(start), 1e3)
