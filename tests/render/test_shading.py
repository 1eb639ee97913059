"""Shading: flat, Gouraud, per pixel; the effect of light on skin, front and back."""

from dataclasses import replace

import numpy as np
import pytest

from risorius import render

from .scenes import PLAIN_STYLE, Shape, at, draw, draw_image, lent, sphere, square, turned_over

FLAT_STYLE = replace(PLAIN_STYLE, shading=render.Shading.FLAT)
GOURAUD_STYLE = replace(PLAIN_STYLE, shading=render.Shading.GOURAUD)


def test_flat_facets_have_one_colour(surface):
    """Flat shading gives a tilted triangle one colour; Gouraud does not."""
    shape = square(bulge=1.0)
    tilted = Shape(shape.positions.copy(), shape.normals, shape.triangles[:1])
    tilted.positions[:, 2] = (0.0, 25.0, 5.0, 0.0)
    spread = {}
    for name, style in (("flat", FLAT_STYLE), ("gouraud", GOURAUD_STYLE)):
        frame = draw_image(surface, tilted, style)
        inner = frame[60:72, 56:72].reshape(-1, 3)
        spread[name] = int(np.ptp(inner, axis=0).max())
    assert spread["flat"] <= 1 < spread["gouraud"]


def test_only_pixel_shading_lights_the_middle_of_a_facet(surface):
    """If four corners face away, Gouraud shading is as dark as they are; per-pixel is lighter."""
    shape = square(bulge=3.0)

    def middle(style):
        """The sum of the colours in the middle of the facet."""
        return int(at(draw_image(surface, shape, style), 3.0, -1.0).sum())

    assert middle(PLAIN_STYLE) > middle(GOURAUD_STYLE) + 20


def test_light_comes_from_the_upper_left(surface):
    """A sphere is brightest at the upper left, and its dark side is not black."""
    frame = draw_image(surface, sphere(4), replace(PLAIN_STYLE, albedo=render.CLAY)).sum(axis=2)
    upper_left = frame[32, 32]
    lower_right = frame[64, 64]
    assert upper_left > 1.5 * lower_right
    assert lower_right > 3 * 30


def test_terminator_of_skin_is_warm(surface):
    """Where light fades out, skin is redder than its albedo, and clay is not."""
    shares = {}
    for name, albedo in (("skin", render.SKIN), ("clay", render.CLAY)):
        style = replace(PLAIN_STYLE, albedo=albedo, background=render.DARK)
        frame = draw_image(surface, sphere(4), style).astype(float)
        share = frame[:, :, 0] / frame.sum(axis=2)
        shares[name] = share[60, 60] - share[36, 36]
    assert shares["skin"] > shares["clay"] + 0.01


def test_inner_side_is_dark_flesh(surface):
    """From behind, a surface is much darker, and red."""
    shape = square()
    turned = turned_over(shape)
    for style in (FLAT_STYLE, GOURAUD_STYLE, PLAIN_STYLE):
        front = at(draw_image(surface, shape, style), 5.0, 5.0)
        behind = at(draw_image(surface, turned, style), 5.0, 5.0)
        assert behind.sum() < 0.4 * front.sum()
        assert behind[0] > 1.5 * behind[1]
        assert behind[0] > 20


def fading(renderer, shape, shares, inner):
    """A shape with opacities at its vertices; `inner` below 0 hides its inner side."""
    stream = lent(renderer, shape, columns=18)
    stream.vertices[:, 16] = shares
    stream.vertices[:, 17] = inner
    stream.upload(len(shape.positions), len(shape.triangles))
    return render.Skin(stream, fading=shape.positions.astype(np.float64))


@pytest.mark.parametrize("wireframe", [False, True])
def test_skin_fades_as_its_vertices_have_it(renderer, wireframe):
    """Skin is opaque for an opacity of 1, half transparent for 0.5, and missing for 0.

    Wires are drawn in the same way.
    """
    skin = fading(renderer, square(30.0), (0.0, 0.0, 1.0, 1.0), 1.0)  # from the bottom to the top
    pictures = []
    style = replace(PLAIN_STYLE, wireframe=wireframe, wire_width=0.01)
    for each in (render.Skin(skin.stream), skin):
        image = draw(renderer, each, style)
        pictures.append(255.0 - image.mean(axis=2))
    whole, faded = pictures
    rows = np.flatnonzero(whole[:, 48] > 1.0)
    top, middle, bottom = (faded[rows, 48] / whole[rows, 48])[[1, len(rows) // 2, -2]]
    assert top > 0.98
    assert abs(middle - 0.5) < 0.05
    assert bottom < 0.02


def test_the_inside_of_a_faded_neck_does_not_show(renderer):
    """Back faces with a number below 0 are hidden, those of lips and lids are visible."""
    shape = square(30.0)
    turned = turned_over(shape)
    for inner, is_seen in ((0.5, True), (-0.5, False)):
        skin = fading(renderer, turned, (0.25, 1.75, 1.75, 0.25), inner)  # half of it is opaque
        assert (draw(renderer, skin)[48, 60].mean() < 250.0) == is_seen


def test_a_fade_needs_its_columns(renderer):
    """Rows without the columns of a fade are refused."""
    stream = lent(renderer, square(), columns=16)
    with pytest.raises(ValueError, match="a fade on a stream of 16 columns"):
        render.Skin(stream, fading=np.zeros((1, 3)))


def round_rim(turn=1):
    """The rim of round lips in front of the mesh; turn: -1 for lips seen from behind."""
    angles = np.linspace(np.pi, -np.pi, render.Opening.RIM_POINTS, endpoint=False)[::turn]
    centre = np.array([0.0, 0.0, 10.0])
    return centre + 5.0 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])


@pytest.mark.parametrize("shading", render.Shading)
def test_the_inside_of_cheeks_is_dark_behind_the_lips(renderer, shading):
    """Back faces in the mouth get the light of the opening; a pale strip lay beside the teeth.

    Beside the mouth, and where lips are seen from behind, back faces keep their light.
    """
    shape = square(30.0)
    turned = turned_over(shape)
    style = replace(PLAIN_STYLE, shading=shading)
    skin = render.Skin(lent(renderer, turned))
    lit = draw(renderer, skin, style)
    behind = draw(renderer, replace(skin, mouth=round_rim()), style)
    assert behind[48, 48].mean() < 0.8 * lit[48, 48].mean()
    assert (behind[48, 66] == lit[48, 66]).all()
    assert (draw(renderer, replace(skin, mouth=round_rim(-1)), style) == lit).all()


@pytest.mark.parametrize("turn", [1, -1])
def test_the_inside_of_a_faded_neck_shows_through_the_lips(renderer, turn):
    """Faded back faces are drawn within the outline of the mouth, so that it has no hole.

    Beside it they are hidden.
    """
    shape = square(30.0)
    turned = turned_over(shape)
    skin = fading(renderer, turned, (1.75, 1.75, 1.75, 1.75), -0.5)
    image = draw(renderer, replace(skin, mouth=round_rim(turn)))
    assert (image[48, 48].mean() < 250.0) == (turn == 1)
    assert image[48, 80].mean() > 250.0
