"""Passes of a face: triangles, splits and classes, and landmarks against the depth map."""

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial import cKDTree

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.passes.camera import CameraLabels
from risorius.app.passes.landmarks import JAW_COUNT, landmarks_in
from risorius.app.passes.passes import IMAGE_PASSES, Passes
from risorius.app.refining.presets import Refinement
from risorius.app.scenes import FaceScene
from risorius.assets import Segment

SIZE = (500, 500)
EXPRESSIONS = {
    "rest": {},
    "smile": {"AU6": 0.6, "AU12": 0.9},
    "open mouth": {"jaw_open": 0.9, "AU1": 1.0, "AU2": 1.0},
    "anger, turned": {"AU4": 1.0, "AU23": 0.8, "head_yaw": 0.4},
    "disgust, nodding": {"AU9": 1.0, "AU15": 0.6, "head_pitch": -0.4},
    "pucker, tilted": {"AU18": 1.0, "head_roll": 0.5},
}


def passes_of(studio, wanted):
    """The requested passes of the last picture."""
    passes = Passes(studio.pipeline, studio.viewports[-1].drawn)
    return passes.draw(studio.camera, studio.options.style, wanted)


def posed(studio, controls):
    """The face of a studio after it settled in a pose."""
    face = studio.scene
    face.reset()
    face.pose(controls)
    face.step(0.5)
    return face


@pytest.fixture(scope="module")
def studio(scene: FaceScene) -> Iterator[Capture]:
    """A studio that draws square pictures of the face with the usual refinement."""
    with Capture(scene, CaptureOptions(size=SIZE, camera="front")) as opened:
        yield opened


@pytest.fixture(scope="module")
def plain(scene: FaceScene) -> Iterator[Capture]:
    """A studio that draws square pictures of the face without refinement."""
    options = CaptureOptions(size=SIZE, camera="front", refinement=Refinement(refiner="none"))
    with Capture(scene, options) as opened:
        yield opened


def seen_from(studio, yaw=0.0, pitch=0.0):
    """Draw the face in its current state from a view."""
    studio.camera = render.OrbitCamera.framing(studio.scene.framing.extent)
    studio.camera.orbit(yaw, pitch)
    studio.draw_image()
    return CameraLabels.from_camera(studio.camera, SIZE)


def first_hits(points, faces, eye, ways):
    """Number of the first triangle on each ray, and its distance, (n, 2), over all triangles.

    Source: Möller and Trumbore 1997; -1 and infinity for no triangle.
    """
    a, b, c = (points[faces[:, k]] for k in range(3))
    first = b - a
    second = c - a
    found = np.full((len(ways), 2), [-1.0, np.inf])
    for row, way in enumerate(ways):
        p = np.cross(way, second)
        determinant = (first * p).sum(1)
        with np.errstate(divide="ignore", invalid="ignore"):
            u = ((eye - a) * p).sum(1) / determinant
            q = np.cross(eye - a, first)
            v = (q @ way) / determinant
            far = (second * q).sum(1) / determinant
            is_within = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
            is_hit = is_within & (far > 0.0)
        if is_hit.any():
            nearest = np.where(is_hit, far, np.inf).argmin()
            found[row] = nearest, far[nearest]
    return found


@pytest.mark.parametrize("yaw", [0.0, 70.0])
def test_triangles_and_depth_are_those_that_rays_hit(plain, yaw):
    """At 400 pixels of the unrefined mesh, more than 99 % have the triangle hit by their ray."""
    scene = posed(plain, EXPRESSIONS["smile"])
    camera = seen_from(plain, yaw, 5.0)
    found = passes_of(plain, ["depth", "triangle"])
    skin = np.argwhere(found["triangle"] >= 0)
    places = skin[np.random.default_rng(4).choice(len(skin), 400, replace=False)]
    pixels = np.column_stack([places[:, ::-1] + 0.5, np.ones(len(places))])
    ways = pixels @ np.linalg.inv(camera.intrinsics).T @ camera.rotation  # 1 mm along the axis
    eye = -camera.rotation.T @ camera.translation
    hits = first_hits(scene.positions, scene.faces, eye, ways)
    triangle, depth = hits.T
    is_same = triangle == found["triangle"][*places.T]
    assert is_same.mean() > 0.99
    off = np.abs(depth - found["depth"][*places.T])
    assert off[is_same].max() < 0.01


def test_nothing_parts_and_skin_differ(studio):
    """All passes have the same background; teeth and eyes have no triangle of the mesh."""
    posed(studio, EXPRESSIONS["open mouth"])
    seen_from(studio)
    found = passes_of(studio, IMAGE_PASSES)
    assert tuple(found) == IMAGE_PASSES
    nothing = found["depth"] == 0.0
    assert 0.3 < nothing.mean() < 0.9
    for name in ("normal", "splits", "segmentation"):
        assert not found[name][nothing].any()
    assert (found["segmentation"][~nothing] > 0).all()
    assert (found["triangle"][nothing] == -1).all()
    is_part = ~nothing & (found["triangle"] < 0)
    parts = (
        Segment.RIGHT_EYE, Segment.LEFT_EYE, Segment.MOUTH_INTERIOR, Segment.CLOTHING, Segment.HAIR
    )  # fmt: skip
    assert np.isin(found["segmentation"][is_part], parts).all()
    assert is_part.sum() > 1000
    assert not found["splits"][is_part].any()
    assert found["triangle"].max() < len(studio.scene.faces)


