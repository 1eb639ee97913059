"""What is given back to OpenGL: a renderer that nobody holds any more leaves nothing behind."""

import weakref
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import moderngl
import numpy as np
import pytest

from risorius import render

from .scenes import PLAIN, STILL, Ball, facing, fresh_frame, sphere

KINDS = ("program", "buffer", "texture", "depth_texture", "renderbuffer", "framebuffer")
KINDS += ("vertex_array", "simple_framebuffer", "depth_renderbuffer", "sampler")


def counting(monkeypatch: pytest.MonkeyPatch) -> Callable[[], Counter[str]]:
    """What says how many objects of each kind were made from now on and not given back."""
    made: list[weakref.ref[Any]] = []

    def noting(make: Callable[..., Any]) -> Callable[..., Any]:
        def noted(*arguments: Any, **options: Any) -> Any:
            found = make(*arguments, **options)
            made.append(weakref.ref(found))
            return found

        return noted

    for name in KINDS:
        monkeypatch.setattr(moderngl.Context, name, noting(getattr(moderngl.Context, name)))

    def left() -> Counter[str]:
        held = [each for each in (seen() for seen in made) if each is not None]
        return Counter(
            type(each).__name__
            for each in held
            if not isinstance(each.mglo, moderngl.InvalidObject)
        )

    return left


def draw_all(surface: render.Surface) -> np.ndarray:
    """A picture that needs every program and buffer; nobody holds anything after it."""
    renderer = render.Renderer(surface)
    shape, camera = sphere(), facing()
    stream = renderer.lend_stream(len(shape.positions), len(shape.triangles), 8)
    stream.vertices[:, :3], stream.vertices[:, 3:6] = shape.positions, shape.normals
    stream.triangles[:] = shape.triangles
    amounts = np.linspace(0.0, 1.0, 2 * len(shape.positions), dtype=np.float32).reshape(-1, 2)
    stream.upload(len(shape.positions), len(shape.triangles), amounts)
    texture = render.Texture(renderer.surface, np.full((8, 8, 3), 200, np.uint8))
    bumps = render.BumpMap(renderer.surface, np.full((8, 8, 4), 128, np.uint8), 1.0)
    values = np.arange(len(shape.triangles), dtype=np.uint8)
    styles = [
        replace(PLAIN, shadows=True),
        replace(PLAIN, wireframe=True, colour_by=render.ColourBy.SPLITS),
    ]
    for style in styles:
        with fresh_frame(renderer, style):
            renderer.draw_mesh(
                stream, renderer.view(camera), style, values=values, texture=texture, bumps=bumps
            )
            renderer.draw_parts([Ball()], STILL, renderer.view(camera), style)
            renderer.draw_lines(
                render.Lines([shape.positions[:5]], (1.0, 0.0, 0.0)), renderer.view(camera)
            )
    frame = surface.read()
    return frame


@pytest.mark.parametrize("samples", [0, 4])
def test_a_lost_renderer_leaves_nothing(samples: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten renderers one after the other: the same image, and not one object is left."""
    with render.open_offscreen((96, 96), samples=samples) as surface:
        count = counting(monkeypatch)
        images = [draw_all(surface) for _ in range(10)]
        assert surface.gl.objects  # let go, and waiting to be given back
        surface.begin()
        assert count() == {} and not surface.gl.objects
        assert surface.gl.error == "GL_NO_ERROR"
    assert all((image == images[0]).all() for image in images)
