"""Light from all around: errors of the key light and nine coefficients made from a map."""

from dataclasses import replace

import numpy as np
import pytest

from risorius import render
from risorius.render.light_map import directions

from .scenes import PLAIN_STYLE, draw_image, sphere


def matte(light, normals):
    """Light on matte surfaces with these normals (n, 3), computed as in the shader."""
    x, y, z = normals.T
    second = [x * y, y * z, x * z, 3.0 * z * z - 1.0, x * x - y * y]
    polynomials = np.stack([np.ones_like(x), y, z, x, *second], axis=-1)
    from_key = np.maximum(normals @ np.array(light.to_key), 0.0)[:, None]
    return polynomials @ np.array(light.around) + from_key * light.key


def summed(radiance, normals):
    """The same light, as a sum over every texel of the map."""
    rows, columns = radiance.shape[:2]
    away = directions(rows, columns)
    solid = np.repeat(-np.diff(np.sin(np.linspace(0.5, -0.5, rows + 1) * np.pi)), columns)
    solid *= 2.0 * np.pi / columns / np.pi
    cosines = np.maximum(normals @ away.reshape(-1, 3).T, 0.0) * solid
    return cosines @ radiance.reshape(-1, 3)


def test_even_light_is_even():
    """A uniform white environment lights each surface equally, and has no key light."""
    light = render.LightMap(np.full((32, 64, 3), 3.0)).light()
    lit = matte(light, directions(8, 16).reshape(-1, 3))
    assert np.ptp(lit) < 1e-3
    assert max(light.key) < 1e-3


@pytest.mark.parametrize("name", render.LIGHT_MAPS)
def test_key_and_harmonics_hold_the_light_of_the_map(name):
    """The error of the key light and coefficients is a few per cent of the brightest surface."""
    light_map = render.LIGHT_MAPS[name]
    normals = directions(8, 16).reshape(-1, 3)
    expected = summed(light_map.radiance, normals)
    found = matte(light_map.light(), normals)
    found *= expected.sum() / found.sum()
    assert np.abs(found - expected).max() < 0.12 * expected.max()
    assert np.abs(found - expected).mean() < 0.04 * expected.max()


def test_the_sun_is_the_key_wherever_it_is_turned():
    """A bright spot at the upper right becomes the key light, and turns with the map."""
    radiance = np.full((64, 128, 3), 0.05)
    away = directions(64, 128)
    sun = np.array([0.6, 0.64, 0.48])
    radiance[away @ sun > 0.99] = 80.0
    light_map = render.LightMap(radiance)
    assert np.array(light_map.light().to_key) @ sun > 0.995
    turned = np.array(light_map.light(40.0).to_key)
    angle = np.arctan2(*turned[[0, 2]]) - np.arctan2(*sun[[0, 2]])
    assert abs(np.degrees(angle)) == pytest.approx(40.0, abs=3.0)
    assert light_map.light().key[0] > 4.0 * light_map.light().around[0][0]


def test_any_unit_gives_the_same_picture():
    """Maps in nits and in fractions of white give the same light, because maps are exposed."""
    radiance = render.LIGHT_MAPS["room"].radiance
    light = render.LightMap(radiance).light()
    other = render.LightMap(1000.0 * radiance).light()
    assert np.allclose(light.around, other.around, atol=1e-4)


def test_a_ball_is_lit_as_the_map_says(surface):
    """A ball is red at the side of a red wall, and blue at the side of a blue wall."""
    radiance = np.zeros((32, 64, 3))
    away = directions(32, 64)
    radiance[away[..., 0] > 0.3] = (1.0, 0.1, 0.1)
    radiance[away[..., 0] < -0.3] = (0.1, 0.1, 1.0)
    style = replace(PLAIN_STYLE, albedo=render.CLAY, light=render.LightMap(radiance).light())
    image = draw_image(surface, sphere(4, 50.0), style).astype(int)
    height, width = image.shape[:2]
    left, right = (image[height // 2, round(share * width)] for share in (0.35, 0.65))
    assert left[2] - left[0] > 25
    assert right[0] - right[2] > 25
