"""Offscreen frames: size, orientation, samples, opening and closing."""

import numpy as np
import pytest

from risorius import render

from .scenes import Shape, draw_image, drawn, needs_samples, sphere, square


def upper_square():
    """A square in the upper half of the view."""
    shape = square(20.0)
    return Shape(shape.positions + np.array((0, 30, 0), np.float32), shape.normals, shape.triangles)


@pytest.mark.parametrize("samples", [0, 4])
def test_read_gives_the_top_row_first(samples):
    """The upper part of the scene is in the first rows of the array."""
    with render.open_offscreen((64, 48), samples=samples) as surface:
        frame = draw_image(surface, upper_square())
    assert frame.shape == (48, 64, 3)
    assert drawn(frame)[:24].any()
    assert not drawn(frame)[24:].any()


def test_read_is_a_new_array_each_time(surface):
    """An array that was read does not change with the next frame."""
    draw_image(surface, sphere())
    first = surface.read()
    kept = first.copy()
    surface.begin()
    surface.end()
    assert first.dtype == np.uint8
    assert (first == kept).all()
    assert (surface.read() == 0).all()


def test_samples_smooth_edges():
    """With samples, border pixels mix skin and background; without samples, none does."""
    shape = sphere(3)
    levels = {}
    for samples in (0, 4):
        with render.open_offscreen((96, 96), samples=samples) as surface:
            frame = draw_image(surface, shape)
            if samples > 0:
                needs_samples(surface)
        red = frame[:, :, 0]
        levels[samples] = int(((red > 235) & (red < 254)).sum())
    assert levels[4] > levels[0] + 20


def test_bad_arguments():
    """Impossible sizes and numbers of samples are refused."""
    with pytest.raises(ValueError, match=r"size is \(0, 10\); it must be \(width, height\)"):
        render.open_offscreen((0, 10))
    with pytest.raises(ValueError, match=r"samples is -1; it must be 0 \(none\)"):
        render.open_offscreen((10, 10), samples=-1)
    with pytest.raises(render.GLError, match=r"100000 x 10 pixels: .* Cure: ask for a smaller"):
        render.open_offscreen((100_000, 10))


def test_a_closed_surface_reports_it():
    """Drawing after close is an error; a second close is not."""
    surface = render.open_offscreen((8, 8))
    surface.close()
    surface.close()
    with pytest.raises(render.GLError, match=r"this surface is closed\. Cure: open a new one"):
        surface.begin()


def test_two_surfaces_do_not_mix(surface):
    """Frames drawn in turns on two surfaces stay separate."""
    with render.open_offscreen((40, 30)) as other:
        for _ in range(2):
            large = draw_image(surface, sphere())
            small = draw_image(other, square())
        assert large.shape == (96, 96, 3)
        assert small.shape == (30, 40, 3)
        assert (surface.read() == large).all()
        assert (other.read() == small).all()


def test_begin_resets_the_state_of_opengl(surface):
    """Every frame resets depth test, culling, blending, scissor and masks that a panel has set."""
    expected = draw_image(surface, sphere())
    gl = surface.gl
    gl.disable(gl.DEPTH_TEST)
    gl.enable(gl.BLEND | gl.CULL_FACE)
    gl.blend_func = gl.ZERO, gl.ONE
    gl.depth_func = ">"
    gl.scissor = (3, 3, 5, 5)
    gl.fbo.depth_mask = False
    assert (draw_image(surface, sphere()) == expected).all()
