"""Lids and lips shade eyes and teeth in a picture."""

import numpy as np
from pytest import approx

from risorius import render
from risorius.app.motion import SETTLING_TIME
from risorius.app.passes.passes import Passes
from risorius.app.pipeline import Pipeline, Viewport
from risorius.app.refining.presets import Refinement
from risorius.app.scenes.openings import rims_of
from risorius.assets import Segment

SIZE = (320, 240)
AREA = (0, 0, *SIZE)


def close_picture(scene, pose, landmarks, height):
    """Brightness (H, W) and classes of pixels in a picture centred on some landmarks."""
    scene.reset()
    scene.pose(pose)
    scene.step(SETTLING_TIME)
    camera = render.OrbitCamera.framing(scene.rest_positions)
    camera.target = scene.positions[scene.landmarks[landmarks]].mean(axis=0)
    camera.distance = height / (2.0 * np.tan(np.radians(0.5 * camera.field_of_view)))
    with render.open_offscreen(SIZE) as surface:
        pipeline = Pipeline(scene, render.Renderer(surface))
        drawn = pipeline.bind(Refinement())
        pipeline.draw(camera, render.Style(), [Viewport(drawn, AREA)])
        light = surface.read() @ np.array([0.2126, 0.7152, 0.0722])
        passes = Passes(pipeline, drawn)
        classes = passes.draw(camera, render.Style(), ("segmentation",))["segmentation"]
    return light, classes


def test_rims_run_through_the_landmarks(scene):
    """Corners of eyes and mouth, and middles of lips, are points of the openings' rims."""
    scene.reset()
    marks = scene.face.marked
    rims = rims_of(marks, 12)
    assert set(rims) == {"eye_right", "eye_left", "mouth"}
    for name, corners in (("eye_right", (36, 39)), ("eye_left", (42, 45)), ("mouth", (60, 64))):
        points = rims[name].points
        assert points.shape == (12, 3)
        for place, corner in zip((0, 6), corners, strict=True):
            assert points[place] == approx(marks[corner])
    assert rims["mouth"].points[3] == approx(marks[62])
    assert rims["mouth"].points[9] == approx(marks[66])


def test_lids_take_light_from_the_eyeball(scene, monkeypatch):
    """The eye is darker below the upper lid and in the corners, but not in its middle."""
    shown, classes = close_picture(scene, {"surprise": 1.0}, range(42, 48), 40.0)
    monkeypatch.setattr(scene, "rims", lambda point_count: {})
    in_the_open, _ = close_picture(scene, {"surprise": 1.0}, range(42, 48), 40.0)
    share = shown / np.maximum(in_the_open, 1.0)
    rows, columns = np.nonzero(classes == Segment.LEFT_EYE)
    middle = int(np.median(columns)) + 20  # beside the pupil
    down = share[rows[columns == middle], middle]
    assert down[2 : len(down) // 6].mean() < 0.72
    assert down[len(down) // 2] > 0.9
    for aside in np.percentile(columns, (5, 95)).astype(int):
        assert share[rows[columns == aside], aside].mean() < 0.8


def test_disgust_shows_no_scraps_of_gums(scene):
    """In disgust the visible gap between the lips is dark, because little light reaches it."""
    light, classes = close_picture(scene, {"disgust": 1.0}, range(48, 68), 60.0)
    in_mouth = light[classes == Segment.MOUTH_INTERIOR]
    lips = light[(classes == Segment.TOP_LIP) | (classes == Segment.BOTTOM_LIP)]
    assert in_mouth.mean() < 0.55 * lips.mean()
    assert (in_mouth > 0.8 * lips.mean()).mean() < 0.1


def test_teeth_in_a_smile_are_darker_under_the_lip(scene):
    """In a smile the row of teeth is bright in its middle, and darker beside and above."""
    light, classes = close_picture(scene, {"joy": 1.0}, range(60, 68), 30.0)
    rows, columns = np.nonzero(classes == Segment.MOUTH_INTERIOR)
    middle = int(np.median(columns)) + 8  # beside the line between the incisors
    shown = light[rows[columns == middle], middle]
    assert shown[2:5].mean() < 0.94 * shown.max()
    left, right = np.percentile(columns, (4, 96)).astype(int)
    for aside in (left, right):
        assert light[rows[columns == aside], aside].max() < 0.75 * shown.max()
