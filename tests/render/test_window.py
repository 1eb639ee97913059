"""Windows: the interface and pictures of offscreen frames. They need a screen, or Xvfb."""

import ctypes
import time

import numpy as np
import pytest

from risorius import render

from .scenes import draw_image, facing, needs_samples, sphere

pytestmark = pytest.mark.window


def needs_one_driver(window, offscreen):
    """Skip a comparison if a card draws offscreen, but software draws in a window of Xvfb."""
    drivers = [surface.gl.info["GL_RENDERER"] for surface in (window, offscreen)]
    if drivers[0] != drivers[1]:
        pytest.skip(f"windows are drawn by {drivers[0]}, offscreen frames by {drivers[1]}")


def test_same_picture(window):
    """A window shows the picture of an offscreen frame, which can be read after it was shown."""
    style = render.Style(wireframe=True)
    shown = draw_image(window, sphere(), style)
    with render.open_offscreen(window.size) as offscreen:
        needs_one_driver(window, offscreen)
        expected = draw_image(offscreen, sphere(), style)
    assert np.abs(shown - expected).mean() < 0.5


def test_window_that_is_resized(window):
    """The frame follows the window's size; no pixels of the old size remain."""
    import glfw

    draw_image(window, sphere())
    glfw.set_window_size(window.handle, 130, 70)
    end = time.monotonic() + 60.0
    while window.frame_size != (130, 70):
        assert time.monotonic() < end
        glfw.wait_events_timeout(0.01)
    frame = draw_image(window, sphere())
    assert window.size == tuple(glfw.get_framebuffer_size(window.handle)) == (130, 70)
    assert frame.shape == (70, 130, 3)
    assert (frame[:, :3] >= 254).all()
    assert window.gl.error == "GL_NO_ERROR"


def test_a_window_fits_the_screen(window):
    """A visible window is no larger than the free area of the screen."""
    import glfw

    room = glfw.get_monitor_workarea(glfw.get_primary_monitor())[2:]
    with render.open_window((room[0] + 100, 80), "wide") as wide:
        assert wide.size == (room[0], 80)


def test_closing(window):
    """A close request can be read and set, and a closed window reports that it is closed."""
    assert not window.should_close
    window.should_close = True
    assert window.should_close
    window.close()
    with pytest.raises(render.GLError, match="this surface is closed"):
        window.begin()


def test_hidden_window_can_be_read(window):
    """A hidden window gives the same frame as a visible one."""
    expected = draw_image(window, sphere())
    with render.open_window((96, 96), "hidden", visible=False) as hidden:
        assert (draw_image(hidden, sphere()) == expected).all()


def test_window_and_offscreen_take_turns(window):
    """Frames can be drawn offscreen while a window is open."""
    first = draw_image(window, sphere())
    with render.open_offscreen((40, 40)) as offscreen:
        for _ in range(2):
            draw_image(offscreen, sphere())
            assert (draw_image(window, sphere()) == first).all()
    assert (draw_image(window, sphere()) == first).all()
    assert window.gl.error == "GL_NO_ERROR"


def test_probe_finds_the_window(window):
    """The probe reports a window exactly if one can be opened."""
    finding = render.probe()[1]
    assert finding.name == "window"
    assert finding.is_ok
    assert finding.renderer


def test_a_coarser_scene_fills_the_window(window):
    """A scene with fewer pixels and samples is enlarged; panels keep the full resolution.

    Smoothing spreads up to two pixels of the scene sideways.
    """
    renderer = render.Renderer(window)
    images = []
    for detail in (render.Detail(), render.Detail(samples=0, scale=0.5)):
        window.detail = detail
        view = render.CameraView(facing(), (0, 0, 48, 96))
        renderer.draw(render.Frame(view, render.Style()))
        window.end()
        images.append(window.read().astype(int))
        assert window.read_scene().shape[:2] == (96 * detail.scale, 96 * detail.scale)
    assert images[0].shape == images[1].shape == (96, 96, 3)
    assert np.abs(images[0] - images[1])[:, :44].max() < 4
    assert not images[1][:, 52:].any()


@pytest.mark.parametrize("scale", [0.5, 0.25])
def test_a_coarser_scene_has_no_dark_borders(window, scale):
    """Beside panels an enlarged scene is as bright as inside; black lines were there."""
    renderer = render.Renderer(window)
    window.detail = render.Detail(samples=0, scale=scale)
    window.area = (16, 24, 48, 40)
    white = render.Background((1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
    style = render.Style(background=white)
    renderer.draw(render.Frame(render.CameraView(facing(), window.area), style))
    window.end()
    shown = window.read()
    assert shown[32:72, 16:64].min() > 250
    assert not shown[:, :16].any() and not shown[72:].any()


def test_the_scene_can_be_shown_without_panels(window):
    """A second resolve shows the scene without the panel that was drawn over it."""
    renderer = render.Renderer(window)
    renderer.draw(render.Frame(render.CameraView(facing()), render.Style()))
    window.end()
    before = window.read()
    window.resolve()
    window.gl.fbo.clear(1.0, 0.0, 0.0)
    assert (window.read() != before).any()
    window.resolve()
    assert np.array_equal(window.read(), before)


def test_single_samples_have_smooth_edges(window):
    """Without samples, smoothing removes some of the steps that four samples would remove."""
    needs_samples(window)
    fine = draw_image(window, sphere())
    window.detail = render.Detail(samples=0)
    smoothed = draw_image(window, sphere())
    with render.open_offscreen(window.size, samples=0) as offscreen:
        needs_one_driver(window, offscreen)
        jagged = draw_image(offscreen, sphere())
    before, after = (np.abs(each - fine).max(axis=2) > 40 for each in (jagged, smoothed))
    assert before.sum() > 50 and after.sum() < 0.8 * before.sum()  # 0.7 with software


def test_smoothed_edges_leave_small_discs_round(window):
    """With smoothing, pixels of a disc as wide as pupils are near those with four samples."""
    needs_samples(window)
    pupil = sphere(4, radius=7.0)
    fine = draw_image(window, pupil)
    window.detail = render.Detail(samples=0)
    assert np.abs(draw_image(window, pupil) - fine).max() < 75  # 51 on software; more if square


def test_software_keeps_pictures_in_the_byte_order_of_windows(window):
    """On software OpenGL, scene, panels and stored background hold blue, green, red, as windows do.

    Otherwise each copy into the window would take several times as long, with the same colours.
    """
    import glfw

    if not window.is_software:
        pytest.skip("a card draws the window")
    draw_image(window, sphere())
    address = ctypes.cast(glfw.get_proc_address("glGetIntegerv"), ctypes.c_void_p).value
    query = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.POINTER(ctypes.c_int))(address)
    bytes_of_a_read = 0x8B9B  # GL_IMPLEMENTATION_COLOR_READ_FORMAT: the order in memory
    blue_green_red_alpha = 0x80E1
    for size in ((64, 48), (80, 60)):
        texture = window.target.new_texture(size)
        for frame in (window.target.frame, window.gl.framebuffer([texture])):
            frame.use()
            order = ctypes.c_int()
            query(bytes_of_a_read, ctypes.byref(order))
            assert order.value == blue_green_red_alpha
    assert window.gl.error == "GL_NO_ERROR"
