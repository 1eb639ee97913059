"""A frame gives the same picture after any other frame."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from risorius import render
from risorius.render.render_target import RenderTarget

from .scenes import PLAIN_STYLE, STILL_TRANSFORMS, Ball, facing, joined, lent, sphere, square, still
from .test_shadows import HairyBall

HALF_RECTANGLE = (0, 0, 40, 96)
FURROWED_RECTANGLE = (190, 90, 200, 128)


@pytest.fixture(params=[0, 4])
def renderer(request: pytest.FixtureRequest) -> Iterator[render.Renderer]:
    """One renderer for all frames of a test, with one sample per pixel and with four."""
    with render.open_offscreen((96, 96), samples=request.param) as surface:
        yield render.Renderer(surface)


def frames_of(renderer):
    """Frames with all features: shadows, hidden triangles, opened skin, hair, maps, clips."""
    shape = joined(square(70.0, z=-45.0), sphere(2, 30.0))
    stream = lent(renderer, shape, columns=18)
    stream.vertices[:, 8:] = 1.0
    stream.vertices[:, 16] = 0.02 * shape.positions[:, 1] + 0.5
    stream.upload(len(shape.positions), len(shape.triangles), has_bumps=True)
    bumps = render.BumpMap(
        renderer.surface, np.full((8, 8, 4), FURROWED_RECTANGLE, np.uint8), 100.0
    )
    texture = render.SkinTexture(renderer.surface, np.full((8, 8, 3), (200, 90, 30), np.uint8))
    values = np.arange(len(shape.triangles), dtype=np.uint8) % 7
    shaded = replace(PLAIN_STYLE, shadows=True)
    tinted = replace(shaded, colour_by=render.ColourBy.SPLITS, background=render.DARK)
    turned = facing()
    turned.orbit(30.0, 10.0)
    front = render.CameraView(facing())
    aside = render.CameraView(turned)
    away = np.eye(4)
    away[:3, 3] = (30.0, 20.0, 10.0)
    hair = render.PlacedPart.on_bone(HairyBall(), {"cranium": away}, throws_shadow=True)
    bone = render.PlacedPart.on_bone(
        Ball(), STILL_TRANSFORMS, lies_beneath=True, throws_shadow=True
    )
    bare = render.Skin(stream)
    return [
        render.Frame(front, shaded, bare, [hair, *still(Ball(bone="eye_left"))]),
        render.Frame(aside, replace(shaded, opacity=0.4), bare, [bone, hair], (1.0, 0.0, 0.0, 5.0)),
        render.Frame(aside, shaded, render.Skin(stream, render.SkinMaps(texture, bumps))),
        render.Frame(front, tinted, render.Skin(stream, values=values), still(Ball())),
        render.Frame(front, shaded, render.Skin(stream, fading=shape.positions.astype(np.float64))),
        render.Frame(
            render.CameraView(turned, HALF_RECTANGLE, (10, 10, 20, 60)), PLAIN_STYLE, None, [hair]
        ),
    ]


def picture(renderer, *frames):
    """The picture after one call of `draw` with these frames."""
    renderer.draw(*frames)
    return renderer.surface.read()


def test_no_order_of_pictures_matters(renderer):
    """Each frame gives the same picture after any other, after itself, and in a new renderer."""
    frames = frames_of(renderer)
    wanted = [picture(renderer, frame) for frame in frames]
    assert len({image.tobytes() for image in wanted}) == len(frames)
    for first, second in permutations(range(len(frames)), 2):
        for index in (first, second):
            assert np.array_equal(picture(renderer, frames[index]), wanted[index])
    for frame, image in zip(frames, wanted, strict=True):
        assert np.array_equal(picture(render.Renderer(renderer.surface), frame), image)


def test_frames_of_one_picture_are_apart(renderer):
    """Two halves drawn by one call have the same pixels as each half drawn alone."""
    style = replace(PLAIN_STYLE, shadows=True)
    skin = render.Skin(lent(renderer, sphere(2, 30.0)))
    halves = [(0, 0, 48, 96), (48, 0, 48, 96)]
    cameras = [facing(), facing()]
    cameras[1].orbit(40.0)
    left, right = (
        render.Frame(render.CameraView(camera, area), style, skin, still(Ball()))
        for camera, area in zip(cameras, halves, strict=True)
    )
    both = picture(renderer, left, right)
    assert np.array_equal(picture(renderer, right, left), both)
    assert np.array_equal(picture(renderer, left)[:, :48], both[:, :48])
    assert np.array_equal(picture(renderer, right)[:, 48:], both[:, 48:])


def test_reading_numbers_is_no_part_of_an_order(renderer):
    """The numbers (depth, normals and so on) of a frame are the same after any other call."""
    frames = frames_of(renderer)
    alone = [renderer.read(frame) for frame in frames]
    for frame in reversed(frames):
        renderer.draw(frame)
        for each, wanted in zip(frames, alone, strict=True):
            found = renderer.read(each)
            assert all(np.array_equal(a, b) for a, b in zip(found, wanted, strict=True))


def test_a_frame_keeps_camera_and_shapes(renderer):
    """A later motion of the camera, or of a part, does not change the frame."""
    ball = Ball()
    camera = facing()
    moving = Moving(ball)
    frame = render.Frame(render.CameraView(camera), PLAIN_STYLE, None, still(moving))
    before = picture(renderer, frame)
    camera.orbit(30.0)
    camera.zoom(2.0)
    moving.vertices = (0.5 * ball.vertices).astype(np.float32)
    later = render.Frame(render.CameraView(camera), PLAIN_STYLE, None, still(moving))
    assert not np.array_equal(picture(renderer, later), before)
    assert np.array_equal(picture(renderer, frame), before)


class Moving(Ball):
    """A ball that changes its shape."""

    def __init__(self, ball):
        object.__setattr__(self, "_now", ball.vertices)
        super().__init__(shape=ball.shape)

    @property
    def vertices(self):
        return self._now  # type: ignore[attr-defined,no-any-return]

    @vertices.setter
    def vertices(self, now):
        object.__setattr__(self, "_now", now)


def test_a_frame_of_a_stream_that_was_filled_anew_is_refused(renderer):
    """A frame is refused after its stream was filled with another mesh."""
    stream = lent(renderer, sphere())
    frame = render.Frame(render.CameraView(facing()), PLAIN_STYLE, render.Skin(stream))
    renderer.draw(frame)
    stream.upload(len(stream.vertices), len(stream.triangles))
    for use in (renderer.draw, renderer.read):
        with pytest.raises(ValueError, match="filled again since the frame was made"):
            use(frame)


def test_parts_under_opened_skin_are_seen_through_it(renderer):
    """A ball behind a translucent wall is visible, although it is drawn after the skin."""
    wall = render.Skin(lent(renderer, square(z=40.0)))
    style = replace(PLAIN_STYLE, opacity=0.3)
    view = render.CameraView(facing())
    alone = picture(renderer, render.Frame(view, style, wall))
    opened = picture(renderer, render.Frame(view, style, wall, still(Ball())))
    whole = picture(renderer, render.Frame(view, PLAIN_STYLE, wall, still(Ball())))
    assert opened[48, 48].astype(int).sum() < alone[48, 48].astype(int).sum() - 60
    assert np.array_equal(whole, picture(renderer, render.Frame(view, PLAIN_STYLE, wall)))


def test_a_change_of_samples_leaves_no_hole():
    """With one sample per pixel, a mesh's inner side is drawn before and after four samples."""
    with render.open_offscreen((96, 96), samples=4) as surface:
        renderer = render.Renderer(surface)
        camera = facing()
        camera.orbit(180.0)
        frame = render.Frame(
            render.CameraView(camera), PLAIN_STYLE, render.Skin(lent(renderer, square()))
        )
        pictures = []
        for samples in (0, 4, 0):
            surface.target = RenderTarget(surface.gl, (96, 96), samples)
            pictures.append(picture(renderer, frame))
        assert np.array_equal(pictures[0], pictures[2])
        assert pictures[0][48, 48].min() < 200
