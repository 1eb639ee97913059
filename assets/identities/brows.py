"""Brows and stubble of persons, painted on the texture of the built-in head.

A brow runs from its inner end over its peak to its tail. In women, the distance of the peak from
the eye's inner corner is 0.93 of the eye's width (Roth, Metzinger 2003, "Quantifying the arch
position of the female eyebrow", Arch. Facial Plast. Surg. 5:235-239). Brows of men are lower and
flatter, and their tails are lower, too (Sclafani, Jung 2010, "Desired position, shape, and dynamic
range of the normal adult eyebrow", Arch. Facial Plast. Surg. 12:123-127). All other numbers are
chosen by eye.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64
from ...geometry.closest import MeshSearch
from ...geometry.normals import cross_products
from ...geometry.steps import smoothstep
from ..loading import load
from ..smooth import shrunk

SEGMENT_COUNT = 5  # straight segments of each hair


@dataclass(frozen=True)
class Brows:
    """The shape of a person's brows, which are alike on both sides.

    thickness: greatest thickness [mm].
    inner: distance from the face's midline to the inner end [mm].
    rise: height of the peak above the inner end [mm].
    fall: height of the peak above the tail [mm].
    peak: distance from the face's midline to the peak [mm].
    density: number of hairs per area, relative to the usual density.
    unruly: how much the directions of hairs vary, 0 to 1.
    seed: seed for the positions of single hairs.
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
    """Choose random brows for a person of this sex and age [years]."""
    # For women, then for men: means and standard deviations of thickness, inner end, rise, fall,
    # peak and density.
    drawn = (
        np.array([(5.8, 12.0, 4.6, 6.4, 41.0, 0.95), (0.9, 1.2, 1.2, 1.4, 2.0, 0.15)]),
        np.array([(8.2, 10.5, 2.8, 5.6, 39.0, 0.95), (1.4, 1.6, 1.2, 1.6, 2.5, 0.22)]),
    )
    mean, deviation = drawn[is_man]
    variety = 1.3  # factor on the deviations, because surveys cover only one group of people
    values = mean + variety * deviation * np.clip(random.normal(size=len(mean)), -2.0, 2.0)
    late = float(np.clip((years - 45.0) / 30.0, 0.0, 1.0))
    values[[0, 5]] *= 1.0 - late * np.array([0.0 if is_man else 0.15, 0.3])
    thickness, inner, rise, fall, peak, density = values.tolist()
    unruly = 0.35 + 0.5 * late if is_man else 0.1
    seed = int(random.integers(2**31))
    return Brows(thickness, inner, rise, fall, peak, density, unruly, seed)


@lru_cache(maxsize=1)
def painted(brows: Brows, size: int) -> Floats32:
    """Paint brows: the fraction of each texel that their hairs cover, 0 to 1, (size, size)."""
    random = np.random.default_rng(brows.seed)
    cover = np.zeros((size, size), np.float32)
    for side in (-1.0, 1.0):
        hairs = _hairs(brows, random)
        _paint(cover, hairs, side, random.uniform(130.0, 250.0, len(hairs)))
    cover.flags.writeable = False
    return cover


