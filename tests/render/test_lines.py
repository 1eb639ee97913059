"""Polylines over the scene."""

import numpy as np
from pytest import approx

from risorius.render import Lines

from .scenes import at, draw, drawn, lent, square

RED = (1.0, 0.0, 0.0)


def test_lines_before_and_behind(renderer):
    """A line in front has its full colour, a line behind shows through.

    With a strength of 0 the line behind is hidden.
    """
    wall = lent(renderer, square())
    over = np.array([(-40, 20, 5), (0, 20, 5), (40, 20, 5)], np.float64)
    under = over - (0, 40, 10)
    frames = []
    for hidden_opacity in (0.5, 0.0):
        colours = np.array([(0, 0.8, 0), (0, 0, 0.9)])
        lines = Lines([over, under], colours, 4.0, hidden_opacity)
        frames.append(draw(renderer, wall, lines=[lines]))
    skin = at(frames[0], 0.0, 0.0)
    for frame in frames:
        assert at(frame, 10.0, 20.4) == approx((0, 204, 0), abs=3)
    assert at(frames[0], 10.0, -20.0) == approx(skin * 0.5 + np.array((0, 0, 115)), abs=6)
    assert at(frames[1], 10.0, -20.0) == approx(skin, abs=3)


def test_lines_are_not_joined(renderer):
    """The end of one polyline is not joined to the start of the next.

    Empty polylines are accepted.
    """
    left = np.array([(-40.0, -10, 0), (-40, 10, 0)])
    right = np.array([(40.0, -10, 0), (40, 10, 0)])
    lines = Lines([np.zeros((0, 3)), left, np.zeros((1, 3)), right], RED)
    image = draw(renderer, lines=[Lines([], RED), lines])
    columns = np.nonzero(drawn(image).any(axis=0))[0]
    assert len(columns) > 2
    assert not ((columns > 20) & (columns < 76)).any()