def test_splits_are_those_of_the_triangle_that_is_seen(studio):
    """The splits at a pixel are those that the refiner reports for the visible triangle."""
    posed(studio, EXPRESSIONS["smile"])
    seen_from(studio)
    found = passes_of(studio, ["triangle", "splits"])
    refiner = studio.viewports[0].drawn.refiner
    is_skin = found["triangle"] >= 0
    edges = refiner.triangle_edges[found["triangle"][is_skin]]
    assert np.array_equal(found["splits"][is_skin], refiner.splits[edges].sum(axis=1))
    assert found["splits"].max() > 0


def test_classes_are_the_subjects_own_sides_and_mirror(studio):
    """The subject's right is left in a picture from the front, and a face at rest is symmetric."""
    posed(studio, {})
    seen_from(studio)
    classes = passes_of(studio, ["segmentation"])["segmentation"]
    mirrored = classes[:, ::-1].copy()
    for right, left in ((3, 4), (5, 6), (7, 8)):
        columns = [np.nonzero(classes == side)[1] for side in (right, left)]
        assert len(columns[0]) > 30
        assert columns[0].max() < SIZE[0] / 2 < columns[1].min()
        is_left = mirrored == left
        mirrored[mirrored == right] = left
        mirrored[is_left] = right
    assert (mirrored != classes).mean() < 0.003
    rows = {k: np.nonzero(classes == k)[0].mean() for k in (6, 4, 2, 10, 11, 12)}
    assert list(rows.values()) == sorted(rows.values())  # brow, eye, nose, lips, neck


def test_an_open_mouth_has_an_inside(studio):
    """Pixels of the mouth's inside appear between open lips only; closed lids hide the eyes."""
    found = {}
    for name, controls in (("open", {"jaw_open": 0.9}), ("shut", {"AU43": 1.0})):
        posed(studio, controls)
        seen_from(studio)
        classes = passes_of(studio, ["segmentation"])["segmentation"]
        found[name] = np.bincount(classes.ravel(), minlength=256)
    assert found["open"][Segment.MOUTH_INTERIOR] > 400 > 50 > found["shut"][Segment.MOUTH_INTERIOR]
    assert found["shut"][Segment.RIGHT_EYE] < 0.2 * found["open"][Segment.RIGHT_EYE]
    assert found["open"][Segment.IGNORE] < 10


@pytest.mark.parametrize("expression", list(EXPRESSIONS))
@pytest.mark.parametrize("view", [(0.0, 0.0), (-40.0, 10.0), (65.0, -15.0)])
def test_landmarks_lie_on_the_depth_map(studio, expression, view):
    """Visible landmarks are within 2 mm of a surface in the depth map, half of them within a pixel.

    Landmarks of the jaw lie where the skin bends away from the camera (test_landmarks.py).
    """
    scene = posed(studio, EXPRESSIONS[expression])
    camera = seen_from(studio, *view)
    depth = passes_of(studio, ["depth"])["depth"]
    found = landmarks_in(scene.face, camera, depth)
    assert found.visible.sum() >= 28  # in profile half of the lower lip is hidden by the other half
    visible = np.flatnonzero(found.visible[JAW_COUNT:]) + JAW_COUNT
    rows, columns = np.nonzero(depth)
    middles = np.column_stack([columns, rows]) + 0.5
    surface = camera.from_picture(middles, depth[rows, columns].astype(np.float64))
    off, _ = cKDTree(surface).query(camera.to_camera(found.points[visible]))
    pixel_width = 0.6  # [mm]
    assert np.median(off) < pixel_width
    assert off.max() <= 2.0


def test_pupils_are_hidden_by_lids_and_everything_by_the_frame(studio):
    """Closed eyes have no visible pupils, and landmarks outside the frame are not visible."""
    for controls, is_seen in (({}, True), ({"AU43": 1.0}, False)):
        scene = posed(studio, controls)
        camera = seen_from(studio)
        depth = passes_of(studio, ["depth"])["depth"]
        found = landmarks_in(scene.face, camera, depth)
        assert (found.visible[68:] == is_seen).all()
        assert found.visible[17:36].all()
    # In a picture of 100 x 100 pixels, a pixel is wider than a lid is thick.
    small = CameraLabels.from_camera(studio.camera, (100, 100))
    assert not landmarks_in(scene.face, small, depth[2::5, 2::5]).visible[68:].any()
    cut = landmarks_in(scene.face, camera, depth[:, :200])
    assert not cut.visible[cut.pixels[:, 0] > 200.0].any()
