"""The skin of the built-in head in any tone, from one number, in a tenth of a second.

A tone is told by its individual typology angle, ITA = arctan((L* - 50) / b*) [deg], by which skin
is called very light (above 55), light (above 41), intermediate (above 28), tan (above 10), brown
(above -30) or dark (Chardon, Cretois, Hourseau 1991, "Skin colour typology and suntanning
pathways", Int. J. Cosmetic Science 13:191-208). It is that of the bare skin of the face in the
picture; lips and cheeks follow, for all that changes are amounts of melanin and blood
(generator/pigments.py), and hair.

Where skin is darker than the darkest complexion that is painted, the melanin that comes on top
absorbs more evenly: published clusters of facial skin have b* of 15 at L* of 27 and of 38, below
the 19 at 52 ("Proposed shade guide for human facial skin", IADR 2009, abstract 120461).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from ..errors import AssetError
from ..files import Image, read_arrays_of
from ..fitting.head import FittedHead
from ..generator.eyeballs import IRISES, eyeball
from ..generator.pigments import BLOOD, COMPLEXIONS, MELANIN, to_linear, to_screen
from ..loading import load
from ..model import FloatArray, Part, SingleArray, Tone

LIGHTEST, DARKEST = 70.0, -55.0  # ITA [deg]
LEAST, MOST = 0.05, 3.4  # of melanin, among which a tone is looked for
DARK_MELANIN = np.array([0.80, 0.88, 0.90])  # beyond the darkest complexion; chosen by eye
AnyHead = TypeVar("AnyHead", bound=FittedHead)
LEVELS = 4096  # of the table from light to bytes
# CIE 1976 L*a*b* of linear sRGB, for the white of a screen (D65).
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = TO_XYZ.sum(axis=1)


@dataclass(frozen=True)
class _Tints:
    """What is needed to recolour the picture: see generator/tints.py."""

    light: SingleArray  # the picture, linear, without hair (H, W, 3)
    melanin: SingleArray  # (H, W)
    blood: SingleArray  # (H, W)
    hair: SingleArray  # (H, W)
    melanins: FloatArray  # of the tones in `angles`
    angles: FloatArray  # ITA, rising
    own: Tone


def lab(light: npt.ArrayLike) -> FloatArray:
    """L*, a*, b* of linear light 0..1, shape (..., 3)."""
    relative = np.asarray(light, dtype=np.float64) @ TO_XYZ.T / WHITE
    root = np.where(relative > 0.008856, np.cbrt(relative), 7.787 * relative + 16.0 / 116.0)
    x, y, z = np.moveaxis(root, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def typology_angle(light: npt.ArrayLike) -> FloatArray:
    """ITA [deg] of linear light 0..1, shape (..., 3)."""
    found = lab(light)
    return np.asarray(np.degrees(np.arctan2(found[..., 0] - 50.0, found[..., 2])))


def recoloured(angle: float, *, blood: float = 1.0) -> Image:
    """The skin of the built-in head in a tone, laid out as its `albedo`, (H, W, 3), uint8.

    angle: ITA [deg], DARKEST to LIGHTEST, else ValueError. blood: as a share of what such skin has;
    0.7 is pale, 1.3 flushed.
    """
    if not DARKEST <= angle <= LIGHTEST:
        raise ValueError(f"angle is {angle}; it must be {DARKEST:g} (dark) to {LIGHTEST:g} (light)")
    tints = _tints()
    melanin = float(np.interp(angle, tints.angles, tints.melanins))
    density, redness, hair = _changes(melanin, blood, tints.own)
    light = np.empty_like(tints.light)
    for channel in range(3):
        lost = density[channel] * tints.melanin + redness[channel] * tints.blood
        light[..., channel] = tints.light[..., channel] * np.exp(-lost) + hair[channel] * tints.hair
    steps = (np.sqrt(np.clip(light, 0.0, 1.0)) * (LEVELS - 1)).astype(np.int16)
    return _screen_bytes()[steps]


def with_irises(parts: Sequence[Part], name: str) -> tuple[Part, ...]:
    """The parts of a head, its eyes of another colour: one of `IRISES`, else ValueError."""
    if name not in IRISES:
        raise ValueError(f"no eyes are {name!r}; allowed are {', '.join(IRISES)}")
    left = eyeball(IRISES[name])
    colours = {"eyeball_left": left.colours, "eyeball_right": left.mirrored().colours}
    return tuple(
        replace(part, colours=colours[part.name].astype(np.float32))
        if part.name in colours
        else part
        for part in parts
    )


def coloured(
    head: AnyHead, *, angle: float | None = None, blood: float = 1.0, irises: str | None = None
) -> AnyHead:
    """A head with skin and eyes of other colours; None leaves them as they are."""
    skin = head.albedo if angle is None else recoloured(angle, blood=blood)
    parts = head.parts if irises is None else with_irises(head.parts, irises)
    return replace(head, albedo=skin, parts=parts)


def in_own_colours(head: AnyHead, seed: int) -> AnyHead:
    """A head with the skin and the eyes of a number's person, the same ones every time.

    Tones are as likely as each other; the darker the skin is, the likelier are brown eyes, and
    beyond tanned skin there are no others.
    """
    random = np.random.default_rng([seed, 18])
    angle = random.uniform(DARKEST, LIGHTEST)
    blood = float(np.clip(random.normal(1.0, 0.1), 0.75, 1.25))
    is_brown = random.random() < np.interp(angle, (10.0, LIGHTEST), (1.0, 0.2))
    others = [name for name in IRISES if name != "brown"]
    irises = "brown" if is_brown else others[random.integers(len(others))]
    return coloured(head, angle=angle, blood=blood, irises=irises)


def own_angle() -> float:
    """ITA [deg] of the picture that is shipped."""
    tints = _tints()
    return float(np.interp(-COMPLEXIONS[tints.own].melanin, -tints.melanins, tints.angles))


def _changes(melanin: float, blood: float, own: Tone) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Density of melanin and blood that comes to the picture's, and light of hair; (3,) each."""
    known = sorted(COMPLEXIONS.values(), key=lambda complexion: complexion.melanin)
    amounts = [complexion.melanin for complexion in known]
    usual = np.interp(melanin, amounts, [complexion.blood for complexion in known])
    hair = [
        np.interp(melanin, amounts, channel)
        for channel in to_linear(np.array([complexion.hair for complexion in known])).T
    ]
    before = COMPLEXIONS[own]
    more = max(melanin - amounts[-1], 0.0)
    density = (melanin - more - before.melanin) * MELANIN + more * DARK_MELANIN
    return density, (blood * usual - before.blood) * BLOOD, np.array(hair)


