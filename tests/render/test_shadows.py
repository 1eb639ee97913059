"""Shadows of the key light."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from risorius import render

from .scenes import (
    PLAIN_STYLE,
    Ball,
    Shape,
    at,
    draw,
    draw_image,
    facing,
    joined,
    lent,
    sphere,
    square,
)


def test_shadow_of_the_key_light(surface):
    """A small square before a wall darkens the wall only at its lower right."""
    blocker = square(12.0, z=30.0)
    thick = Shape(blocker.positions - (0, 0, 4), -blocker.normals, blocker.triangles[:, ::-1])
    shape = joined(square(), joined(blocker, thick))
    without = draw_image(surface, shape, replace(PLAIN_STYLE, albedo=render.CLAY))
    within = draw_image(surface, shape, replace(PLAIN_STYLE, albedo=render.CLAY, shadows=True))
    # The key light is at (-0.53, 0.63, 0.57): the shadow of a point 28 mm before the wall is 26 mm
    # right and 31 mm down.
    assert at(within, 26.0, -31.0).sum() < 0.8 * at(without, 26.0, -31.0).sum()
    assert at(within, 26.0, -31.0).min() > 40
    assert (at(within, -30.0, 30.0) == at(without, -30.0, 30.0)).all()
    assert (at(within, 0.0, 0.0) == at(without, 0.0, 0.0)).all()


def wall_in_shadow(style):
    """A row of a wall with and without a square's shadow: 25 mm below the middle, x >= 0."""
    blocker = square(20.0, z=30.0)
    rows = []
    with render.open_offscreen((480, 480)) as surface:
        for shadows in (True, False):
            drawn_style = replace(style, shadows=shadows)
            frame = draw_image(surface, joined(square(), blocker), drawn_style)
            half_height = 250.0 * np.tan(np.radians(12.5))
            row = int(240.0 * (1.0 + 25.0 / half_height))
            right = int(240.0 * (1.0 + 49.0 / half_height))
            rows.append(frame[row, 240:right])
    return rows[0], rows[1]


def test_shadows_have_soft_edges():
    """From shadow to light the wall brightens steadily, on a head within 2 to 6 mm."""
    within, without = wall_in_shadow(replace(PLAIN_STYLE, albedo=render.CLAY))
    lightness = within.sum(axis=1) / without.sum(axis=1)
    darkest = int(lightness.argmin())
    edge = lightness[darkest:]
    assert edge[-1] > 0.99
    assert edge[0] < 0.75
    assert (np.diff(edge) > -0.01).all()
    assert np.diff(edge).max() < 0.1
    share = (edge - edge[0]) / (edge[-1] - edge[0])
    pixel = 2.0 * 250.0 * np.tan(np.radians(12.5)) / 480.0
    on_a_head = pixel / facing().scene_radius * 150.0  # [mm]
    assert 2.0 < np.count_nonzero((share > 0.02) & (share < 0.98)) * on_a_head < 6.0


@pytest.mark.parametrize("shading", render.Shading)
def test_convex_things_do_not_shadow_themselves(surface, shading):
    """On a coarse sphere, shadows change almost nothing, without stripes at the terminator."""
    style = replace(PLAIN_STYLE, shading=shading)
    without = draw_image(surface, sphere(2), style)
    within = draw_image(surface, sphere(2), replace(style, shadows=True))
    assert np.abs(within - without).max() < 25
    assert np.abs(within - without).mean() < 0.7


@pytest.mark.parametrize("shading", [render.Shading.GOURAUD, render.Shading.PIXEL])
def test_few_triangles_with_round_normals_have_no_stripes(surface, shading):
    """A square grazed by the key light has no stripes.

    Its shading normals face 35 degrees more toward the light than its plane. The side of a nose of
    few triangles is similar, and had stripes when the bias was too small.
    """
    toward_key = np.array([-0.53, 0.63, 0.57])
    toward_key /= np.linalg.norm(toward_key)
    beside = np.array([0.0, 0.0, 1.0]) - toward_key[2] * toward_key
    beside /= np.linalg.norm(beside)
    grazed = 0.15 * toward_key + np.sqrt(1.0 - 0.15**2) * beside
    angle = np.arccos(0.15) - np.radians(35.0)
    round_normal = np.cos(angle) * toward_key + np.sin(angle) * beside
    right = np.cross(toward_key, beside)
    flat = square(25.0)
    corners = flat.positions[:, :1] * right + flat.positions[:, 1:2] * np.cross(grazed, right)
    shape = Shape(corners, np.tile(round_normal, (len(corners), 1)), flat.triangles)
    style = replace(PLAIN_STYLE, albedo=render.CLAY, shading=shading)
    without = draw_image(surface, shape, style)
    within = draw_image(surface, shape, replace(style, shadows=True))
    drawn = np.abs(without - draw_image(surface, square(0.01), style)).max(axis=2) > 8.0
    assert np.count_nonzero(drawn) > 1000
    inside = drawn & np.roll(drawn, 4, 0) & np.roll(drawn, -4, 0)
    inside &= np.roll(drawn, 4, 1) & np.roll(drawn, -4, 1)
    assert np.abs(within - without)[inside].max() < 3


@pytest.mark.parametrize("shadows", [True, False])
def test_hair_throws_shadows_on_a_mesh_but_not_on_itself(renderer, shadows):
    """A ball of hair shadows the wall behind it, at the lower right, if shadows are on.

    The ball does not shadow itself: hair slightly nearer to the light casts no shadow.
    """
    style = replace(PLAIN_STYLE, albedo=render.CLAY, shadows=shadows)
    wall = lent(renderer, square())
    before_wall = np.eye(4)
    before_wall[2, 3] = 30.0
    frames = []
    for is_cast in (True, False):
        hair = render.PlacedPart.on_bone(
            HairyBall(), {"cranium": before_wall}, throws_shadow=is_cast
        )
        frames.append(draw(renderer, wall, style, parts=[hair]))
    within, without = frames
    is_darker = at(within, 30.0, -33.0).sum() < 0.8 * at(without, 30.0, -33.0).sum()
    assert is_darker == shadows
    assert np.abs(at(within, -4.0, 4.0) - at(without, -4.0, 4.0)).max() < 12


@dataclass(frozen=True, eq=False)
class HairyBall(Ball):
    """A ball whose strands stand up and lean slightly."""

    @property
    def striation(self):
        """Across and along [mm], direction from root to tip, density and fray, shape (n, 7)."""
        normals = self.normals.astype(np.float64)
        way = 0.5 * normals - [0.0, 1.0, 0.0] + normals[:, 1:2] * normals
        fixed = np.tile([1.0, 0.0], (len(way), 1))
        return np.hstack([self.vertices[:, :2], way, fixed]).astype(np.float32)
