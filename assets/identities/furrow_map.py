"""Draw the map of a person's furrows: expression lines, and the folds beside the mouth.

Skin swells between two lines. Below the eyes, on nose, lips and chin all persons have the furrows
of the built-in head, whose map was drawn by eye.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers64
from ...geometry.carving import carve
from ...geometry.steps import smoothstep
from ..data_files import Image
from ..loading import load
from ..model import Wrinkles
from ..smooth import bump, shrunk
from .furrows import (
    FEET_REACH,
    FOREHEAD_REACH,
    GLABELLA_REACH,
    SAMPLE_SPACING,
    FurrowLine,
    crows_feet,
    forehead_lines,
    frown_lines,
)
from .lines import ExpressionLines
from .relief import add_to, texels_of

FULL_DEPTH = 0.8  # [mm]; depth of a furrow that the map stores as 255
FAR_AWAY = 1e3  # [mm]; coordinates of texels outside the face
# Bytes of both slopes and the depth of flat skin.
FLAT_TEXEL = np.array([128.0, 128.0, 0.0], np.float32)
FAN_HUB = np.array([37.0, 1.0, 77.0])  # [mm] point in the left orbit where crow's feet would meet


class _Region(NamedTuple):
    """A rectangle of the map in which lines run in one direction.

    texels: as `carve` takes them, (h, w, 4); the coordinate across the lines is in [mm] or [rad].
    """

    rows: slice
    columns: slice
    texels: Floats32


class _Fold(NamedTuple):
    """The fold on one side of the mouth.

    rows, columns: positions of its texels, (n,).
    relief: slopes and depth [bytes], which fade toward the borders, (n, 3).
    """

    rows: Integers64
    columns: Integers64
    relief: Floats32


class _Places(NamedTuple):
    """The map without expression lines (H, H, 4), and the regions where lines are drawn."""

    plain: Image
    forehead: _Region
    glabella: _Region
    feet: tuple[_Region, ...]
    folds: tuple[_Fold, ...]


def with_lines(known: Wrinkles, lines: ExpressionLines, shrink: int = 1) -> Wrinkles:
    """Draw the lines of a person into wrinkles; shrink: factor on width and height of the map."""
    places = _line_regions(shrink)
    found = places.plain.copy()
    left, right = places.feet
    for number, (region, draw) in enumerate(
        (
            (places.forehead, forehead_lines),
            (places.glabella, frown_lines),
            (left, crows_feet),
            (right, crows_feet),
        )
    ):
        drawn = draw(lines, np.random.default_rng([lines.seed, number]))
        near = found[region.rows, region.columns, :3]
        add_to(near, _bytes_of(region, drawn, len(found) / known.steepest))
    random = np.random.default_rng([lines.seed, 4])
    for fold in places.folds:
        more = lines.fold_depth - 1.0 + random.uniform(-0.1, 0.1)
        near = found[fold.rows, fold.columns]
        add_to(near[:, :3], np.float32(more) * fold.relief)
        found[fold.rows, fold.columns] = near
    found.flags.writeable = False
    return replace(known, map=found)


def _bytes_of(region: _Region, drawn: Sequence[FurrowLine], per_slope: float) -> Floats32:
    """Carve lines into a region; returns their slopes and depths [bytes], (h, w, 3).

    per_slope: 1 / greatest difference in height between neighbouring texels [1/mm].
    """
    courses = np.array([line.course for line in drawn], dtype=np.float32)
    depths = np.array([line.depth for line in drawn], dtype=np.float32)
    forms = np.array([(line.width, line.roll, line.swelling) for line in drawn], dtype=np.float32)
    height = np.zeros(region.texels.shape[:2], np.float32)
    depth = np.zeros_like(height)
    carve(region.texels, courses, depths, forms, height, depth)
    down, right = np.gradient(height)
    found = np.stack([right, -down, depth], axis=2)
    found *= np.array([127.0 * per_slope, 127.0 * per_slope, 255.0 / FULL_DEPTH], np.float32)
    return found


def _sample_of(reach: tuple[float, float], along: Floats64) -> Floats64:
    """Convert lengths along a line [mm] to fractional numbers of samples."""
    low, high = reach
    return (np.clip(along, low, high - 2.0 * SAMPLE_SPACING) - low) / SAMPLE_SPACING


@lru_cache(maxsize=2)
def shared_map(shrink: int) -> Image:
    """Average the built-in map of furrows over blocks of `shrink` x `shrink` texels."""
    known = load("head").wrinkles.map
    found = np.rint(shrunk(known.astype(np.float32), shrink)).astype(np.uint8)
    found.flags.writeable = False
    return found


@lru_cache(maxsize=2)
def _line_regions(shrink: int) -> _Places:
    """Find the regions of lines; all lengths are chosen by eye, except the brows' position."""
    plain = shared_map(shrink).copy()
    rows, columns, place = _face_texels(len(plain))
    near = plain[rows, columns].astype(np.float32)
    x, y, _ = np.moveaxis(place, 2, 0)
    forehead, glabella = _brow_covers(place)
    fan = _fan_around_eyes(place)
    _remove_built_in_lines(near, place, fan)
    # Lines of the forehead follow its first slot, also where the built-in head has frown lines.
    lined = glabella + forehead
    is_lined = lined > 1e-3
    share_of_glabella = glabella / np.maximum(lined, 1e-9)
    near[is_lined, 3] = 255.0 * share_of_glabella[is_lined]
    plain[rows, columns] = np.rint(near)
    corner = rows.start, columns.start
    fold = _fold_cover(place)
    feet = []
    folds = []
    for side in (1, -1):
        is_on_side = side * x > 0.0
        samples = _sample_of(FEET_REACH, fan.radius)
        feet.append(_region(corner, fan.cover * is_on_side, fan.angle, samples, fan.radius))
        folds.append(_fold(corner, fold * is_on_side, near))
    leaning = y + 0.05 * np.maximum(y - 45.0, 0.0) ** 1.5  # the forehead leans back
    one = np.ones_like(x)
    return _Places(
        plain,
        _region(corner, forehead, leaning, _sample_of(FOREHEAD_REACH, x), one),
        _region(corner, glabella, x, _sample_of(GLABELLA_REACH, y), one),
        tuple(feet),
        tuple(folds),
    )


