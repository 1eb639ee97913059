"""Recolour the skin of the built-in head for any skin tone, in a tenth of a second.

One number gives the tone: the individual typology angle, ITA = arctan((L* - 50) / b*) [deg]. Skin
is called very light (ITA above 55), light (above 41), intermediate (above 28), tan (above 10),
brown (above -30) or dark. Source: Chardon, Cretois, Hourseau 1991, "Skin colour typology and
suntanning pathways", Int. J. Cosmetic Science 13:191-208.

The angle is that of the face's bare skin in the texture. Recolouring changes the amounts of melanin
and blood (pigments.py) and the hair, so lips and cheeks follow the skin.

In skin darker than the darkest painted complexion, additional melanin absorbs all wavelengths more
evenly. Published clusters of facial skin have b* of 15 at L* of 27 and of 38, but b* of 19 at L* of
52 ("Proposed shade guide for human facial skin", IADR 2009, abstract 120461).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64
from ...geometry.colour import to_linear, to_screen
from ..data_files import Image, read_arrays, read_image
from ..loading import load
from ..model import FineShape, Head, Part, Wrinkles
from ..oil import MAP_SIZE
from ..pigments import (
    BLOOD,
    SHAVED_HAIR,
    SHIPPED_BEARD,
    SHIPPED_COMPLEXION,
    changes_of,
    paleness_of_lips,
    typology_angle,
)
from ..smooth import shrunk
from .beards import beard_of
from .brows import front_of_neck, painted, shrunk_stubble, soft_beard, trimmed_area
from .eyes import beside_skin, with_irises
from .features import PLAIN_FEATURES, Features
from .furrow_map import shared_map, with_lines
from .hair import HAIR_CUTS, HAIR_NAME, OWN_CUT, Fall, hair_of, scalp_of
from .haired_segments import haired_segments
from .larynx import larynx_of
from .lids import with_folds
from .long_hair import falling_hair, tied_hair
from .painted_hair import MOST_COVER, fringe_of, grown_over, shrunk_strands
from .person import Person
from .population import DARKEST_TONE, LIGHTEST_TONE
from .relief import with_reliefs
from .spots import add_spots
from .sternomastoid import sternomastoids_of

GREY_HAIR = (0.54, 0.52, 0.49)  # sRGB
LOCKS_LIGHTER = 1.2  # brightness relative to painted hair, which other hair shades
SCALP_SCALE = 30.0  # [mm] behind the hairline per unit of the scalp's map
SCALP_OFFSET = 10.0  # [mm] in front of the hairline where the map is 0
GREY_LIGHT = to_linear(np.array(GREY_HAIR)).astype(np.float32)
TABLE_SIZE = 4096  # entries of the table from light to bytes
FAINTEST_BEARD = 0.05  # stubble whose hairs are modelled
BAND_ROWS = 16  # rows of texels that are coloured together, few enough for the processor's cache


@dataclass(frozen=True)
class _Tints:
    """The maps that recolour the texture, from `data/head_tints.npz`."""

    light: Floats32  # linear albedo without hair (3, H, W)
    melanin: Floats32  # (H, W)
    blood: Floats32  # (H, W)
    hair: Floats32  # (H, W)
    lips: Floats32  # (H, W)
    beard: Floats32  # (H, W)
    brow: Floats32  # (H, W)
    scalp: Floats32  # (H, W)
    lids: Floats32  # edges of the lids, where lashes root (H, W)
    detail: Floats32  # fine relief: natural logarithm of lightness relative to the mean (H, W)
    skin: Floats64  # linear light of bare skin (3), then weights of melanin and of blood (5,)
    melanins: Floats64  # amounts of melanin for the tones in `angles` (n,)
    angles: Floats64  # ITA [deg], rising (n,)

    def melanin_of(self, angle: float) -> float:
        """Interpolate the amount of melanin for a tone; angle: ITA [deg]."""
        return float(np.interp(angle, self.angles, self.melanins))


def recoloured(
    angle: float,
    *,
    blood: float = 1.0,
    features: Features = PLAIN_FEATURES,
    haired_as: float | None = None,
    fringe: float = 0.0,
    shrink: int = 1,
    behind: Floats32 | None = None,
) -> Image:
    """Recolour the albedo of the built-in head for a skin tone: sRGB, (H, W, 3), uint8.

    - angle: ITA [deg], DARKEST_TONE to LIGHTEST_TONE; else ValueError.
    - blood: amount relative to most skin of this tone; 0.7 is pale, 1.3 flushed.
    - haired_as: ITA [deg] that decides the colour of hair. Hair begins at the hairline of
      `features`. None: `angle` decides the colour, and hair begins at the built-in hairline.
    - fringe: strength of single hairs at the hairline, 0 to 1.
    - shrink: factor by which width and height are smaller, a power of 2 up to 16.
    - behind: distances of texels behind the hairline of `features` [mm], (H, W), if they are known.
    """
    # This module imports numba, which takes long.
    from ...geometry.tones import Absorbed, Grown, Hairs, absorb, compose

    if not DARKEST_TONE <= angle <= LIGHTEST_TONE:
        raise ValueError(
            f"angle is {angle}; it must be {DARKEST_TONE:g} (dark) to {LIGHTEST_TONE:g} (light)"
        )
    tints = _tints_of_size() if shrink == 1 else _shrunk_tints(shrink)
    density, redness, _ = changes_of(tints.melanin_of(angle), blood)
    light = tints.skin[:3] * np.exp(-_absorbance(tints.skin, density, redness))
    hair = _hair_light(angle if haired_as is None else haired_as, features)
    grey_share = 0.12  # factor on greyness of brows and lashes, which turn grey later
    kept = _kept_hair(tints, features, shrink)
    if behind is None and haired_as is not None:
        behind = _distances_behind_hairline(tints, features)
    hairs = fringe * shrunk_strands(shrink * len(kept), shrink) if fringe else 0.0 * kept
    root_light = 0.5  # fraction of light that reaches the skin between dense hairs
    lips = features.lips * BLOOD + paleness_of_lips(features.pale_lips, density)
    # Double precision would take twice as long.
    single = np.float32
    beard = features.beard * SHAVED_HAIR
    absorbed = Absorbed(
        (density.astype(single), redness.astype(single), lips.astype(single), beard.astype(single)),
        (tints.melanin, tints.blood, tints.lips, tints.beard),
        single(features.relief),
        tints.detail,
    )
    grey = features.grey * np.array([1.0, grey_share], single)
    shown = Hairs(hair.astype(single), grey, GREY_LIGHT, kept, tints.scalp, tints.beard)
    bare = light.astype(single)
    covered = kept[:0] if behind is None else grown_over(behind)
    grown = Grown(covered, hairs, MOST_COVER, np.float32(root_light))
    picture = np.empty((*kept.shape, 3), np.uint8)
    for first in range(0, len(picture), BAND_ROWS):
        left = np.empty((3, min(BAND_ROWS, len(kept) - first), kept.shape[1]), np.float32)
        absorb(absorbed, first, left)
        np.exp(left, out=left)
        compose(left, first, tints.light, bare, tints.hair, shown, grown, _screen_bytes(), picture)
    add_spots(picture, features.spots)
    return picture


def _absorbance(skin: Floats64, density: Floats64, redness: Floats64) -> Floats64:
    """Return the absorbance (3,) of added melanin and blood, (3,) each; skin: as in `_Tints`."""
    return np.asarray(skin[3] * density + skin[4] * redness)


def _hair_light(angle: float, features: Features) -> Floats64:
    """Return the linear sRGB colour of a person's hair without grey, (3,); angle: ITA [deg]."""
    hair = changes_of(_tints_of_size().melanin_of(angle), 1.0)[2]
    fair_hair = (0.58, 0.44, 0.29)  # sRGB
    return np.asarray(hair + features.fair * (to_linear(np.array(fair_hair)) - hair))


