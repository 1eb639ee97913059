"""Wrinkles of the skin (bumps): visible in proportion to their amounts, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from risorius import render

from .scenes import PLAIN_STYLE, at, draw, lent, sphere, square

LEVEL = (128, 128, 0, 0)  # no slope
STEEP_BUMPS = 100.0  # a slope of 1 over a square of 100 mm


def furrowed(surface, texel, amounts, style=PLAIN_STYLE, *, left=LEVEL, corner=(1.0, 0.0)):
    """The picture of a square whose map has `texel` in its right half, with bumps by `amounts`.

    left: the texel of the left half. corner: the texture coordinates of the lower right vertex.
    """
    texels = np.full((32, 32, 4), left, np.uint8)
    texels[:, 16:] = texel
    shape = square()
    renderer = render.Renderer(surface)
    stream = lent(renderer, shape, columns=16)
    stream.vertices[:, 6:8] = shape.positions[:, :2] / 100.0 + 0.5
    stream.vertices[1, 6:8] = corner
    has_bumps = amounts is not None
    stream.vertices[:, 8:10] = amounts if has_bumps else 1.0
    stream.vertices[:, 10:] = (0.01, 0.0, 0.0, 0.0, 0.01, 0.0)  # u and v grow by 1 over 100 mm
    stream.upload(len(shape.positions), len(shape.triangles), has_bumps=has_bumps)
    bumps = render.BumpMap(renderer.surface, texels, STEEP_BUMPS)
    return draw(renderer, render.Skin(stream, render.SkinMaps(bumps=bumps)), style)


def test_slopes_are_lit_like_the_slopes_they_are(surface):
    """Slopes that rise to the right face the key light, at the upper left, and are brighter."""
    plain = furrowed(surface, LEVEL, (1.0, 1.0))
    rises_right = furrowed(surface, (190, 128, 0, 0), (1.0, 0.0))
    rises_up = furrowed(surface, (128, 190, 0, 0), (1.0, 0.0))
    assert at(rises_right, 25, 0).sum() > at(plain, 25, 0).sum() + 10
    assert at(rises_up, 25, 0).sum() < at(plain, 25, 0).sum() - 10
    assert (at(rises_right, -25, 0) == at(plain, -25, 0)).all()


def test_furrows_are_darker(surface):
    """Furrows are darker the deeper they are, least in red."""
    plain = at(furrowed(surface, LEVEL, (1.0, 1.0)), 25, 0)
    deep = at(furrowed(surface, (128, 128, 200, 0), (1.0, 0.0)), 25, 0)
    assert (deep < plain).all()
    assert deep[0] / plain[0] > deep[2] / plain[2]


def test_stretched_skin_is_redder_and_has_no_furrow(surface):
    """Amounts below 0 redden the skin; they show no furrow with reversed slope and shade."""
    furrow = (190, 190, 200, 0)
    plain = at(furrowed(surface, LEVEL, (1.0, 1.0)), 25, 0)
    stretched = at(furrowed(surface, furrow, (-1.0, -1.0)), 25, 0)
    assert (stretched == at(furrowed(surface, LEVEL, (-1.0, -1.0)), 25, 0)).all()
    assert stretched[0] / stretched[2] > 1.03 * plain[0] / plain[2]


def test_a_texel_follows_its_own_amount(surface):
    """A texel with alpha 0 follows the first amount, one with 255 the second."""
    plain = at(furrowed(surface, LEVEL, (1.0, 1.0)), 25, 0)
    first = (190, 190, 90, 0)
    second = (190, 190, 90, 255)
    for texel, amounts in ((first, (0.0, 1.0)), (second, (1.0, 0.0))):
        assert (at(furrowed(surface, texel, amounts), 25, 0) == plain).all()
    for texel, amounts in ((first, (1.0, 0.0)), (second, (0.0, 1.0))):
        assert (at(furrowed(surface, texel, amounts), 25, 0) != plain).any()


@pytest.mark.parametrize("amounts", [None, (0.0, 0.0), (1.0, 1.0)])
def test_none_without_amounts_or_strength(surface, amounts):
    """A style without bumps and a skin without amounts give the same bytes."""
    smooth = replace(PLAIN_STYLE, bumps=0.0)
    style = smooth if amounts == (1.0, 1.0) else PLAIN_STYLE
    texel = (190, 90, 200, 128)
    assert (furrowed(surface, texel, amounts, style) == furrowed(surface, texel, None)).all()


@pytest.mark.parametrize("shading", [render.Shading.FLAT, render.Shading.GOURAUD])
def test_per_pixel_shading_alone_has_them(surface, shading):
    """Only per-pixel shading shows bumps, because others have no normal for each pixel."""
    style = replace(PLAIN_STYLE, shading=shading)
    texel = (190, 90, 200, 128)
    furrows = furrowed(surface, texel, (1.0, 1.0), style)
    assert (furrows == furrowed(surface, texel, None, style)).all()


def test_part_of_a_mesh_has_bumps_without_a_crack(renderer):
    """With a level map, bumps on one half of a sphere change nothing, also along the border."""
    shape = sphere()
    stream = lent(renderer, shape, columns=16)
    level = render.BumpMap(renderer.surface, np.full((4, 4, 4), LEVEL, np.uint8), STEEP_BUMPS)
    frames = []
    for share in (0.0, 0.5):
        stream.vertices[: int(share * len(shape.positions)), 8:10] = 1.0
        stream.upload(len(shape.positions), len(shape.triangles), has_bumps=True)
        frames.append(draw(renderer, render.Skin(stream, render.SkinMaps(bumps=level))))
    assert np.abs(frames[0] - frames[1]).max() <= 1


def test_what_does_not_fit_is_refused(renderer):
    """An invalid map, a stream without amounts, and one without texture coordinates are refused."""
    with pytest.raises(ValueError, match="the bump map has shape"):
        render.BumpMap(renderer.surface, np.zeros((4, 4, 3), np.uint8), STEEP_BUMPS)
    shape = square()
    stream = lent(renderer, shape)
    with pytest.raises(ValueError, match=r"bumps on a stream of 6 columns.* lend a stream of 16"):
        stream.upload(4, 2, has_bumps=True)
    level = render.BumpMap(renderer.surface, np.full((4, 4, 4), LEVEL, np.uint8), STEEP_BUMPS)
    with pytest.raises(ValueError, match="8 columns"):
        render.Skin(stream, render.SkinMaps(bumps=level))


def test_a_furrow_runs_whole_over_unequal_triangles(surface):
    """Light on a furrow does not jump between two triangles that are stretched differently."""
    slope = (190, 128, 0, 0)
    frame = furrowed(surface, slope, (1.0, 1.0), left=slope, corner=(0.6, 0.4))
    beside = np.abs(at(frame, 5, -5) - at(frame, -5, 5))
    across = np.abs(at(frame, 10, 0) - at(frame, 5, -5))
    assert beside.max() <= across.max() + 2
