"""Memory of OpenGL: objects without references are released."""

import weakref
from collections import Counter, namedtuple
from dataclasses import replace

import moderngl
import numpy as np
import pytest

from risorius import render
from tests.memory import held_memory

from .scenes import PLAIN_STYLE, Ball, draw, sphere, still

KINDS = ("program", "buffer", "texture", "depth_texture", "renderbuffer", "framebuffer")
KINDS += ("vertex_array", "simple_framebuffer", "depth_renderbuffer", "sampler")


def counting(monkeypatch):
    """A function that counts new objects of each kind that were not released."""
    made = []

    def noting(make):
        def noted(*arguments, **options):
            found = make(*arguments, **options)
            made.append(weakref.ref(found))
            return found

        return noted

    for name in KINDS:
        monkeypatch.setattr(moderngl.Context, name, noting(getattr(moderngl.Context, name)))

    def left():
        found = [reference() for reference in made]
        return Counter(
            type(each).__name__
            for each in found
            if each is not None and not isinstance(each.mglo, moderngl.InvalidObject)
        )

    return left


def draw_all(surface):
    """Draw a picture with every program and buffer, and keep no references."""
    renderer = render.Renderer(surface)
    shape = sphere()
    stream = renderer.lend_stream(len(shape.positions), len(shape.triangles), 16)
    stream.vertices[:, :3] = shape.positions
    stream.vertices[:, 3:6] = shape.normals
    stream.triangles[:] = shape.triangles
    stream.vertices[:, 8:10] = np.linspace(0.0, 1.0, 2 * len(shape.positions)).reshape(-1, 2)
    stream.upload(len(shape.positions), len(shape.triangles), has_bumps=True)
    texture = render.SkinTexture(renderer.surface, np.full((8, 8, 3), 200, np.uint8))
    bumps = render.BumpMap(renderer.surface, np.full((8, 8, 4), 128, np.uint8), 1.0)
    values = np.arange(len(shape.triangles), dtype=np.uint8)
    styles = [
        replace(PLAIN_STYLE, shadows=True),
        replace(PLAIN_STYLE, wireframe=True, colour_by=render.ColourBy.SPLITS),
    ]
    for style in styles:
        skin = render.Skin(stream, render.SkinMaps(texture, bumps), values=values)
        lines = render.Lines([shape.positions[:5]], (1.0, 0.0, 0.0))
        image = draw(renderer, skin, style, parts=still(Ball()), lines=[lines])
    return image


@pytest.mark.parametrize("samples", [0, 4])
def test_a_lost_renderer_leaves_nothing(samples, monkeypatch):
    """Ten renderers, one after the other, give the same image, and no object remains."""
    with render.open_offscreen((96, 96), samples=samples) as surface:
        count = counting(monkeypatch)
        images = [draw_all(surface) for _ in range(10)]
        assert surface.gl.objects  # unreferenced, waiting for release
        surface.begin()
        assert count() == {}
        assert not surface.gl.objects
        assert surface.gl.error == "GL_NO_ERROR"
    assert all((image == images[0]).all() for image in images)


def test_a_lost_part_leaves_nothing(monkeypatch):
    """A renderer that draws several persons keeps only the parts of the last one."""
    left = list[Counter[str]]()
    style = replace(PLAIN_STYLE, shadows=True)
    with render.open_offscreen((96, 96), samples=4) as surface:
        renderer = render.Renderer(surface)
        count = counting(monkeypatch)
        for _ in range(6):
            parts = still(Ball(), Ball(bone="eye_left"))
            for _ in range(2):
                draw(renderer, style=style, parts=parts)
            del parts
            surface.begin()
            left.append(count())
    assert left[0]["Buffer"] == 4
    assert left[1:] == left[:-1]


def test_a_part_without_weak_references_is_drawn():
    """A named tuple, which has no weak references, is drawn and kept like any other part."""
    ball = Ball()
    names = ("name", "vertices", "normals", "faces", "colours", "bone", "shine")
    names += ("is_enclosed", "strand_radius", "striation")
    part_type = namedtuple("part_type", names)
    kept = part_type(*(getattr(ball, name) for name in names))
    images = []
    with render.open_offscreen((96, 96)) as surface:
        renderer = render.Renderer(surface)
        for part in (ball, kept):
            images.append(draw(renderer, parts=still(part)))
    assert (images[0] == images[1]).all()
    assert len(np.unique(images[0])) > 10


def test_a_closed_frame_hands_its_context_on(monkeypatch):
    """The next frame reuses a closed frame's context.

    It does not after an error, or if another version of OpenGL is requested.
    """
    with render.open_offscreen((96, 96)) as first, render.open_offscreen((64, 48)) as beside:
        assert first.gl is not beside.gl
    with render.open_offscreen((64, 48), samples=0) as second:
        image = draw_all(second)
    with pytest.raises(ValueError, match="midway"), render.open_offscreen((64, 48)) as third:
        raise ValueError("midway")
    with render.open_offscreen((64, 48), samples=0) as fourth:
        assert (draw_all(fourth) == image).all()
    monkeypatch.setenv("GLCONTEXT_GLVERSION", "330")
    with render.open_offscreen((64, 48)) as fifth:
        pass
    assert second.gl in (first.gl, beside.gl)
    assert third.gl is second.gl
    assert fourth.gl is not third.gl
    assert fifth.gl is not fourth.gl


@pytest.mark.slow
def test_frames_that_are_opened_and_closed_take_no_memory():
    """Two hundred frames, opened, drawn and closed, leave less than 3 MB."""

    def draw_frames(number):
        for _ in range(number):
            with render.open_offscreen((96, 96)) as surface:
                draw_all(surface)

    draw_frames(30)
    before = held_memory()
    draw_frames(200)
    assert held_memory() - before < 3.0
