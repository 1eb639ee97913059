"""A person's eyes: irises of which no two are alike; whites and rims that go with the skin.

All numbers are chosen by eye.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from risorius.geometry.colour import to_linear, to_screen

from ...geometry.arrays import Floats32, Floats64
from ..data_files import read_arrays
from ..loading import load
from ..model import Eye, Part
from ..smooth import smooth_step
from .population import IRIS_SHARES


class Iris(NamedTuple):
    """How somebody's irises differ from most of their colour.

    lightness: in powers of 2. greyness: share of their colour that is lost. ring: how much browner
    they are around the pupil, 0 to 1.
    """

    lightness: float = 0.0
    greyness: float = 0.3
    ring: float = 0.0


USUAL_IRIS = Iris()


def drawn_iris(random: np.random.Generator) -> Iris:
    """The irises of somebody."""
    lightness, greyness, ring = random.uniform(0.0, 1.0, 3)
    return Iris(0.9 * lightness - 0.45, 0.15 + 0.4 * greyness, ring * ring)


def with_irises(
    parts: Sequence[Part], eyes: Sequence[Eye], name: str, iris: Iris
) -> tuple[Part, ...]:
    """Parts with eyeballs in a colour of IRIS_SHARES, else ValueError."""
    if name not in IRIS_SHARES:
        raise ValueError(f"no eyes are {name!r}; allowed are {', '.join(IRIS_SHARES)}")
    painted = read_arrays(load("head").beside("_eyes.npz"))[name] / np.float32(255.0)
    found = {}
    for eye, colours in zip(eyes, painted, strict=True):
        part = _eyeball(parts, eye)
        found[part.name] = replace(part, colours=_varied(part, eye, colours, iris))
    return tuple(found.get(part.name, part) for part in parts)


def beside_skin(parts: Sequence[Part], eyes: Sequence[Eye], darker: Floats64) -> tuple[Part, ...]:
    """Parts of which whites and rims of the eyes go with the skin.

    darker: light of the skin beside that of light skin, shape (3,), up to 1.
    """
    # As powers of the skin's light: flesh at the inner corner, wet edges of the lids, the white.
    shares = {"eye_corners": np.full(3, 0.85), "wet_edges": np.full(3, 0.85)}
    white_share = np.array([0.15, 0.19, 0.25])
    if (darker == 1.0).all():
        return tuple(parts)
    found = {}
    for part in parts:
        if part.name in shares:
            found[part.name] = _times(part.colours, darker ** shares[part.name])
    for eye in eyes:
        part = _eyeball(parts, eye)
        is_white = (_aside(part, eye) > 1.05)[:, None]
        found[part.name] = _times(part.colours, np.where(is_white, darker**white_share, 1.0))
    return tuple(
        replace(part, colours=found[part.name]) if part.name in found else part for part in parts
    )


def _eyeball(parts: Sequence[Part], eye: Eye) -> Part:
    return next(part for part in parts if part.name == f"eyeball_{eye.name}")


def _aside(part: Part, eye: Eye) -> Floats64:
    """How far each vertex is from the axis, in radii of the iris; behind the middle infinite."""
    off = part.vertices - eye.centre
    radius = np.linalg.norm(off[:, :2], axis=1) / eye.iris_radius
    return np.where(off[:, 2] > 0.0, radius, np.inf)


def _varied(part: Part, eye: Eye, colours: Floats32, iris: Iris) -> Floats32:
    """The colours of an eyeball (n, 3), sRGB, with irises as somebody has them."""
    light = to_linear(colours)
    aside = _aside(part, eye)
    grey = light @ np.array([0.2126, 0.7152, 0.0722])
    varied = light + iris.greyness * (grey[:, None] - light)
    ring_radii = 0.45, 0.75  # of the iris: where the ring is whole, and where it ends
    ring = iris.ring * (1.0 - smooth_step(*ring_radii, aside))
    brown = np.array([1.25, 1.0, 0.65])
    varied *= 2.0**iris.lightness * (1.0 + ring[:, None] * (brown - 1.0))
    is_iris = (aside < 1.0)[:, None]
    return np.asarray(np.where(is_iris, np.clip(to_screen(varied), 0.0, 1.0), colours), np.float32)


def _times(colours: Floats32, factor: Floats64) -> Floats32:
    """Colours (sRGB) of which light is multiplied."""
    return np.asarray(to_screen(to_linear(colours) * factor), np.float32)
