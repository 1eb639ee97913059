"""Shape the larynx (Adam's apple) as a rounded ridge in the map of fine shape.

The two plates of the thyroid cartilage meet at 90 degrees in men and at 120 degrees in women
(Standring, "Gray's Anatomy", larynx). So the larynx hardly shows on women's necks. Height and width
are chosen by eye.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...geometry.arrays import Floats64
from ...geometry.steps import smoothstep
from ...geometry.texels import Texels
from ..loading import load
from .person import Person
from .relief import Relief, relief_of, texels_of


def larynx_of(person: Person, size: int) -> Relief:
    """Shape a person's larynx in a map of (size, size) texels."""
    texels = _neck_texels(size)
    x, y, _ = texels.interpolate(person.vertices[person.faces]).T
    throat = person.vertices[person.anatomy["cervicale"], 1]
    below = 15.0  # [mm] down from the angle between chin and neck
    half_width = 6.5  # [mm]
    half_height = 9.0  # [mm]
    up = y - throat + below  # [mm] from the middle of the larynx
    notch = 0.25 * _hill(x / 3.5, (up - 6.0) / 4.0)
    ridge = _hill(x / half_width, up / half_height)
    inside = smoothstep(ridge, 0.0, 0.35)  # a steeper end would be a rim in oblique light
    heights: Floats64 = person.identity.larynx * inside * (ridge - notch)
    return relief_of(texels, heights, np.ones_like(heights))


def _hill(across: Floats64, up: Floats64) -> Floats64:
    """Heights of a hill of height 1 (a Gaussian), at places in units of its half widths."""
    return np.exp(-(across**2) - up**2)


@lru_cache(maxsize=2)
def _neck_texels(size: int) -> Texels:
    """Find the texels of the front of the neck in a map of (size, size) texels."""
    head = load("head")
    x, y, z = head.vertices[head.faces].transpose(2, 0, 1)
    chin = head.vertices[head.anatomy["menton"], 1]
    is_front = (np.abs(x) < 25.0) & (y < chin) & (z > 30.0)  # (F, 3), of the corners
    return texels_of(is_front.all(axis=1), size)
