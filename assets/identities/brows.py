"""Brows and stubble of persons, painted on the texture of the built-in head.

A brow runs from its inner end over its peak to its tail. The peak of women's brows lies 0.93 of the
eye's width from the inner corner of the eye (Roth, Metzinger 2003, "Quantifying the arch position
of the female eyebrow", Arch. Facial Plast. Surg. 5:235-239); men's are lower, with a lower tail and
a weaker peak (Sclafani, Jung 2010, "Desired position, shape, and dynamic range of the normal adult
eyebrow", the same 12:123-127). All else is chosen by eye.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64
from ..loading import load
from ..smooth import smooth_step

PARTS = 5  # parts of each hair; [mm]


@dataclass(frozen=True)
class Brows:
    """Both brows of a person.

    thickness: thickness at the thickest place [mm]. inner: from the middle of the face to the inner
    end [mm]. rise, fall: from the inner end up to the peak, and from the peak down to the tail
    [mm]. peak: from the middle of the face to the peak [mm]. density: density of hairs, relative to
    the usual density. unruly: how far hairs stand out of line, 0 to
        1.
    seed: seed of single hairs.
    """

    thickness: float
    inner: float
    rise: float
    fall: float
    peak: float
    density: float
    unruly: float
    seed: int


def drawn_brows(is_man: bool, years: float, random: np.random.Generator) -> Brows:
    """Random brows for a sex and an age."""
    # Thickness, inner end, rise, fall, peak, density of women and men: means, and deviations.
    drawn = (
        np.array([(5.8, 12.0, 4.6, 6.4, 41.0, 0.95), (0.9, 1.2, 1.2, 1.4, 2.0, 0.15)]),
        np.array([(8.2, 10.5, 2.8, 5.6, 39.0, 0.95), (1.4, 1.6, 1.2, 1.6, 2.5, 0.22)]),
    )
    mean, deviation = drawn[is_man]
    variety = 1.3  # factor on deviations, which surveys give for one group of people
    values = mean + variety * deviation * np.clip(random.normal(size=len(mean)), -2.0, 2.0)
    late = float(np.clip((years - 45.0) / 30.0, 0.0, 1.0))
    values[[0, 5]] *= 1.0 - late * np.array([0.0 if is_man else 0.15, 0.3])
    thickness, inner, rise, fall, peak, density = values.tolist()
    unruly = 0.35 + 0.5 * late if is_man else 0.1
    seed = int(random.integers(2**31))
    return Brows(thickness, inner, rise, fall, peak, density, unruly, seed)


@lru_cache(maxsize=1)
def painted(brows: Brows, size: int) -> Floats32:
    """Share of each texel that hairs of brows cover, 0 to 1, shape (size, size)."""
    random = np.random.default_rng(brows.seed)
    cover = np.zeros((size, size), np.float32)
    for side in (-1.0, 1.0):
        hairs = _hairs(brows, random)
        _paint(cover, hairs, side, random.uniform(110.0, 230.0, len(hairs)))
    cover.flags.writeable = False
    return cover


def _hairs(brows: Brows, random: np.random.Generator) -> Floats64:
    """Places along each hair from root to tip, seen from the front [mm], (n, PARTS + 1, 2)."""
    head = load("head")  # its brows' places
    inner, outer = head.vertices[head.landmarks[[22, 26]]]
    first = brows.inner
    base = inner[1] - 4.5
    last = outer[0] - 1.5
    middle = 0.45 * first + 0.55 * brows.peak
    rises = np.array([0.0, 0.72 * brows.rise, brows.rise, brows.rise - brows.fall])
    line = scipy.interpolate.PchipInterpolator([first, middle, brows.peak, last], base + rises)
    density = 2.0  # hairs for each square millimetre
    count = round(density * brows.density * (last - first) * brows.thickness)
    along = random.uniform(0.0, 1.0, count)
    across = 0.24 * random.normal(size=count)
    # Hairs are sparse at both ends.
    kept = random.random(count) < np.interp(along, (0.0, 0.22, 0.7, 1.0), (0.3, 1.0, 1.0, 0.35))
    along = along[kept]
    across = np.clip(across[kept], -0.55, 0.55)
    x = first + (last - first) * along
    # Along a brow, its thickness as a share of the greatest.
    profile = (0.0, 0.6), (0.1, 0.85), (0.3, 1.0), (0.6, 0.8), (0.85, 0.5), (1.0, 0.25)
    root = line(x) + across * brows.thickness * np.interp(along, *np.array(profile).T)
    # Hairs stand up at the inner end, and turn outward until they lie along the brow; hairs above
    # its middle lean down to it.
    turn = np.radians(78.0) * np.exp(-along / 0.2) + np.radians(14.0)
    turn -= np.radians(38.0) * smooth_step(0.08, 0.45, along) * smooth_step(-0.15, 0.3, across)
    turn += (0.1 + 0.4 * brows.unruly * (1.0 - 0.6 * along)) * random.normal(size=len(along))
    bend = np.linspace(1.0, 0.35, PARTS) * turn[:, None] + np.arctan(line(x, 1))[:, None]
    longest_hair = 6.5  # [mm]
    long = longest_hair * random.uniform(0.55, 1.0, len(along)) * (1.0 - 0.35 * along)
    long *= np.clip(brows.thickness / 7.0, 0.7, 1.15) * (1.0 + 0.3 * brows.unruly)
    steps = np.stack([np.cos(bend), np.sin(bend)], axis=-1) * (long / PARTS)[:, None, None]
    start = np.stack([x, root], axis=-1)[:, None] - 0.3 * steps.sum(axis=1, keepdims=True)
    return np.concatenate([start, start + np.cumsum(steps, axis=1)], axis=1)


def _paint(cover: Floats32, hairs: Floats64, side: float, tones: Floats64) -> None:
    """Paint hairs, which are thinner and fainter to their tips, on one side (1: left)."""
    from PIL import Image, ImageDraw

    fineness = 4  # times the texture's resolution, for drawing hairs
    places = fineness * len(cover) * _on_texture(hairs.reshape(-1, 2), side).reshape(hairs.shape)
    low = np.floor(places.min(axis=(0, 1)) / fineness).astype(int) - 8
    wide, high = np.ceil(places.max(axis=(0, 1)) / fineness).astype(int) + 8 - low
    image = Image.new("L", (fineness * int(wide), fineness * int(high)))
    pen = ImageDraw.Draw(image)
    inks = [pen.draw.draw_ink(tone) for tone in range(256)]
    for part in range(PARTS)[::-1]:  # tips first: roots cover them
        drawn = (tones * (1.0 - 0.75 * part / PARTS)).astype(int).tolist()
        ends = (places[:, part : part + 2] - fineness * low).reshape(-1, 4).tolist()
        width = 2 if part < PARTS / 2 else 1
        for end, tone in zip(ends, drawn, strict=True):
            pen.draw.draw_lines(end, inks[tone], width)  # `pen.line` is six times slower
    drawn_rows = np.asarray(image).reshape(high, fineness, -1).sum(axis=1, dtype=np.uint16)
    sums = np.asarray(sum(drawn_rows[:, k::fineness] for k in range(fineness)), np.float32)
    fine = sums / np.float32(fineness**2) / np.float32(255.0)
    blur = 3.0  # [texels] of the colour between hairs
    soft = scipy.ndimage.gaussian_filter(fine, blur)
    covered = cover[low[1] : low[1] + high, low[0] : low[0] + wide]
    share_between = 0.9  # of a brow's darkness
    np.maximum(covered, np.clip(fine + share_between * soft, 0.0, 0.92), out=covered)


def _on_texture(places: Floats64, side: float) -> Floats64:
    """Column and row on the texture, 0 to 1, of places (x, y) [mm] seen from the front, (n, 2)."""
    across, down = _map()(places).T
    return np.stack([0.5 + side * (across - 0.5), 1.0 - down], axis=-1)


@lru_cache(maxsize=1)
def _map() -> scipy.interpolate.RBFInterpolator:
    """From places (x, y) about the left brow to texture coordinates."""
    head = load("head")
    brow = scipy.spatial.cKDTree(head.vertices[head.landmarks[22:27]])
    radius = 24.0  # [mm] about a brow: vertices that give its place on the texture
    near = np.flatnonzero(brow.query(head.vertices)[0] < radius)
    hidden = np.concatenate([head.rings[f"eye_{row}_left"] for row in range(3)])
    near = near[~np.isin(near, hidden) & (head.vertices[near, 2] > 30.0)]
    return scipy.interpolate.RBFInterpolator(head.vertices[near, :2], head.uv[near].astype(float))


@lru_cache(maxsize=1)
def stubble(size: int) -> Floats32:
    """Share that short hairs cover where a beard grows, 0 to 1, shape (size, size)."""
    random = np.random.default_rng(0).random((size, size), np.float32)
    hairs = scipy.ndimage.gaussian_filter(random, (1.4, 0.55))
    hairs = np.clip((hairs - hairs.mean()) / hairs.std() + 0.6, 0.0, 2.0) / 2.0
    across = np.abs(np.linspace(-0.5, 0.5, size))
    down = np.linspace(0.0, 1.0, size)[:, None]
    # The map of the beard continues around the neck.
    front = (1.0 - smooth_step(0.26, 0.3, across)) * (1.0 - smooth_step(0.84, 0.93, down))
    return np.asarray(hairs * front, dtype=np.float32)