def _brow_covers(place: Floats64) -> tuple[Floats64, Floats64]:
    """Return the cover of lines above the brows, and between them, (h, w) each.

    place: points of the face [mm], (h, w, 3), as for the next functions.
    """
    x, y, z = np.moveaxis(place, 2, 0)
    beside = np.abs(x)
    brow = 26.5 + 2.0 * bump(beside, 32.0, 14.0) - 3.0 * smoothstep(beside, 42.0, 54.0)
    above = smoothstep(y - brow, 0.0, 7.0) * smoothstep(y, 74.0, 60.0)
    above *= smoothstep(beside, 58.0, 36.0) * smoothstep(z, 40.0, 60.0)
    above *= 1.0 - smoothstep(y, 41.0, 36.0) * smoothstep(beside, 19.0, 12.0)
    between = smoothstep(y, 9.0, 15.0) * smoothstep(y, 36.0, 26.0)
    between *= smoothstep(beside, 15.0, 9.0)
    return above, between


class _Fan(NamedTuple):
    """The places of crow's feet, in coordinates around a hub in the orbit, (h, w) each.

    cover: strength, 0 to 1. angle: above the horizontal [rad]. radius, level: distance from the
    hub, and its level part, negative toward the nose [mm].
    """

    cover: Floats64
    angle: Floats64
    radius: Floats64
    level: Floats64


def _fan_around_eyes(place: Floats64) -> _Fan:
    """Find the fans beside both eyes."""
    x, y, z = np.moveaxis(place, 2, 0)
    beside = np.abs(x)
    outward, upward, forward = np.moveaxis(np.stack([beside, y, z], axis=2) - FAN_HUB, 2, 0)
    level = np.hypot(outward, forward) * np.sign(outward)
    up = upward + 0.1 * level  # a fan sinks a little outward
    radius = np.hypot(level, up)
    angle = np.arctan2(up, level)
    cover = smoothstep(radius, 10.5, 13.0) * smoothstep(radius, 36.0, 30.0)
    cover *= smoothstep(angle, -1.25, -0.85) * smoothstep(angle, 0.75, 0.5)
    from_corner = np.hypot(beside - 42.9, y + 0.2)  # [mm] from the outer corner of the lids
    cover *= smoothstep(from_corner, 1.2, 2.4)
    return _Fan(cover, angle, radius, level)


