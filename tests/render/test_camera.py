"""Camera: a framed scene is fully visible, and each camera motion has its effect."""

import numpy as np
import pytest
from pytest import approx

from risorius import render

HEAD_POINTS = np.random.default_rng(7).normal(size=(400, 3)) * (60.0, 90.0, 50.0) + (
    3.0,
    -20.0,
    60.0,
)


def seen(camera, points, aspect=1.5):
    """Places of points in the frame: -1..1 from left to right, bottom to top, near to far."""
    rows = np.column_stack([np.atleast_2d(points), np.ones(len(np.atleast_2d(points)))])
    clip = rows @ np.asarray(camera.view_matrix()) @ np.asarray(camera.projection_matrix(aspect))
    return np.asarray(clip[:, :3] / clip[:, 3:])


@pytest.mark.parametrize("view", render.VIEWS)
@pytest.mark.parametrize("aspect", [0.4, 1.0, 16 / 9])
def test_framing_fits_everything(view, aspect):
    """All vertices are in the frame, between the clipping planes, and touch the margin."""
    camera = render.OrbitCamera.framing(HEAD_POINTS, view=view)
    places = seen(camera, HEAD_POINTS, aspect)
    assert np.abs(places).max() <= 1.0
    assert np.abs(places[:, :2]).max() == approx(0.88, abs=0.03)


def test_views_have_their_direction():
    """Front is seen from +z, the profile from the subject's left (+x), below from -y."""
    eyes = {
        view: render.OrbitCamera.framing(HEAD_POINTS, view=view).axes()[2] for view in render.VIEWS
    }
    assert eyes["front"] == approx((0, 0, 1))
    assert eyes["profile"] == approx((1, 0, 0))
    assert eyes["three-quarter"][0] > 0.4
    assert eyes["three-quarter-right"][0] < -0.4
    assert eyes["below"][1] < -0.4
    assert eyes["top"] == approx((0, 1, 0))


def test_orbit_stops_at_the_poles():
    """However high the camera orbits, up stays up."""
    camera = render.OrbitCamera.framing(HEAD_POINTS)
    camera.orbit(0.0, 500.0)
    assert camera.pitch < 90.0
    assert camera.axes()[1][1] > 0.0
    assert np.isfinite(np.asarray(camera.view_matrix())).all()


def test_zoom_has_an_end_on_both_sides():
    """After any zoom the eye is outside the target, and the target is still visible."""
    camera = render.OrbitCamera.framing(HEAD_POINTS)
    camera.zoom(1e30)
    assert camera.distance == approx(0.02 * camera.scene_radius)
    camera.zoom(1e-30)
    assert camera.distance == approx(100.0 * camera.scene_radius)


def test_clipping_planes_hold_the_scene_from_anywhere():
    """From every side and distance, the scene's visible half is between the clipping planes."""
    camera = render.OrbitCamera.framing(HEAD_POINTS)
    for zoom in (0.2, 1.0, 1.0, 1.5):
        camera.zoom(zoom)
        camera.orbit(47.0, 19.0)
        depth = seen(camera, HEAD_POINTS)[:, 2]
        assert -1.0 <= depth.min()
        assert depth.max() <= 1.0


@pytest.mark.parametrize(
    ("vertices", "view", "message"),
    [
        (HEAD_POINTS, "behind", "view is 'behind'; it must be one of front, three-quarter"),
        (np.zeros((0, 3)), "front", r"vertices has shape \(0, 3\); it must be \(n, 3\)"),
        (np.zeros((4, 2)), "front", r"vertices has shape \(4, 2\)"),
        (np.full((4, 3), np.nan), "front", "vertices holds numbers that are not finite"),
    ],
)
def test_framing_errors(vertices, view, message):
    """Impossible frames are refused with a reason."""
    with pytest.raises(ValueError, match=message):
        render.OrbitCamera.framing(vertices, view=view)


@pytest.mark.parametrize("seed", range(6))
def test_a_projected_point_is_found_again(seed):
    """A point, projected and unprojected, is unchanged, and its ray starts at the eye."""
    random = np.random.default_rng(seed)
    camera = render.OrbitCamera.framing(HEAD_POINTS, view=random.choice(list(render.VIEWS)))
    camera.orbit(*random.uniform(-60.0, 60.0, 2))
    camera.zoom(random.uniform(0.5, 3.0))
    camera.pan(*random.uniform(-0.2, 0.2, 2))
    aspect = random.uniform(0.4, 2.5)
    matrix = np.asarray(camera.view_matrix()) @ np.asarray(camera.projection_matrix(aspect))
    points = HEAD_POINTS[random.integers(len(HEAD_POINTS), size=20)]
    places = seen(camera, points, aspect)
    back = np.column_stack([places, np.ones(20)]) @ np.linalg.inv(matrix)
    assert back[:, :3] / back[:, 3:] == approx(points, abs=1e-6)
    farther = seen(camera, points + 0.1 * (points - camera.eye), aspect)
    assert farther[:, :2] == approx(places[:, :2], abs=1e-6)


def test_another_lens_keeps_the_target_as_large():
    """A wide lens moves the camera nearer; an impossible one is refused."""
    camera = render.OrbitCamera.framing(HEAD_POINTS)
    above = camera.target + np.array([0.0, 0.1, 0.0])
    before = seen(camera, above[None], 1.0)[0, 1]
    far = camera.distance
    camera.change_lens(70.0)
    assert camera.distance < 0.5 * far
    assert seen(camera, above[None], 1.0)[0, 1] == approx(before, rel=0.1)
    with pytest.raises(ValueError, match=r"field_of_view is 180.0; it must be above 0, below 180"):
        camera.change_lens(180.0)
