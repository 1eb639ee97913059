"""Colours of skin with hair, texel by texel, in two passes around numpy's exponential.

The compiled passes read each map once. All steps are in single precision and in numpy's order, so
results equal those of numpy on whole arrays to the last bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..jit import njit
from .arrays import Floats32, Unsigned8


class Absorbed(NamedTuple):
    """Four pigments of skin; each has the light that it absorbs, (3,), and a map, (H, W)."""

    amounts: tuple[Floats32, Floats32, Floats32, Floats32]
    maps: tuple[Floats32, Floats32, Floats32, Floats32]
    relief: np.float32  # strength of `detail`
    detail: Floats32  # (H, W), in powers of e


class Hairs(NamedTuple):
    """A person's painted hair: its colour, and the fraction of each texel that it covers."""

    light: Floats32  # (3,), linear
    grey: Floats32  # shares of grey on the scalp and in beards, and elsewhere, (2,)
    grey_light: Floats32  # (3,), linear
    kept: Floats32  # share of the hair's colour in each texel, (H, W)
    scalp: Floats32  # above 0.01 on the scalp, (H, W)
    beard: Floats32  # density of a full beard, 0 to 1, (H, W)


class Grown(NamedTuple):
    """Paint under modelled hair; arrays of height 0 if there is no modelled hair."""

    covered: Floats32  # covered share of each texel, without single hairs, (H, W)
    hairs: Floats32  # strength of single hairs, (H, W)
    most: np.float32  # largest covered share, in dense hair
    root_light: np.float32  # share of light at the roots of dense hair


@njit
def absorb(absorbed: Absorbed, first: int, exponents: Floats32) -> None:
    """Write natural logarithms of the fraction of light that skin reflects, (3, rows, W).

    first: the row of the maps that is the first row of `exponents`.
    """
    first_amount, second_amount, third_amount, last_amount = absorbed.amounts
    first_map, second_map, third_map, last_map = absorbed.maps
    for y in range(exponents.shape[1]):
        row = first + y
        for channel in range(3):
            for x in range(exponents.shape[2]):
                total = first_amount[channel] * first_map[row, x]
                total += second_amount[channel] * second_map[row, x]
                total -= absorbed.relief * absorbed.detail[row, x]
                total += third_amount[channel] * third_map[row, x]
                total += last_amount[channel] * last_map[row, x]
                exponents[channel, y, x] = -total


@njit
def compose(
    left: Floats32,
    first: int,
    light: Floats32,
    skin: Floats32,
    former: Floats32,
    hairs: Hairs,
    grown: Grown,
    table: Unsigned8,
    picture: Unsigned8,
) -> None:
    """Write rows of a picture (H, W, 3), from row `first` on.

    left: fraction of light that skin reflects, (3, rows, W). light: light of skin without pigments,
    linear, (3, H, W). skin: light of bare skin, which replaces removed hair, (3,); former: fraction
    of each texel that the removed hair covered, (H, W). table: the byte for each step of the square
    root of light.
    """
    width = left.shape[2]
    haired = np.empty(width, np.float32)
    grey = np.empty(width, np.float32)
    covered = np.empty(width, np.float32)
    shaded = np.empty(width, np.float32)
    steps = np.empty(width, np.int32)
    last = np.float32(len(table) - 1)
    for y in range(left.shape[1]):
        row = first + y
        _hair_of_row(hairs, grown, row, haired, grey, covered, shaded)
        for channel in range(3):
            hair = hairs.light[channel]
            to_grey = hairs.grey_light[channel] - hair
            lit = light[channel, row]
            kept = left[channel, y]
            before = former[row]
            bare = skin[channel]
            for x in range(width):
                own = hair + grey[x] * to_grey
                value = lit[x] * kept[x]
                value += bare * (before[x] - haired[x])
                value += own * haired[x]
                value += covered[x] * (own * shaded[x] - value)
                value = min(max(value, np.float32(0.0)), np.float32(1.0))
                steps[x] = np.int32(np.sqrt(value) * last)
            for x in range(width):
                picture[row, x, channel] = table[steps[x]]


@njit
def _hair_of_row(
    hairs: Hairs,
    grown: Grown,
    row: int,
    haired: Floats32,
    grey: Floats32,
    covered: Floats32,
    shaded: Floats32,
) -> None:
    """Write for a row of texels: fractions of hair, grey and modelled hair, and the light."""
    one = np.float32(1.0)
    kept = hairs.kept[row]
    scalp = hairs.scalp[row]
    beard = hairs.beard[row]
    for x in range(len(haired)):
        on_scalp = scalp[x] > np.float32(0.01)
        within = one if on_scalp else beard[x]
        grey[x] = hairs.grey[1] + within * (hairs.grey[0] - hairs.grey[1])
    if len(grown.covered) == 0:
        for x in range(len(haired)):  # slices take two seconds longer to compile
            haired[x] = kept[x]
            covered[x] = np.float32(0.0)
            shaded[x] = one
        return
    cover = grown.covered[row]
    single = grown.hairs[row]
    for x in range(len(haired)):
        within = kept[x]
        haired[x] = np.float32(0.0) if scalp[x] > np.float32(0.01) else within
        shaded[x] = one - (one - grown.root_light) * cover[x]
        covered[x] = cover[x] + single[x] * cover[x] * (grown.most - cover[x])
