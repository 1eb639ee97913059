"""Stored pictures: the look changes only with approval. For software drivers, which agree closely.

`RISORIUS_STORE_PICTURES=1 python -m pytest tests/render/test_look.py` stores new pictures; look at
them before you commit them.
"""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from risorius import render

from .scenes import LIGHT_SKIN, Ball, draw, joined, lent, sphere, square

STORED_FOLDER = Path(__file__).parent / "pictures"
SIZE = (160, 120)

STYLES = {
    "pixel": render.Style(),
    "gouraud": render.Style(shading=render.Shading.GOURAUD, albedo=render.CLAY),
    "flat": render.Style(shading=render.Shading.FLAT, background=render.DARK),
    "splits": render.Style(wireframe=True, colour_by=render.ColourBy.SPLITS),
}


def scene(surface, style):
    """The picture of a sphere before a wall, a wet ball beside it, and a line through both."""
    renderer = render.Renderer(surface)
    shape = joined(square(70.0, z=-45.0), sphere(2, 40.0))
    stream = lent(renderer, shape)
    camera = render.OrbitCamera.framing(shape.positions, view="three-quarter-right")
    ball = np.eye(4)
    ball[:3, 3] = (55.0, -30.0, 10.0)
    values = (np.arange(len(shape.triangles)) % 7).astype(np.uint8)
    skin = render.Skin(stream, values=values)
    parts = [render.PlacedPart.on_bone(Ball(shine=0.9), {"cranium": ball})]
    line = render.Lines([np.array([(-60.0, 40, 20), (60, -40, -20)])], (0.75, 0.1, 0.1))
    draw(renderer, skin, style, parts=parts, lines=[line], camera=camera)
    return surface.read()


@pytest.mark.parametrize("name", STYLES)
def test_picture_is_as_stored(name, tmp_path):
    """The scene looks as in its approved picture."""
    with render.open_offscreen(SIZE) as surface:
        driver = str(surface.gl.info["GL_RENDERER"])
        if "llvmpipe" not in driver:
            pytest.skip(f"the stored pictures are Mesa's (llvmpipe), and this driver is {driver}")
        frame = scene(surface, STYLES[name])
    path = STORED_FOLDER / f"{name}.png"
    if os.environ.get("RISORIUS_STORE_PICTURES"):
        STORED_FOLDER.mkdir(exist_ok=True)
        Image.fromarray(frame).save(path)
    expected = np.asarray(Image.open(path).convert("RGB"))
    difference = np.abs(frame.astype(int) - expected.astype(int)).max(axis=2)
    if difference.mean() > 1.0 or np.percentile(difference, 99.0) > 24:
        Image.fromarray(np.hstack([expected, frame])).save(tmp_path / f"{name}.png")
        pytest.fail(
            f"{name}: mean difference {difference.mean():.2f} of 255; stored and new picture are "
            f"side by side in {tmp_path / f'{name}.png'}"
        )


def test_stored_pictures_would_notice():
    """A slightly different skin exceeds the tolerance."""
    with render.open_offscreen(SIZE) as surface:
        frame = scene(surface, STYLES["pixel"]).astype(int)
        paler = scene(surface, replace(STYLES["pixel"], albedo=LIGHT_SKIN)).astype(int)
    assert np.abs(frame - paler).max(axis=2).mean() > 3.0
