"""Streams (buffers shared with OpenGL): capacities, columns, reuse."""

import numpy as np
import pytest

from risorius import render

from .scenes import draw, draw_image, lent, sphere, square


def test_lent_arrays_fit_the_contract(surface):
    """The caller gets C-contiguous float32, uint32 and int32 arrays of the requested size."""
    stream = render.Renderer(surface).lend_stream(100, 50, 8)
    assert stream.vertices.shape == (100, 8)
    assert stream.vertices.dtype == np.float32
    assert stream.triangles.shape == (50, 3)
    assert stream.triangles.dtype == np.uint32
    assert stream.source.shape == (50,)
    assert stream.source.dtype == np.int32
    assert stream.vertices.flags.c_contiguous
    assert stream.vertices.flags.writeable


def test_eight_columns_draw_the_same(surface, renderer):
    """A stream of eight columns draws the same: texture coordinates are not read as positions."""
    expected = draw_image(surface, sphere())
    stream = lent(renderer, sphere(), columns=8)
    stream.vertices[:, 6:] = 1e6
    stream.upload(len(stream.vertices), len(stream.triangles))
    assert (draw(renderer, stream) == expected).all()


def test_only_the_used_part_is_drawn(surface, renderer):
    """Rows beyond the counts, filled at random, are not drawn."""
    expected = draw_image(surface, square())
    stream = renderer.lend_stream(1000, 1000, 6)
    stream.vertices[:] = np.nan
    stream.triangles[:] = 999
    shape = square()
    stream.vertices[:4, :3] = shape.positions
    stream.vertices[:4, 3:] = shape.normals
    stream.triangles[:2] = shape.triangles
    stream.upload(4, 2)
    assert (draw(renderer, stream) == expected).all()


def test_hundred_frames_use_the_same_buffers(renderer):
    """While a mesh changes, arrays, OpenGL's buffers and the process keep their size."""
    resource = pytest.importorskip("resource", reason="this system does not report memory in use")
    shape = sphere(4)
    stream = lent(renderer, shape)
    style = render.Style(wireframe=True, colour_by=render.ColourBy.SPLITS)
    lines = render.Lines([shape.positions[:50]], (1.0, 0.0, 0.0))
    buffers = stream.vertex_buffer, stream.index_buffer
    sizes = [buffer.size for buffer in buffers]
    peaks = []
    for frame in range(120):
        count = len(shape.triangles) - 5 * frame
        stream.vertices[:, :3] = shape.positions * np.float32(1.0 + 0.001 * frame)
        stream.upload(len(shape.positions), count)
        skin = render.Skin(stream, values=np.zeros(count, np.uint8))
        draw(renderer, skin, style, lines=[lines])
        peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    assert (stream.vertex_buffer, stream.index_buffer) == buffers
    assert [buffer.size for buffer in buffers] == sizes
    assert peaks[-1] < 1.03 * peaks[20]


def test_a_frame_takes_no_more_memory_than_it_fills(renderer):
    """Buffers have the size of the mesh, not of the worst case, and grow with the mesh."""
    stream = renderer.lend_stream(100_000, 100_000, 8)
    for count in (10, 5_000, 10):
        stream.upload(count, count)
        assert 32 * count <= stream.vertex_buffer.size < 64 * count
        assert 12 * count <= stream.index_buffer.size < 24 * count


def test_mesh_without_triangles_draws_nothing(renderer):
    """An empty frame of a stream is not an error."""
    stream = lent(renderer, square())
    stream.upload(0, 0)
    assert (draw(renderer, stream, render.Style(background=render.WHITE)) >= 254).all()


def test_positions_that_are_not_finite_are_drawn(renderer):
    """A frame with positions that are not finite is drawn, as after a failed simulation."""
    stream = lent(renderer, sphere())
    stream.vertices[3, 0] = np.inf
    stream.vertices[4, 1] = np.nan
    stream.upload(len(stream.vertices), len(stream.triangles))
    assert draw(renderer, stream, render.Style(wireframe=True)).shape == (96, 96, 3)


@pytest.mark.parametrize(
    ("counts", "message"),
    [
        ((5, 2), "vertex_count is 5; this stream holds 0 to 4"),
        ((4, 3), "triangle_count is 3; this stream holds 0 to 2"),
        ((-1, 2), "vertex_count is -1"),
    ],
)
def test_upload_beyond_capacity(surface, counts, message):
    """Counts beyond the capacity are refused."""
    stream = lent(render.Renderer(surface), square())
    with pytest.raises(ValueError, match=message):
        stream.upload(*counts)


def test_bad_stream_sizes(renderer):
    """Streams without room, or with an unknown layout, are refused."""
    with pytest.raises(ValueError, match=r"columns is 7; it must be 6 \(position, normal\), 8 "):
        renderer.lend_stream(3, 1, 7)
    with pytest.raises(ValueError, match="a stream of 0 vertices and 1 triangles"):
        renderer.lend_stream(0, 1, 6)