@lru_cache(maxsize=1)
def _tints() -> _Tints:
    from PIL import Image as Pictures

    head = load("head")
    names = ("melanin", "blood", "hair", "skin", "tone")
    arrays = read_arrays_of(head.fingerprint, head.tints_file, names)
    height, width = head.albedo.shape[:2]
    if arrays["hair"].shape != (height, width):
        raise AssetError(f"{head.tints_file} is of another size than {head.albedo_file}")
    soft = {}
    for name in ("melanin", "blood"):
        coarse = Pictures.fromarray(arrays[name].astype(np.float32) / 100.0)
        finer = coarse.resize((width, height), Pictures.Resampling.BILINEAR)
        soft[name] = np.asarray(finer, dtype=np.float32)
    own = Tone(str(arrays["tone"]))
    hair = (arrays["hair"] / 100.0).astype(np.float32)
    hair_light = to_linear(np.array(COMPLEXIONS[own].hair)).astype(np.float32)
    light = to_linear(np.arange(256) / 255.0).astype(np.float32)[head.albedo]
    bare = np.maximum(light - hair[..., None] * hair_light, 0.0)
    skin, weights = arrays["skin"][:3], arrays["skin"][3:]
    melanins = np.linspace(MOST, LEAST, 200)
    tones = []
    for melanin in melanins:
        density, redness, _ = _changes(float(melanin), 1.0, own)
        tones.append(skin * np.exp(-weights[0] * density - weights[1] * redness))
    return _Tints(bare, **soft, hair=hair, melanins=melanins, angles=typology_angle(tones), own=own)


@lru_cache(maxsize=1)
def _screen_bytes() -> Image:
    """Bytes (sRGB) of the squares of LEVELS steps from 0 to 1."""
    return np.rint(255.0 * to_screen(np.linspace(0.0, 1.0, LEVELS) ** 2)).astype(np.uint8)
