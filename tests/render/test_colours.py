"""Wireframe, and colours by each triangle's number of splits."""

from dataclasses import replace

import numpy as np
import pytest

from risorius import render

from .scenes import PLAIN_STYLE, at, draw_image, sphere, square

SPLITS_STYLE = replace(PLAIN_STYLE, colour_by=render.ColourBy.SPLITS)


def test_wireframe_darkens_edges_only(surface):
    """Lines appear along borders and the diagonal; between them the surface is unchanged."""
    plain = draw_image(surface, square())
    wired = draw_image(surface, square(), replace(PLAIN_STYLE, wireframe=True, wire_width=3.0))
    assert at(wired, 0.0, 0.0).sum() < 0.8 * at(plain, 0.0, 0.0).sum()
    assert at(wired, 49.5, 0.0).sum() < 0.9 * at(plain, 49.5, 0.0).sum()
    assert (at(wired, 20.0, -20.0) == at(plain, 20.0, -20.0)).all()
    changed = (np.abs(wired - plain) > 8).any(axis=2)
    assert 0.05 < changed.mean() < 0.2


@pytest.mark.parametrize("shading", render.Shading)
@pytest.mark.parametrize("wireframe", [False, True])
def test_split_colours_are_where_the_values_say(surface, shading, wireframe):
    """A split triangle has the hue of its palette entry, its unsplit neighbour that of skin."""
    style = replace(SPLITS_STYLE, shading=shading, wireframe=wireframe)
    frame = draw_image(surface, square(), style, values=np.array([0, 4], np.uint8))
    lower = at(frame, 20.0, -20.0)
    upper = at(frame, -20.0, 20.0)
    assert lower[0] > lower[2] + 20
    assert upper[2] > upper[0] + 60
    swapped = draw_image(surface, square(), style, values=np.array([4, 0], np.uint8))
    assert at(swapped, 20.0, -20.0)[2] > at(swapped, 20.0, -20.0)[0] + 60


def test_split_wires_outline_split_triangles_alone(surface):
    """Outlines of split triangles have the palette's hue.

    Their insides, and unsplit triangles, are unchanged.
    """
    wires = replace(PLAIN_STYLE, colour_by=render.ColourBy.SPLIT_WIRES, wire_width=3.0)
    plain = draw_image(surface, square())
    whole = draw_image(surface, square(), wires, values=np.array([0, 0], np.uint8))
    split = draw_image(surface, square(), wires, values=np.array([0, 4], np.uint8))
    assert np.abs(whole - plain).max() < 2
    assert (at(split, -20.0, 20.0) == at(plain, -20.0, 20.0)).all()
    changed = (np.abs(split - plain) > 8).any(axis=2)
    assert 0.02 < changed.mean() < 0.15
    assert split[changed][:, 2].mean() > split[changed][:, 0].mean() + 20
    assert not changed[60:, 70:].any()  # corner of the unsplit triangle


def test_split_colours_of_many_triangles(surface):
    """Triangles beyond the first row of the look-up texture have their own colours, too."""
    shape = sphere(5)
    centres = shape.positions[shape.triangles].mean(axis=1)
    values = np.where(centres[:, 1] > 0.0, 5, 0).astype(np.uint8)
    assert len(values) > 2 * 1024
    frame = draw_image(surface, shape, SPLITS_STYLE, values=values)
    upper = frame[30, 30:66]
    lower = frame[66, 30:66]
    assert (upper[:, 2] > upper[:, 0]).all()
    assert (lower[:, 0] > lower[:, 2]).all()


def test_palette_darkens_with_the_number_of_splits():
    """Luminance falls with each entry, so that the palette's order is visible without colour."""
    luminance = np.array(render.SPLIT_PALETTE) @ (0.2126, 0.7152, 0.0722)
    assert len(luminance) == 6
    assert (np.diff(luminance) < -0.08).all()


def test_split_values_must_be_there(surface):
    """Missing numbers of splits, and a wrong count of them, are refused."""
    with pytest.raises(ValueError, match="the style colours by values, so the skin needs values"):
        draw_image(surface, square(), SPLITS_STYLE)
    with pytest.raises(ValueError, match="could not broadcast"):
        draw_image(surface, square(), SPLITS_STYLE, values=np.zeros(3, np.uint8))
