"""Light through an opening of the skin: on a ball that fills it, and on one behind it."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

from risorius import render

from .scenes import PLAIN_STYLE, STILL_TRANSFORMS, Ball, at, draw

WHITISH_COLOUR = (0.8, 0.8, 0.8)


def rim(width, height, z):
    """A lens-shaped rim, clockwise from the viewer's left, the upper half first."""
    count = render.Opening.RIM_POINTS
    t = np.arange(count) / count * 2.0 * np.pi
    x = -0.5 * width * np.cos(t)
    y = 0.5 * height * np.sin(t)
    return np.stack([x, y, np.full(count, z)], axis=1)


def light(renderer, opening, style=PLAIN_STYLE):
    """The brightness of a picture of a ball of radius 20, behind an opening (None: without one)."""
    placed = render.PlacedPart.on_bone(
        Ball(colour=WHITISH_COLOUR), STILL_TRANSFORMS, opening=opening
    )
    return draw(renderer, style=style, parts=[placed]).sum(axis=2)[..., None]


def test_an_eye_is_darkest_below_its_upper_lid(renderer):
    """An eye loses most light below its upper lid, less in the corners, least in the middle."""
    opening = render.Opening(rim(30.0, 20.0, 15.0), is_filled=True)
    plain = light(renderer, None)
    share = light(renderer, opening) / plain
    above, below, aside, middle = (
        at(share, x, y).item() for x, y in ((0.0, 9.0), (0.0, -7.0), (13.0, 0.0), (0.0, -1.0))
    )
    assert max(above, aside) < 0.75
    assert below > 0.9
    assert middle > 0.93


def test_a_wider_mouth_lets_in_more_light(renderer):
    """A ball is dark behind a slit and light behind a wide opening; the edge is darker."""
    plain = at(light(renderer, None), 0.0, 0.0).item()
    heights = (1.0, 8.0, 40.0)
    pictures = [
        light(renderer, render.Opening(rim(50.0, height, 26.0), is_filled=False))
        for height in heights
    ]
    middles = [at(picture, 0.0, 0.0).item() / plain for picture in pictures]
    assert middles[0] < 0.62
    assert middles[0] < middles[1] < middles[2]
    assert middles[2] > 0.85


def test_the_corners_of_a_mouth_are_in_shade(renderer):
    """Light in an open mouth falls gradually toward its corners.

    Otherwise premolars beside dark gums would have a light edge.
    """
    opening = render.Opening(rim(30.0, 12.0, 20.0), is_filled=False)
    share = light(renderer, opening) / light(renderer, None)
    lights = [at(share, x, -1.0).item() for x in (0.0, 4.0, 8.0, 12.0)]
    assert (np.diff(lights) < 0.0).all()
    assert lights[-1] < 0.63 * lights[0]


def test_a_tongue_outside_the_mouth_has_all_light(renderer):
    """A tongue in front of the lips loses no light."""
    opening = render.Opening(rim(50.0, 20.0, 5.0), is_filled=False)
    out = at(light(renderer, opening), 0.0, 0.0).item()
    assert out == approx(at(light(renderer, None), 0.0, 0.0).item(), abs=3.0)


@pytest.mark.parametrize("is_filled", [True, False])
def test_without_skin_maps_openings_do_not_count(renderer, is_filled):
    """With skin maps off, openings darken nothing."""
    style = replace(PLAIN_STYLE, skin_maps=False)
    opening = render.Opening(rim(30.0, 10.0, 22.0), is_filled=is_filled)
    assert (light(renderer, opening, style) == light(renderer, None, style)).all()
    assert (light(renderer, opening) < light(renderer, None)).any()
