"""Viewports and backgrounds: each changes its own pixels only."""

import pytest

from risorius import render

from .scenes import PLAIN_STYLE, Ball, facing, lent, sphere, still


@pytest.mark.parametrize("samples", [0, 4])
def test_viewports_are_apart(samples):
    """Two viewports show the same; if one is drawn, every pixel of the other stays empty."""
    left = (0, 0, 60, 50)
    right = (60, 0, 60, 50)
    with render.open_offscreen((120, 50), samples=samples) as surface:
        renderer = render.Renderer(surface)
        stream = lent(renderer, sphere())
        camera = facing()
        camera.zoom(2.0)
        images = []
        for viewports in ((left, right), (left,)):
            skin = render.Skin(stream)
            lines = [render.Lines([stream.vertices[:9, :3]], (1, 0, 0))]
            views = [render.CameraView(camera, viewport) for viewport in viewports]
            renderer.draw(
                *(
                    render.Frame(view, PLAIN_STYLE, skin, still(Ball()), overlays=lines)
                    for view in views
                )
            )
            images.append(surface.read())
    both, alone = images
    assert (both[:, :60] == both[:, 60:]).mean() > 0.99
    assert (alone[:, :60] == both[:, :60]).all()
    assert not alone[:, 60:].any()
    assert (both[:, :60] < 250).any(axis=2).mean() > 0.5


def test_viewport_must_have_pixels(surface):
    """A viewport without extent is refused."""
    with pytest.raises(ValueError, match=r"viewport is \(0, 0, 0, 10\); it must be"):
        view = render.CameraView(facing(), (0, 0, 0, 10))
        render.Renderer(surface).draw(render.Frame(view, PLAIN_STYLE))