def _hairs(brows: Brows, random: np.random.Generator) -> Floats64:
    """Place n hairs: points from root to tip, seen from the front [mm].

    Their shape is (n, SEGMENT_COUNT + 1, 2).
    """
    head = load("head")  # its brows give the height and the outer end
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
    share_at_ends = np.interp(along, (0.0, 0.22, 0.7, 1.0), (0.3, 1.0, 1.0, 0.35))
    kept = random.random(count) < share_at_ends
    along = along[kept]
    across = np.clip(across[kept], -0.55, 0.55)
    x = first + (last - first) * along
    # Pairs: position along the brow, and thickness there as a fraction of the greatest.
    profile = (0.0, 0.6), (0.1, 0.85), (0.3, 1.0), (0.6, 0.8), (0.85, 0.5), (1.0, 0.25)
    root = line(x) + across * brows.thickness * np.interp(along, *np.array(profile).T)
    # Hairs stand upright at the inner end; farther outward they lie along the brow. Hairs above the
    # brow's centre line lean down to it.
    turn = np.radians(78.0) * np.exp(-along / 0.2) + np.radians(14.0)
    turn -= np.radians(38.0) * smoothstep(along, 0.08, 0.45) * smoothstep(across, -0.15, 0.3)
    disorder = 0.1 + 0.4 * brows.unruly * (1.0 - 0.6 * along)
    turn += disorder * random.normal(size=len(along))
    slope = np.arctan(line(x, 1))
    bend = np.linspace(1.0, 0.35, SEGMENT_COUNT) * turn[:, None] + slope[:, None]
    longest_hair = 6.5  # [mm]
    long = longest_hair * random.uniform(0.55, 1.0, len(along)) * (1.0 - 0.35 * along)
    long *= np.clip(brows.thickness / 7.0, 0.7, 1.15) * (1.0 + 0.3 * brows.unruly)
    directions = np.stack([np.cos(bend), np.sin(bend)], axis=-1)
    steps = directions * (long / SEGMENT_COUNT)[:, None, None]
    roots = np.stack([x, root], axis=-1)[:, None]
    start = roots - 0.3 * steps.sum(axis=1, keepdims=True)
    return np.concatenate([start, start + np.cumsum(steps, axis=1)], axis=1)


def _paint(cover: Floats32, hairs: Floats64, side: float, tones: Floats64) -> None:
    """Paint the hairs (n, SEGMENT_COUNT + 1, 2) of one brow, thinner and fainter toward their tips.

    side: 1 for the left brow, -1 for the right one. tones: darkness of each hair, 0 to 255, (n,).
    """
    from PIL import Image, ImageDraw

    fineness = 4  # hairs are drawn at this multiple of the texture's resolution
    places = fineness * len(cover) * _on_texture(hairs.reshape(-1, 2), side).reshape(hairs.shape)
    low = np.floor(places.min(axis=(0, 1)) / fineness).astype(int) - 8
    wide, high = np.ceil(places.max(axis=(0, 1)) / fineness).astype(int) + 8 - low
    image = Image.new("L", (fineness * int(wide), fineness * int(high)))
    pen = ImageDraw.Draw(image)
    inks = [pen.draw.draw_ink(tone) for tone in range(256)]
    for part in range(SEGMENT_COUNT)[::-1]:  # tips first, so that roots cover them
        drawn = (tones * (1.0 - 0.75 * part / SEGMENT_COUNT)).astype(int).tolist()
        segments = places[:, part : part + 2] - fineness * low  # (n, 2, 2)
        ends = segments.reshape(-1, 4).tolist()
        width = 2 if part < SEGMENT_COUNT / 2 else 1
        for end, tone in zip(ends, drawn, strict=True):
            pen.draw.draw_lines(end, inks[tone], width)  # `pen.line` is six times slower
    # Sums over blocks; a sum over two axes at once takes twice as long.
    by_row = np.asarray(image).reshape(high, fineness, -1).sum(axis=1, dtype=np.uint16)
    by_block = sum(by_row[:, k::fineness] for k in range(fineness))
    fine = np.asarray(by_block, np.float32) / np.float32(fineness**2) / np.float32(255.0)
    blur = 3.0  # [texels] standard deviation of the colour between hairs
    soft = scipy.ndimage.gaussian_filter(fine, blur)
    left, top = low
    covered = cover[top : top + high, left : left + wide]
    share_between = 0.85  # darkness between hairs, as a fraction of the local mean
    # Hairs lie over this darkness. A sum would reach its limit in dense brows, which would be flat.
    np.maximum(covered, 1.0 - (1.0 - fine) * (1.0 - share_between * soft), out=covered)