def _kept_hair(tints: _Tints, features: Features, shrink: int) -> Floats32:
    """Compute the opacity of a person's painted hair, brows, lid lines and stubble, (H, W)."""
    kept = tints.hair
    if features.brows is not None:
        kept = np.where(tints.brow < 1.99, np.float32(0.0), kept)
        brows = painted(features.brows, shrink * len(kept))
        rows = np.flatnonzero(brows.any(axis=1)) // shrink
        first = rows[0]
        end = rows[-1] + 1
        brows = shrunk(brows[shrink * first : shrink * end], shrink)
        kept[first:end] = np.maximum(kept[first:end], brows)
    if features.lid_line > 0.0:
        kept = np.maximum(kept, np.float32(features.lid_line) * tints.lids)
    if features.stubble > 0.0:
        hairs = shrunk_stubble(shrink * len(kept), shrink)
        kept = np.maximum(kept, np.float32(features.stubble) * hairs * tints.beard)
    if features.beard_length > 0.0:
        shadowed = np.float32(0.6 * min(features.beard_length / 10.0, 1.0))  # between the hairs
        kept = np.maximum(kept, shadowed * tints.beard * trimmed_area(len(kept)))
    return kept


def coloured(
    person: Person,
    *,
    angle: float,
    blood: float = 1.0,
    irises: str | None = None,
    features: Features = PLAIN_FEATURES,
    shrink: int = 1,
) -> Person:
    """Give a person a skin tone, a colour of eyes, and hair in the person's cut.

    - angle: ITA [deg].
    - blood, shrink: as in `recoloured`; textures of wrinkles shrink, too.
    - irises: name of a colour; None leaves the eyes unchanged.

    The function `in_tone` of the result changes the tone of the skin, and leaves the hair.
    """
    parts = person.parts
    if irises is not None:
        parts = with_irises(parts, person.eyes, irises, features.iris)
    parts = beside_skin(parts, person.eyes, _beside_light_skin(angle))
    behind = _distances_behind_hairline(_tints_of_size(), features)
    known = load("head").fine_shape
    in_tone = partial(
        recoloured,
        blood=blood,
        features=features,
        haired_as=angle,
        fringe=fringe_of(HAIR_CUTS[person.identity.cut]),
        shrink=shrink,
    )
    return replace(
        person,
        albedo=in_tone(angle, behind=behind if shrink == 1 else None),
        ambient_occlusion=_occlusion(shrink),
        # Small pictures do not show the relief of necks, so all persons share one map.
        fine_shape=_own_shape(person) if shrink == 1 else known,
        wrinkles=_own_wrinkles(person, shrink),
        parts=_with_hair(person, parts, angle, features, behind, shrink),
        segments=haired_segments(features, behind, _tints_of_size().beard),
        in_tone=in_tone,
        stubble=np.float32(features.stubble) * _coarse_beard() if features.stubble else None,
    )


