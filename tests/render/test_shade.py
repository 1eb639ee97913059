"""Translucent colours over a part of a surface."""

import numpy as np
from pytest import approx

from risorius.render import Shade

from .scenes import at, draw, lent, square

RED = (1.0, 0.0, 0.0)


def shade_over(wall, opacity, *, behind=0.0, lift=0.0):
    """A red shade with the triangles of a wall, behind it or in its plane."""
    positions = wall.positions - np.array((0.0, 0.0, behind), np.float32)
    return Shade(positions, wall.triangles, np.asarray(opacity), RED, lift)


def test_opacity_varies_over_a_shade(renderer):
    """At the left the wall keeps its colour, at the right it is red, with a mean in between."""
    wall = square()
    skin = lent(renderer, wall)
    shade = shade_over(wall, (0.0, 1.0, 1.0, 0.0), lift=1.0)
    plain = draw(renderer, skin)
    shaded = draw(renderer, skin, lines=[shade])
    red = np.array((255, 0, 0))
    assert at(shaded, -49.0, 0.0) == approx(at(plain, -49.0, 0.0), abs=8)
    assert at(shaded, 49.0, 0.0) == approx(red, abs=8)
    assert at(shaded, 0.0, 0.0) == approx(0.5 * (at(plain, 0.0, 0.0) + red), abs=8)


def test_a_surface_hides_a_shade_behind_it(renderer):
    """A lift shows the shade of a mesh that lies a little behind the picture's surface."""
    wall = square()
    skin = lent(renderer, wall)
    plain = draw(renderer, skin)
    opacity = np.ones(4)
    hidden = draw(renderer, skin, lines=[shade_over(wall, opacity, behind=2.0)])
    lifted = draw(renderer, skin, lines=[shade_over(wall, opacity, behind=2.0, lift=4.0)])
    assert (hidden == plain).all()
    assert at(lifted, 0.0, 0.0) == approx((255, 0, 0), abs=8)


def test_back_sides_have_no_shade(renderer):
    """A mesh that faces away shows nothing, as does a shade without opacity."""
    wall = square()
    skin = lent(renderer, wall)
    plain = draw(renderer, skin)
    turned = Shade(wall.positions, wall.triangles[:, ::-1], np.ones(4), RED, 1.0)
    clear = shade_over(wall, np.zeros(4), lift=1.0)
    assert (draw(renderer, skin, lines=[turned, clear]) == plain).all()