def _on_texture(points: Floats64, side: float) -> Floats64:
    """Map points (x, y) seen from the front [mm], (n, 2), to columns and rows, 0 to 1, (n, 2)."""
    seen = np.column_stack([points, np.zeros(len(points))])
    across, down = _seen_from_front().closest(seen).interpolate(load("head").uv).T
    return np.stack([0.5 + side * (across - 0.5), 1.0 - down], axis=-1)


@lru_cache(maxsize=1)
def _seen_from_front() -> MeshSearch:
    """Return the triangles around the left brow, seen from the front: all z are 0.

    The texture is linear in a triangle, so a smooth line of hairs stays smooth on the skin. A
    smooth interpolation between vertices would bend the tails of brows at the temple.
    """
    head = load("head")
    brow = scipy.spatial.cKDTree(head.vertices[head.landmarks[22:27]])
    radius = 24.0  # [mm]; the brow and its hairs lie within this distance of its landmarks
    near = brow.query(head.vertices)[0] < radius
    near &= head.vertices[:, 2] > 30.0
    near[np.concatenate([head.rings[f"eye_{row}_left"] for row in range(3)])] = False
    flat = head.vertices * [1.0, 1.0, 0.0]
    faces = head.faces[near[head.faces].all(axis=1)]
    is_front = cross_products(flat, faces)[:, 2] > 0.0
    return MeshSearch.from_mesh(flat, faces[is_front])


@lru_cache(maxsize=1)
def stubble(size: int) -> Floats32:
    """Paint stubble: the fraction of each texel that it covers, 0 to 1, (size, size)."""
    random = np.random.default_rng(0).random((size, size), np.float32)
    # A hair is finer than a texel, so it covers a part of one; hairs are short, and many overlap.
    hairs = scipy.ndimage.gaussian_filter(random, (0.9, 0.38))
    hairs = np.clip((hairs - hairs.mean()) / hairs.std() + 1.2, 0.0, 3.0) / 5.5
    return np.asarray(hairs * front_of_neck(size), dtype=np.float32)


def front_of_neck(size: int) -> Floats32:
    """Return where beards grow on face and front half of the neck, 0 to 1, (size, size).

    The map of the beard continues around the neck, whose nape is above the scalp in the texture.
    """
    across = np.abs(np.linspace(-0.5, 0.5, size))
    down = np.linspace(0.0, 1.0, size)[:, None]
    front = (1.0 - smoothstep(across, 0.26, 0.3)) * (1.0 - smoothstep(down, 0.84, 0.93))
    below_scalp = smoothstep(down, 0.35, 0.4)
    return np.asarray(front * below_scalp, np.float32)


@lru_cache(maxsize=2)
def trimmed_area(size: int) -> Floats32:
    """Return where full beards grow, which are trimmed on the neck, 0 to 1, (size, size)."""
    across = np.abs(np.linspace(-0.5, 0.5, size))
    up = np.linspace(1.0, 0.0, size)[:, None]
    # In the texture, the jaw rises from the chin to its angles.
    jaw = 0.132 + 0.1 * (across / 0.264) ** 2
    found = (smoothstep(up - jaw, -0.075, -0.02) * front_of_neck(size)).astype(np.float32)
    found.flags.writeable = False
    return found


@lru_cache(maxsize=1)
def shrunk_stubble(size: int, shrink: int) -> Floats32:
    """Average `stubble(size)` over blocks of `shrink` x `shrink` texels."""
    return shrunk(stubble(size), shrink)


def soft_beard(beard: Floats32, beside_lips: Floats32) -> Floats32:
    """Soften the ragged edge of the map of the beard (H, W), and keep its narrow moustache.

    beside_lips: 0 on lips to 1 elsewhere, (H, W). Lips do not count in means, and the beard grows
    by half of what the blur takes from its edges.
    """
    blur = 10.0  # [texels]
    growth = 13  # [texels]
    grown = scipy.ndimage.maximum_filter(beard, growth) * beside_lips
    dense, counted = (scipy.ndimage.gaussian_filter(each, blur) for each in (grown, beside_lips))
    return np.asarray(beside_lips * dense / np.maximum(counted, 0.01), np.float32)
