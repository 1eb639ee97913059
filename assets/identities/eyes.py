"""Colour a person's eyes: individual irises, and whites and rims that match the skin.

Irises differ in the crypts and furrows between their fibres (Sturm, Larsson 2009, "Genetics of
human iris colour and patterns", Pigment Cell Melanoma Res. 22:544-562). The dark edge of an iris,
the limbal ring, fades with age (Peshek and others 2011, "Preliminary evidence that the limbal ring
influences facial attractiveness", Evol. Psychology 9:137-146). All numbers are chosen by eye.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Floats64
from ...geometry.colour import to_linear, to_screen
from ...geometry.steps import smoothstep
from ..data_files import read_arrays
from ..loading import load
from ..model import Eye, Part
from .population import DARKEST_TONE, IRIS_FREQUENCIES, LIGHTEST_TONE, ONLY_BROWN


class Iris(NamedTuple):
    """How a person's irises differ from the painted irises of the same colour.

    lightness: added lightness, in powers of 2.
    greyness: fraction of the colour that is lost, 0 to 1.
    ring: strength of a brown ring around the pupil, 0 to 1.
    limbus: added darkness of the edge, in powers of 2.
    fibres: contrast of light and dark fibres, in powers of 2.
    seed: seed for the pattern of fibres.
    """

    lightness: float = 0.0
    greyness: float = 0.3
    ring: float = 0.0
    limbus: float = 0.0
    fibres: float = 0.0
    seed: int = 0


USUAL_IRIS = Iris()


def drawn_iris(
    years: float, chance: float, random: np.random.Generator, *, angle: float = LIGHTEST_TONE
) -> Iris:
    """Choose random irises for a person of this age [years] and skin tone.

    chance: random number, 0 to 1, that decides edge and fibres. angle: ITA [deg].
    """
    lightness, greyness, ring = random.uniform(0.0, 1.0, 3)
    seed = int(chance * 2**31)
    darker, rougher = np.random.default_rng(seed).uniform(0.0, 1.0, 2).tolist()
    late = float(np.clip((years - 20.0) / 55.0, 0.0, 1.0))
    darker_skin = float(np.clip((ONLY_BROWN - angle) / (ONLY_BROWN - DARKEST_TONE), 0.0, 1.0))
    return Iris(
        1.5 * lightness - 0.7 - 0.5 * darker_skin,
        0.15 + 0.4 * greyness,
        ring * ring,
        limbus=1.2 * darker - 0.2 - 0.5 * late,
        fibres=0.1 + 0.35 * rougher,
        seed=seed,
    )


def with_irises(
    parts: Sequence[Part], eyes: Sequence[Eye], name: str, iris: Iris
) -> tuple[Part, ...]:
    """Replace the eyeballs among parts by eyeballs with irises of a colour.

    name: a colour of IRIS_FREQUENCIES; any other raises ValueError.
    """
    if name not in IRIS_FREQUENCIES:
        raise ValueError(f"eye colour was {name!r}, allowed are {', '.join(IRIS_FREQUENCIES)}")
    painted = read_arrays(load("head").file_beside("_eyes.npz"))[name] / np.float32(255.0)
    eyeballs = {f"eyeball_{eye.name}": (eye, own) for eye, own in zip(eyes, painted, strict=True)}
    found = []
    for part in parts:
        if part.name in eyeballs:
            eye, colours = eyeballs[part.name]
            part = replace(part, colours=_varied_iris(part, eye, colours, iris))
        found.append(part)
    return tuple(found)


def beside_skin(parts: Sequence[Part], eyes: Sequence[Eye], darker: Floats64) -> tuple[Part, ...]:
    """Darken the whites and the rims of eyes to match the skin.

    darker: light from the skin relative to light skin, at most 1, (3,).
    """
    # Exponents of `darker`.
    of_flesh = 0.85
    of_white = np.array([0.15, 0.19, 0.25])
    if (darker == 1.0).all():
        return tuple(parts)
    eyeballs = {f"eyeball_{eye.name}": eye for eye in eyes}
    found = []
    for part in parts:
        light = None
        if part.name in ("eye_corners", "wet_edges"):
            light = darker**of_flesh
        elif part.name in eyeballs:
            is_white = _axis_distances(part, eyeballs[part.name]) > 1.05
            light = np.where(is_white[:, None], darker**of_white, 1.0)
        if light is not None:
            part = replace(part, colours=_times_light(part.colours, light))
        found.append(part)
    return tuple(found)


def _axis_distances(part: Part, eye: Eye) -> Floats64:
    """Return distances of vertices from the eye's axis [iris radii], (n,); infinite on the back."""
    off = part.vertices - eye.centre
    radius = np.linalg.norm(off[:, :2], axis=1) / eye.iris_radius
    return np.where(off[:, 2] > 0.0, radius, np.inf)


def _varied_iris(part: Part, eye: Eye, colours: Floats32, iris: Iris) -> Floats32:
    """Vary the iris of an eyeball: colours of its vertices, sRGB, (n, 3)."""
    light = to_linear(colours)
    aside = _axis_distances(part, eye)
    grey = light @ np.array([0.2126, 0.7152, 0.0722])
    varied = light + iris.greyness * (grey[:, None] - light)
    ring_radii = 0.45, 0.75  # in radii of the iris: the ring begins to fade, and ends
    ring = iris.ring * (1.0 - smoothstep(aside, *ring_radii))
    brown = np.array([1.25, 1.0, 0.65])
    edge_radii = 0.78, 0.96  # in radii of the iris: the dark edge begins, and is darkest
    lighter = iris.lightness - iris.limbus * smoothstep(aside, *edge_radii)
    lighter += iris.fibres * _fibres(part, eye, aside, iris.seed)
    tint = 1.0 + ring[:, None] * (brown - 1.0)
    varied *= 2.0 ** lighter[:, None] * tint
    is_iris = (aside < 1.0)[:, None]
    iris_colours = np.clip(to_screen(varied), 0.0, 1.0)
    return np.asarray(np.where(is_iris, iris_colours, colours), np.float32)


def _fibres(part: Part, eye: Eye, aside: Floats64, seed: int) -> Floats64:
    """Compute the lightness of an iris' fibres at each vertex, with a mean square of 1, (n,).

    Fibres are waves around the axis, which twist apart from the pupil to the edge. Both eyes of a
    person have equally rough irises, with different fibres.
    """
    random = np.random.default_rng([seed, int(eye.centre[0] > 0.0)])
    off = part.vertices - eye.centre
    around = np.arctan2(off[:, 1], off[:, 0])
    counts = np.array([3, 5, 8, 11, 14, 17])  # waves around the axis, which has 60 vertices
    begins = random.uniform(0.0, 2.0 * np.pi, len(counts))
    twists = random.normal(0.0, 4.0, len(counts))  # [rad] from the centre to the edge of the iris
    in_iris = np.minimum(aside, 1.0)[:, None]
    waves = np.cos(around[:, None] * counts + begins + twists * in_iris)
    return np.asarray(waves.sum(axis=1) / np.sqrt(0.5 * len(counts)))


def _times_light(colours: Floats32, factor: Floats64) -> Floats32:
    """Multiply the linear light of colours (sRGB) by a factor."""
    return np.asarray(to_screen(to_linear(colours) * factor), np.float32)