@lru_cache(maxsize=1)
def _coarse_beard() -> Floats32:
    """Return the density of a full beard in a map as small as that of oil, 0 to 1."""
    return shrunk(_tints_of_size().beard, len(load("head").albedo) // MAP_SIZE)


def _own_shape(person: Person) -> FineShape:
    """Add a person's larynx and sternomastoids to the built-in head's fine shape."""
    known = load("head").fine_shape
    size = len(known.slopes)
    return with_reliefs(known, [larynx_of(person, size), *sternomastoids_of(person, size)])


def _own_wrinkles(person: Person, shrink: int) -> Wrinkles:
    """Draw lid folds and lines into a person's wrinkles; the smallest pictures show no lines."""
    lines = person.identity.lines
    finest = 2  # largest `shrink` at which lines are at least one texel wide
    if lines is None or shrink > finest:
        wrinkles = replace(person.wrinkles, map=shared_map(shrink))
    else:
        wrinkles = with_lines(person.wrinkles, lines, shrink)
    return with_folds(wrinkles, person)


def _beside_light_skin(angle: float) -> Floats64:
    """Light from skin of a tone, relative to light skin: (3,), at most 1; angle: ITA [deg]."""
    tints = _tints_of_size()
    light_skin = 41.0  # ITA from which skin is called light
    lost = []
    for tone in (min(angle, light_skin), light_skin):
        density, redness, _ = changes_of(tints.melanin_of(tone), 1.0)
        lost.append(_absorbance(tints.skin, density, redness))
    return np.asarray(np.exp(lost[1] - lost[0]))


def _with_hair(
    person: Person,
    parts: Sequence[Part],
    angle: float,
    features: Features,
    behind: Floats32,
    shrink: int,
) -> tuple[Part, ...]:
    """Replace the hair among a person's parts by beard and hair of the person's cut.

    angle: ITA [deg]. behind: distances of texels behind the hairline [mm], (H, W). shrink: as in
    `recoloured`.
    """
    others = [part for part in parts if not part.name.startswith(HAIR_NAME)]
    cut = HAIR_CUTS[person.identity.cut]
    uv = person.uv.astype(np.float64)
    scalp = scalp_of(person.vertices, person.faces, uv, behind)
    light = _hair_light(angle, features)
    length = person.identity.hair
    colour = to_screen(LOCKS_LIGHTER * (light + features.grey * (GREY_LIGHT - light)))
    # Small pictures do not show the hairs of stubble.
    if features.beard_length or (features.stubble > FAINTEST_BEARD and shrink == 1):
        colours = to_screen(np.stack([light, GREY_LIGHT]))
        others.append(beard_of(person, _tints_of_size().beard, colours, features))
    if isinstance(cut, Fall):
        return (*others, *falling_hair(cut, scalp, person, colour, length))
    return (*others, *(tied_hair if cut.knot else hair_of)(cut, scalp, colour, length))


def built_in_hair(head: Head) -> tuple[Part, ...]:
    """Make standing hair for the built-in head, whose texture shows cropped hair there."""
    scalp_map = read_arrays(head.file_beside("_tints.npz"), "scalp")["scalp"]
    behind = np.float32(0.01 * SCALP_SCALE) * scalp_map - SCALP_OFFSET
    scalp = scalp_of(head.vertices, head.faces, head.uv.astype(np.float64), behind)
    colour = to_screen(LOCKS_LIGHTER * to_linear(np.array(SHIPPED_COMPLEXION.hair)))
    return hair_of(OWN_CUT, scalp, colour, 1.0)


def _distances_behind_hairline(tints: _Tints, features: Features) -> Floats32:
    """Compute distances of texels behind a person's hairline [mm], (H, W); baldness halves them."""
    scalp = tints.scalp
    behind = np.float32(SCALP_SCALE) * scalp - np.float32(SCALP_OFFSET)
    line = features.hairline
    on_scalp = scalp > 0.01
    hairy = np.flatnonzero(on_scalp.any(axis=1))
    rows = slice(hairy[0], hairy[-1] + 1)  # half of all rows
    moved = behind[rows] - line.shift(len(scalp), rows)
    moved /= np.float32(1.0 + line.crown)
    np.copyto(behind[rows], moved, where=on_scalp[rows])
    return behind


@lru_cache(maxsize=1)
def _tints_of_size() -> _Tints:
    """Read the maps, scaled to the size of the texture."""
    from PIL import Image as Pictures

    head = load("head")
    arrays = read_arrays(head.file_beside("_tints.npz"))
    height, width = head.albedo.shape[:2]
    soft = {}
    for name in ("melanin", "blood", "lips", "beard", "brow", "scalp"):
        coarse = Pictures.fromarray(arrays[name].astype(np.float32) / 100.0)
        finer = coarse.resize((width, height), Pictures.Resampling.BILINEAR)
        soft[name] = np.array(finer, dtype=np.float32)
    whole_beard = soft_beard(soft["beard"], 1.0 - soft["lips"])
    soft["beard"] = whole_beard * front_of_neck(height)
    hair = (arrays["hair"] / 100.0).astype(np.float32)
    light = to_linear(np.arange(256) / 255.0).astype(np.float32)[head.albedo]
    hair_colour = to_linear(SHIPPED_COMPLEXION.hair).astype(np.float32)
    bare = np.maximum(light - hair[..., None] * hair_colour, 0.0)
    shaved_neck = SHIPPED_BEARD * (whole_beard - soft["beard"])
    bare *= np.exp(shaved_neck[..., None] * SHAVED_HAIR.astype(np.float32))
    skin = arrays["skin"]
    least_melanin = 0.05
    most_melanin = 3.4
    melanins = np.linspace(most_melanin, least_melanin, 200)
    tones = []
    for melanin in melanins.tolist():
        density, redness, _ = changes_of(melanin, 1.0)
        tones.append(skin[:3] * np.exp(-_absorbance(skin, density, redness)))
    is_skin = (hair < 0.02).astype(np.float32)
    lightness = np.log(np.maximum(bare.mean(axis=2), 1e-3)) * is_skin
    detail_size = 9  # [texels]; finer changes of lightness count as relief
    # Beside hair the mean counts only skin, or skin between dark hairs would look raised.
    around, skin_fraction = (
        scipy.ndimage.uniform_filter(each, detail_size) for each in (lightness, is_skin)
    )
    detail = lightness - is_skin * around / np.maximum(skin_fraction, 1e-3)
    return _Tints(
        np.ascontiguousarray(np.moveaxis(bare, 2, 0)),
        **soft,
        hair=hair,
        lids=np.asarray(read_image(head.file_beside("_lids.png"), mode="L") / 255.0, np.float32),
        detail=detail,
        skin=skin,
        melanins=melanins,
        angles=typology_angle(tones),
    )


@lru_cache(maxsize=1)
def _shrunk_tints(shrink: int) -> _Tints:
    """Average the maps over blocks of `shrink` x `shrink` texels."""
    whole = _tints_of_size()
    names = [each.name for each in fields(whole)]
    maps: dict[str, Any] = {
        name: shrunk(getattr(whole, name), shrink)
        for name in names
        if name not in ("light", "skin", "melanins", "angles")
    }
    light = np.stack([shrunk(channel, shrink) for channel in whole.light])
    return replace(whole, light=light, **maps)


@lru_cache(maxsize=2)
def _occlusion(shrink: int) -> Image:
    """Shrink the ambient occlusion of the built-in head, (H, W), uint8; 255 is open."""
    light = load("head").ambient_occlusion
    found = np.rint(shrunk(light.astype(np.float32), shrink)).astype(np.uint8)
    found.flags.writeable = False
    return found


@lru_cache(maxsize=1)
def _screen_bytes() -> Image:
    """Return sRGB bytes of linear light t * t, for TABLE_SIZE equal steps of t from 0 to 1."""
    return np.rint(255.0 * to_screen(np.linspace(0.0, 1.0, TABLE_SIZE) ** 2)).astype(np.uint8)