def _fold_cover(place: Floats64) -> Floats64:
    """Return the cover of the folds beside the mouth, (h, w)."""
    x, y, _ = np.moveaxis(place, 2, 0)
    head = load("head")
    ring = head.vertices[head.rings["nasolabial_fold_left"]]
    outside = np.abs(x) - np.interp(-y, -ring[:, 1], ring[:, 0])
    cover = smoothstep(outside, -9.0, -6.0) * smoothstep(outside, 24.0, 18.0)
    cover *= smoothstep(y, -95.0, -88.0) * smoothstep(y, -31.0, -37.0)
    return cover


def _remove_built_in_lines(near: Floats32, place: Floats64, fan: _Fan) -> None:
    """Flatten lines of the built-in head, except those of the lower lid in the second slot.

    near: bytes of the map, (h, w, 4), changed in place.
    """
    x, y, _ = np.moveaxis(place, 2, 0)
    lowest = 9.5 + 11.0 * smoothstep(np.abs(x), 14.0, 20.0)
    is_above = (y > lowest) & (y < FAR_AWAY)
    is_beside_eye = (fan.radius > 8.0) & (fan.radius < 42.0)
    is_in_fan = is_beside_eye & (fan.angle > -1.4) & (fan.level > 0.0)
    in_first_slot = 1.0 - near[..., 3] / 255.0
    taken = is_above.astype(np.float64) + in_first_slot * is_in_fan
    kept = np.maximum(1.0 - taken, 0.0)[..., None]
    near[..., :3] = FLAT_TEXEL + kept * (near[..., :3] - FLAT_TEXEL)


def _face_texels(size: int) -> tuple[slice, slice, Floats64]:
    """Find the rows and columns of the map that hold the face, and points [mm], (h, w, 3)."""
    head = load("head")
    x, y, z = np.moveaxis(head.vertices[head.faces], 2, 0)
    is_high_enough = (y > -100.0) & (y < 85.0)
    is_in_face = is_high_enough & (z > 30.0) & (np.abs(x) < 75.0)  # (F, 3), of the corners
    texels = texels_of(is_in_face.all(axis=1), size)
    rows = slice(int(texels.rows.min()), int(texels.rows.max()) + 1)
    columns = slice(int(texels.columns.min()), int(texels.columns.max()) + 1)
    place = np.full((rows.stop - rows.start, columns.stop - columns.start, 3), FAR_AWAY)
    at = texels.rows - rows.start, texels.columns - columns.start
    place[at] = texels.interpolate(head.vertices[head.faces])
    return rows, columns, place


def _fold(corner: tuple[int, int], cover: Floats64, near: Floats32) -> _Fold:
    """Make a fold of the texels with a positive cover.

    corner: row and column of the map where both arrays begin. cover: strength of the fold, (h, w).
    near: bytes of the map, (h, w, 4).
    """
    rows, columns = np.nonzero(cover > 0.0)
    relief = cover[rows, columns, None] * (near[rows, columns, :3] - FLAT_TEXEL)
    seen = np.abs(relief).max(axis=1) > 0.5
    relief = relief[seen].astype(np.float32)
    return _Fold(corner[0] + rows[seen], corner[1] + columns[seen], relief)


def _region(corner: tuple[int, int], cover: Floats64, *places: Floats64) -> _Region:
    """Cut out the smallest rectangle of the map with all texels of a positive cover.

    corner: row and column of the map where all arrays begin. cover: strength of lines, (h, w).
    places: coordinate across the lines, coordinate along them, and scale, each (h, w).
    """
    covered_rows, covered_columns = np.nonzero(cover > 0.0)
    top = int(covered_rows.min())
    bottom = int(covered_rows.max()) + 1
    left = int(covered_columns.min())
    right = int(covered_columns.max()) + 1
    layers = np.stack([*places, cover], axis=2)
    return _Region(
        rows=slice(corner[0] + top, corner[0] + bottom),
        columns=slice(corner[1] + left, corner[1] + right),
        texels=layers[top:bottom, left:right].astype(np.float32),
    )
