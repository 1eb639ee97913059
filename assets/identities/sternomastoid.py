"""Raise or sink the sternomastoids of a person, the muscles from behind the ear to the breastbone.

The map of fine shape shows these muscles as in most people. Lean and old persons show them more. A
face counts as lean if its cheekbones are wide in comparison with its jaw (Coetzee and others 2010,
"Deciphering faces: quantifiable visual cues to weight", Perception 39:51-61). How much more lean
and old persons show is chosen by eye.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...geometry.steps import smoothstep
from ..loading import load
from ..smooth import bump
from .person import Person
from .relief import Relief, relief_of, texels_of

# Course of the built-in head's muscles: height [mm], and angle around the neck [deg], 90 in front.
COURSE_POINTS = np.array(
    [(-165, 60), (-150, 45), (-140, 33), (-130, 22), (-120, 13), (-110, 8), (-100, 3), (-60, -14)]
)


def height_of(person: Person) -> float:
    """Return how much farther the muscles stand out than those of the built-in head [mm]."""
    measures = person.measures
    usual_ratio = 1.27  # width of the cheekbones divided by the width of the jaw
    lean = measures["zy-zy"] / measures["go-go"] - usual_ratio
    return float(np.clip(person.identity.sternomastoid + 3.5 * lean, -0.7, 1.8))


def sternomastoids_of(person: Person, size: int) -> tuple[Relief, ...]:
    """Shape both muscles in a map of (size, size) texels."""
    height = height_of(person)
    tendon = max(height, 0.0)  # the built-in head shows no tendon, so it cannot sink
    muscles = []
    for side in (1.0, -1.0):
        belly, front = _belly_and_tendon(size, side)
        heights = height * belly.heights + tendon * front.heights
        muscles.append(belly._replace(heights=heights))
    return tuple(muscles)


@lru_cache(maxsize=4)
def _belly_and_tendon(size: int, side: float) -> tuple[Relief, Relief]:
    """Shape a muscle's belly, and its tendon with the hollow in front, both 1 mm high.

    side: 1 for the left muscle, -1 for the right one.
    """
    head = load("head")
    x, y, z = head.vertices[head.faces].transpose(2, 0, 1)
    is_on_neck = (y < -60.0) & (z < 80.0) & (z > -60.0)
    is_near = (side * x >= 0.0).all(axis=1) & is_on_neck.any(axis=1)
    texels = texels_of(is_near, size)
    x, y, z = texels.interpolate(head.vertices[head.faces]).T
    axis_depth = -8.0  # [mm]; z of the neck's axis
    angle = np.arctan2(z - axis_depth, side * x)
    centre_line = np.radians(np.interp(y, *COURSE_POINTS.T))
    off = np.hypot(x, z - axis_depth) * (angle - centre_line)  # [mm] in front of the centre line
    belly_width = 8.5  # [mm]
    belly = bump(off, 0.0, belly_width)
    # The tendon lies at the front edge of the belly, near the breastbone.
    tendon = 0.7 * bump(off, 6.5, 3.4) * smoothstep(y, -108.0, -140.0)
    hollow = 0.5 * bump(off, 14.5, 5.0) * smoothstep(y, -100.0, -125.0)
    inside = smoothstep(y, -62.0, -92.0) * smoothstep(z, 75.0, 60.0)
    inside *= smoothstep(off, -24.0, -14.0) * smoothstep(y, -158.0, -148.0)
    kept = inside * (belly + np.abs(tendon - hollow)) > 2e-3
    texels = texels.only(kept)
    light = np.ones(len(texels.rows))
    raised = (inside * each for each in (belly, tendon - hollow))
    first, second = (relief_of(texels, heights[kept], light) for heights in raised)
    return first, second
