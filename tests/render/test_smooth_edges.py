"""Smooth edges by samples, with one shading per pixel."""

from dataclasses import replace

import numpy as np
import pytest

from risorius import render

from .scenes import (
    PLAIN_STYLE,
    Ball,
    Shape,
    draw,
    draw_image,
    facing,
    joined,
    lent,
    needs_samples,
    sphere,
    square,
    still,
)

CLAY_STYLE = replace(PLAIN_STYLE, gloss=0.0)


def pictures(shape, style=CLAY_STYLE, *, camera=None):
    """Lightness (0..255) of a shape without and with smooth edges, shape (2, H, W)."""
    seen = []
    for samples in (0, 4):
        with render.open_offscreen((96, 96), samples=samples) as surface:
            if samples:
                needs_samples(surface)
            seen.append(draw_image(surface, shape, style, camera=camera).mean(axis=2))
    return np.array(seen)


def turned(shape, degrees):
    """A shape rotated around the line of sight."""
    angle = np.radians(degrees)
    cosine = np.cos(angle)
    sine = np.sin(angle)
    matrix = np.array([(cosine, sine, 0), (-sine, cosine, 0), (0, 0, 1)], np.float32)
    return Shape(shape.positions @ matrix, shape.normals @ matrix, shape.triangles)


def test_an_outline_covers_as_much_as_its_shape():
    """Edges of a rotated black square have five levels, one for each number of covered samples.

    The covered area is exact.
    """
    black = replace(CLAY_STYLE, albedo=(0.0, 0.0, 0.0))
    hard, smooth = pictures(turned(square(30.0), 20.0), black)
    darkest = smooth.min()
    cover = (255.0 - smooth) / (255.0 - darkest)
    levels = np.unique(np.round(4.0 * cover))
    assert levels.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    across = 60.0 * 96 / (2.0 * 250.0 * np.tan(np.radians(12.5)))  # [pixels]
    assert abs(cover.sum() - across**2) < 0.01 * across**2
    assert ((hard > darkest + 1.0) & (hard < 254.0)).sum() == 0


@pytest.mark.parametrize("shading", list(render.Shading))
def test_colours_inside_stay_as_they_are(shading):
    """Pixels more than one pixel from any edge are unchanged."""
    shape = sphere(4, 40.0)
    style = replace(CLAY_STYLE, shading=shading)
    hard, smooth = pictures(shape, style)
    away = np.hypot(*(np.indices(hard.shape) - 47.5))
    radius = away[hard < 250.0].max()
    inside = away < 0.8 * radius
    most = 0.0 if shading is not render.Shading.FLAT else 12.0  # edges of flat facets are smoothed
    assert np.abs(hard - smooth)[inside].max() <= most
    assert np.abs(hard - smooth).max() > 20.0


def test_surfaces_that_touch_have_a_smooth_line_between_them():
    """The line between two touching halves that face up and down, like lips, is smooth."""
    halves = []
    for sign in (1.0, -1.0):
        half = square(30.0)
        places = half.positions * np.float32((1.0, 0.5, 1.0)) + np.float32((0.0, 15.0 * sign, 0.0))
        normal = np.float32((0.0, 0.6 * sign, 0.8))
        halves.append(Shape(places, np.tile(normal, (4, 1)), half.triangles))
    hard, smooth = pictures(turned(joined(*halves), 8.0))
    inner = (slice(30, 66), slice(30, 66))
    ends = np.unique(np.round(hard[inner]))
    darkest = ends.min()
    brightest = ends.max()
    assert brightest > darkest + 20.0

    def lies_between(image):
        return (image > darkest + 3.0) & (image < brightest - 3.0)

    assert lies_between(smooth[inner]).sum() > 15
    assert not lies_between(hard[inner]).any()


def test_the_line_where_a_part_comes_through_is_smooth(renderer):
    """The intersection of a ball and a wall is smooth, although no triangle ends there."""
    needs_samples(renderer.surface)
    wall = lent(renderer, square(z=10.0))
    smooth = draw(renderer, wall, parts=still(Ball()))
    with render.open_offscreen((96, 96), samples=0) as plain:
        other = render.Renderer(plain)
        hard = draw(other, lent(other, square(z=10.0)), parts=still(Ball()))
    bluish = [each[:, :, 2] - each[:, :, 0] for each in (hard, smooth)]
    changed = np.abs(bluish[0] - bluish[1]) > 8
    assert 20 < changed[20:76, 20:76].sum() < 200


@pytest.mark.parametrize("yaw", [20.0, 200.0])
def test_either_side_of_a_sheet_has_a_smooth_outline(yaw):
    """Both sides of a sheet have smooth outlines."""
    camera = facing()
    camera.orbit(yaw, 10.0)
    hard, smooth = pictures(turned(square(30.0), 15.0), camera=camera)
    assert ((hard - smooth) > 20.0).sum() > 20
    assert ((smooth - hard) > 20.0).sum() > 20


def test_facets_have_smooth_edges():
    """With flat shading, lines between triangles are smooth, too."""
    values = (np.arange(2) % 2).astype(np.uint8) * 3
    shape = turned(square(30.0), 10.0)
    style = replace(CLAY_STYLE, colour_by=render.ColourBy.SPLITS)
    seen = []
    for samples in (0, 4):
        with render.open_offscreen((96, 96), samples=samples) as surface:
            seen.append(draw_image(surface, shape, style, values=values)[36:60, 36:60])
        if samples:
            needs_samples(surface)
    count = [len(np.unique(each.reshape(-1, 3), axis=0)) for each in seen]
    assert count[0] == 2
    assert count[1] > 3


def test_a_small_disc_stays_round():
    """A disc as wide as pupils has the same area at any place within a pixel."""
    areas = []
    black = replace(CLAY_STYLE, albedo=(0.0, 0.0, 0.0))
    for shift in (0.0, 0.3, 0.7):
        disc = sphere(4, 7.0)
        moved = Shape(
            disc.positions + np.float32((shift, shift, 0.0)), disc.normals, disc.triangles
        )
        areas.append((255.0 - pictures(moved, black)[1]).sum())
    assert max(areas) < 1.05 * min(areas)
