"""The surface's numbers at each pixel, compared with spheres and planes known exactly."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import render

from .scenes import PLAIN_STYLE, Ball, Shape, facing, joined, lent, sphere, square, still

CHORD = 0.2  # [scene units] greatest depth of a flat triangle below its ball, for 8192 triangles


def rays(camera, size):
    """Rays through the middles of pixels, one unit long along the camera's axis, (H, W, 3)."""
    width, height = size
    focal = camera.focal(width / height, height)
    across = (np.arange(width) + 0.5 - width / 2) / focal
    down = (np.arange(height) + 0.5 - height / 2) / focal
    right, up, back = camera.axes()
    return across[None, :, None] * right - down[:, None, None] * up - back


def drawn(surface, shape, camera, *, parts=()):
    """The numbers read for one shape and parts."""
    renderer = render.Renderer(surface)
    stream = lent(renderer, shape)
    view = render.CameraView(camera)
    return renderer.read(render.Frame(view, PLAIN_STYLE, render.Skin(stream), still(*parts)))


@settings(max_examples=15, deadline=None)
@given(
    yaw=st.floats(-180.0, 180.0),
    pitch=st.floats(-80.0, 80.0),
    size=st.tuples(st.integers(33, 120), st.integers(33, 120)),
)
def test_a_sphere_is_as_far_away_as_it_should_be(yaw, pitch, size):
    """For every view and frame size, depth and normals of a sphere are exact.

    Depth is along the camera's axis, and normals are in the camera's axes.
    """
    camera = facing(60.0)
    camera.orbit(yaw, pitch)
    shape = sphere(5)
    with render.open_offscreen(size) as surface:
        found = drawn(surface, shape, camera)
    ways = rays(camera, size)
    eye = camera.eye
    # The nearer solution of |eye + s way| = 50.
    a = (ways**2).sum(-1)
    b = ways @ eye
    under_root = b * b - a * (eye @ eye - 2500.0)
    is_hit = under_root > 0.0
    expected = (-b - np.sqrt(np.maximum(under_root, 0.0))) / a
    assert found.depth.shape == is_hit.shape
    inner = is_hit & (under_root > 0.05 * under_root.max())  # the triangles' outline is narrower
    assert inner.sum() > 50
    assert (found.depth[inner] > 0.0).all()
    assert not found.depth[~is_hit].any()
    steepness = np.sqrt(under_root[inner]) / 50.0
    assert (np.abs(found.depth[inner] - expected[inner]) < CHORD / steepness).all()

    points = eye + expected[..., None] * ways
    right, up, back = camera.axes()
    normals = points @ np.stack([right, -up, -back]).T / 50.0
    assert np.abs(found.normal[inner] - normals[inner]).max() < 0.1
    lengths = np.linalg.norm(found.normal[found.depth > 0.0], axis=1)
    assert np.abs(lengths - 1.0).max() < 1e-5
    assert (found.normal[inner][:, 2] < 0.0).all()  # toward the camera


def test_the_top_row_comes_first_and_axes_are_those_of_pictures(surface):
    """A square above and to the right of the middle is read at the top right."""
    shape = square(20.0)
    moved = Shape(shape.positions + np.float32([25.0, 25.0, 0.0]), shape.normals, shape.triangles)
    rows, columns = np.nonzero(drawn(surface, moved, facing()).depth)
    assert rows.max() < 48 <= columns.min()
    up = Shape(shape.positions, np.tile(np.float32([0, 1, 0]), (4, 1)), shape.triangles)
    normals = drawn(surface, up, facing()).normal
    assert np.allclose(normals[48, 48], [0.0, -1.0, 0.0])


def test_nearer_surfaces_hide_those_behind(surface):
    """Of two squares and a ball the nearest surface is read, in any drawing order."""
    far = square(50.0, z=-30.0)
    near = square(10.0, z=40.0)
    for shape in (joined(far, near), joined(near, far)):
        found = drawn(surface, shape, facing(), parts=(Ball(),))
        middle = (48, 48)
        beside = (48, 62)
        corner = (10, 10)
        is_near = shape.positions[shape.triangles[:, 0], 2] > 0.0
        assert is_near[found.triangle[middle]]
        assert found.triangle[beside] >= len(shape.triangles)  # triangles of the ball
        assert not is_near[found.triangle[corner]]
        assert found.depth[middle] < found.depth[beside] < found.depth[corner]


def test_triangles_are_numbered_through_all_parts(surface):
    """Triangles of the mesh are numbered first, then those of each part; empty pixels have -1."""
    shape = square(10.0, z=45.0)
    ball = Ball()
    found = drawn(surface, shape, facing(70.0), parts=(ball,))
    assert found.triangle[0, 0] == -1
    assert found.depth[0, 0] == 0.0
    assert set(found.triangle[(found.triangle >= 0) & (found.triangle < 2)]) == {0, 1}
    seen = np.unique(found.triangle[found.triangle >= 2]) - 2
    front = ball.shape.positions[ball.shape.triangles].mean(axis=1)[:, 2] > 0.0
    assert front[seen].all()
    assert len(seen) > 0.4 * front.sum()
    twice = drawn(surface, shape, facing(70.0), parts=(Ball(), Ball()))
    assert twice.triangle.max() < 2 + 2 * len(ball.faces)


def test_the_back_of_the_mesh_differs_from_its_front(surface):
    """Front and back of the mesh are distinguished; normals face the camera on both sides."""
    camera = facing()
    assert not drawn(surface, square(), camera).is_inside.any()
    camera.orbit(180.0)
    found = drawn(surface, square(), camera)
    assert found.is_inside[48, 48]
    assert found.normal[48, 48, 2] < -0.99


def test_a_picture_is_the_same_before_and_after(surface, renderer):
    """Reading numbers changes no colours of the same frame or of the next."""
    stream = lent(renderer, sphere())
    parts = still(Ball(shape=sphere(3, 60.0)))
    frame = render.Frame(render.CameraView(facing()), render.Style(), render.Skin(stream), parts)
    pictures = []
    for _ in range(3):
        renderer.draw(frame)
        pictures.append(surface.read())
        renderer.read(frame)
        pictures.append(surface.read())
    assert all(np.array_equal(pictures[0], each) for each in pictures)
