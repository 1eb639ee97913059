"""Viewports and backgrounds: each touches its own pixels only."""

import pytest

from risorius import render

from .scenes import PLAIN, STILL, Ball, facing, fresh_frame, lent, sphere, square


@pytest.mark.parametrize("samples", [0, 4])
def test_viewports_are_apart(samples: int) -> None:
    """Drawing into the left half leaves every pixel of the right half as it was."""
    left, right, whole = (0, 0, 60, 50), (60, 0, 60, 50), (0, 0, 120, 50)
    with render.open_offscreen((120, 50), samples=samples) as surface:
        renderer = render.Renderer(surface)
        stream = lent(renderer, sphere())

        def draw(viewport: render.Rectangle, style: render.Style, zoom: float) -> None:
            camera = facing()
            camera.zoom(zoom)
            renderer.draw_background(style, viewport)
            renderer.draw_mesh(stream, renderer.view(camera, viewport), style)
            renderer.draw_parts([Ball()], STILL, renderer.view(camera, viewport), style)
            renderer.draw_lines(
                render.Lines([stream.vertices[:9, :3]], (1, 0, 0)), renderer.view(camera, viewport)
            )

        surface.begin()
        draw(whole, render.Style(wireframe=True), 4.0)
        surface.end()
        before = surface.read()
        surface.begin()
        draw(whole, render.Style(wireframe=True), 4.0)
        draw(left, render.Style(background=render.DARK), 2.0)
        surface.end()
        after = surface.read()
        assert (after[:, 60:] == before[:, 60:]).all()
        assert (after[:, :60] != before[:, :60]).any(axis=2).mean() > 0.9

        surface.begin()
        draw(left, PLAIN, 1.0)
        draw(right, PLAIN, 1.0)
        surface.end()
        pair = surface.read()
        assert (pair[:, :60] == pair[:, 60:]).mean() > 0.99


def test_background_covers_what_was_drawn(surface: render.Surface) -> None:
    """An inset starts on an empty viewport: neither colours nor depth of before are left."""
    renderer = render.Renderer(surface)
    near, far = lent(renderer, square(z=40.0)), lent(renderer, square(z=-40.0))
    with fresh_frame(renderer):
        renderer.draw_mesh(near, renderer.view(facing()), PLAIN)
        renderer.draw_background(PLAIN, (20, 20, 50, 50))
        renderer.draw_mesh(far, renderer.view(facing(), (20, 20, 50, 50)), PLAIN)
    inset = surface.read()[-70:-20, 20:70]
    assert (inset[:3] >= 254).all() and (inset[20:30, 20:30] < 250).any(axis=2).all()


def test_viewport_must_have_pixels(surface: render.Surface) -> None:
    """A viewport without extent is refused."""
    with pytest.raises(ValueError, match=r"viewport is \(0, 0, 0, 10\); it must be"):
        render.Renderer(surface).draw_background(PLAIN, (0, 0, 0, 10))
