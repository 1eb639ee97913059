"""Smooth outlines where a pixel has one sample."""

from dataclasses import replace

import numpy as np
import pytest

from risorius import render
from risorius.render.camera import CameraView
from risorius.render.lines import fringes

from .scenes import PLAIN, facing, fresh_frame, joined, lent, sphere, square

RADIUS = 45.0


def ball(
    samples: int, *, is_smoothed: bool, style: render.Style = PLAIN, radius: float = RADIUS
) -> np.ndarray:
    """A smaller ball in front of a larger one, shape (H, W, 3)."""
    small = sphere(4, radius / 3.0)
    small.positions[:] += np.float32((10.0, 5.0, 60.0))
    shape = joined(sphere(5, radius), small)
    with render.open_offscreen((128, 128), samples=samples) as surface:
        renderer = render.Renderer(surface)
        stream = lent(renderer, shape)
        values = np.zeros(len(shape.triangles), np.uint8)
        with fresh_frame(renderer, style):
            renderer.draw_mesh(stream, renderer.view(facing()), style, values=values)
            if is_smoothed:
                renderer.draw_outline(stream, renderer.view(facing()), style)
        assert surface.gl.error == "GL_NO_ERROR"
        return surface.read().astype(np.int32)


@pytest.mark.parametrize("shading", [render.Shading.PIXEL, render.Shading.GOURAUD])
def test_edges_are_as_smooth_as_with_samples(shading: render.Shading) -> None:
    """Before the background and before other skin; all but the edges is as it was.

    Fringes lie outside: edges are those of balls that are larger by half a pixel.
    """
    style = replace(PLAIN, shading=shading)
    rough, smooth = (ball(0, is_smoothed=on, style=style) for on in (False, True))
    fine = ball(16, is_smoothed=False, style=style)
    pixels = 0.5 * (fine < 250).any(axis=2).any(axis=0).sum()  # the radius
    larger = ball(16, is_smoothed=False, style=style, radius=RADIUS * (1.0 + 0.5 / pixels))
    off = [np.square(rough - fine).mean(), np.square(smooth - larger).mean()]
    assert off[1] < 0.35 * off[0]
    changed = (smooth != rough).any(axis=2)
    assert 100 < changed.sum() < 2.0 * np.pi * (4.0 / 3.0) * pixels * 1.6


@pytest.mark.parametrize(
    "changes",
    [
        {"shading": render.Shading.FLAT},
        {"wireframe": True},
        {"colour_by": render.ColourBy.SPLITS},
    ],
)
def test_what_cannot_be_smoothed_stays(changes: dict[str, object]) -> None:
    """Flat shading, wireframes and colours by values are drawn as without."""
    style = replace(PLAIN, **changes)
    rough, smooth = (ball(0, is_smoothed=on, style=style) for on in (False, True))
    assert (rough == smooth).all()


def test_what_lies_behind_the_eye_has_no_fringes() -> None:
    """A camera in the middle of the mesh: nothing fails, and nothing is not a number."""
    shape, camera = sphere(3), facing()
    camera.distance = 10.0
    rows = fringes(
        np.hstack([shape.positions, shape.normals]),
        shape.triangles,
        CameraView(camera, (0, 0, 64, 64)),
    )
    assert np.isfinite(rows).all()


def test_skin_fades_toward_a_plane() -> None:
    """All of it at 1, half where the way is half done, nothing at 0; also its smoothed outline."""
    with render.open_offscreen((96, 96), samples=0) as surface:
        renderer = render.Renderer(surface)
        stream = lent(renderer, square(30.0))
        pictures = []
        for fade in (None, (0.0, 1.0 / 60.0, 0.0, 0.5)):  # from the lower edge to the upper one
            with fresh_frame(renderer):
                renderer.draw_mesh(stream, renderer.view(facing()), PLAIN, fade=fade)
                renderer.draw_outline(stream, renderer.view(facing()), PLAIN, fade=fade)
            pictures.append(255.0 - surface.read().astype(np.float64).mean(axis=2))
    whole, faded = pictures
    rows = np.flatnonzero(whole[:, 48] > 1.0)
    top, middle, bottom = (faded[rows, 48] / whole[rows, 48])[[1, len(rows) // 2, -2]]
    assert top > 0.98 and abs(middle - 0.5) < 0.05 and bottom < 0.02
