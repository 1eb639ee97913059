"""Other lights: which pixels they change."""

from dataclasses import replace

import numpy as np
import pytest

from risorius import render
from risorius.app import light_maps
from risorius.app.cli.styles import LIGHT_NAMES, LIGHT_SUFFIXES

from .scenes import (
    DARK_SKIN,
    LIGHT_SKIN,
    PLAIN_STYLE,
    Ball,
    draw,
    draw_image,
    drawn,
    joined,
    lent,
    sphere,
    square,
    still,
)

SHADED_STYLE = replace(PLAIN_STYLE, shadows=True, albedo=render.CLAY)
NO_RIM = replace(render.Light(), rim=(0.0, 0.0, 0.0))


def swapped(light):
    """A light with left and right exchanged."""
    (a, b, c) = light.to_key
    (d, e, f) = light.to_fill
    return replace(light, to_key=(-a, b, c), to_fill=(-d, e, f))


def scene(surface, light):
    """A ball before a wall, in a mesh that is mirror-symmetric."""
    shape = joined(square(70.0, z=-45.0), sphere(3, 30.0))
    return draw_image(surface, shape, replace(SHADED_STYLE, light=light))


def test_light_of_the_other_side_makes_the_mirror_image(surface):
    """A mirrored light gives the mirror image, with shading and cast shadow."""
    for light in (NO_RIM, replace(render.LIGHTS["window"], rim=(0.0, 0.0, 0.0))):
        here = scene(surface, light)
        there = scene(surface, swapped(light))
        assert np.abs(here - here[:, ::-1]).max() > 60
        off = np.abs(here - there[:, ::-1])
        assert off.mean() < 0.3
        assert np.percentile(off, 99.0) <= 4


def test_other_light_leaves_nothing_behind(surface, renderer):
    """In one renderer, the studio light gives the same bits before and after other lights."""
    stream = lent(renderer, joined(square(70.0, z=-45.0), sphere(2, 30.0)))
    camera = render.OrbitCamera.framing(stream.vertices[:, :3])

    def picture(style):
        """The picture of the mesh and a part in front of it."""
        draw(renderer, stream, style, parts=still(Ball()), camera=camera)
        return surface.read()

    studio = picture(SHADED_STYLE)
    for name, light in render.LIGHTS.items():
        other = picture(replace(SHADED_STYLE, light=light))
        assert (other == studio).all() == (name == "studio")
    assert (picture(SHADED_STYLE) == studio).all()


@pytest.mark.parametrize("name", render.LIGHTS)
def test_no_light_is_too_bright_or_too_dark(surface, name):
    """Balls in light and dark skin are neither white nor black where they face the viewer."""
    for albedo, low, high in ((LIGHT_SKIN, 60, 254), (DARK_SKIN, 16, 235)):
        style = replace(PLAIN_STYLE, albedo=albedo, light=render.LIGHTS[name])
        image = draw_image(surface, sphere(4, 50.0), style)
        middle = drawn(image) & (np.hypot(*np.indices(image.shape[:2]) - 47.5) < 32)
        shown = image[middle]
        assert shown.max(axis=1).min() > low
        assert (shown.min(axis=1) >= high).mean() < 0.01


def test_the_command_knows_all_lights():
    """The lists of lights and their files for `--style` are complete; help needs no OpenGL."""
    assert tuple(LIGHT_NAMES) == tuple(render.LIGHTS)
    assert light_maps.LIGHT_SUFFIXES == LIGHT_SUFFIXES
