"""Masks of persons: they hide mouth and nose, and no face pierces them."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from risorius import render
from risorius.app.dataset.labels import labels_of_face
from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Studio
from risorius.app.passes.passes import Passes
from risorius.app.pipeline import Pipeline, Viewport
from risorius.app.refining.presets import Refinement
from risorius.app.scenes import FaceScene
from risorius.assets import Segment
from risorius.assets.identities import MASK_COLOURS, wearing
from tests.heads import person_of

SIZE = (160, 160)
COVERED_SEGMENTS = {Segment.TOP_LIP, Segment.BOTTOM_LIP, Segment.MOUTH_INTERIOR}
POSES = {
    "rest": {},
    "smile": {"AU6": 1.0, "AU12": 1.0, "AU25": 1.0},
    "open": {"AU25": 1.0, "AU27": 1.0},
    "snarl": {"AU9": 1.0, "AU10": 1.0, "AU18": 1.0},
}


@pytest.mark.slow
@pytest.mark.parametrize("number", [7, 12])
def test_lips_stay_behind_a_mask(number):
    """No lip is visible in any pose or view, and landmarks of lips and chin are hidden."""
    person = person_of(number)
    scene = FaceScene(wearing(person, shirt="blue", cover="blue"))
    surface = render.open_offscreen(SIZE, samples=1)
    pipeline = Pipeline(scene, render.Renderer(surface))
    drawn = pipeline.bind(Refinement())
    passes = Passes(pipeline, drawn)
    style = render.Style()
    for name, pose in POSES.items():
        scene.reset()
        scene.pose(pose)
        scene.step(1.0)
        for turn in (-60.0, 0.0, 35.0):
            camera = render.OrbitCamera.framing(scene.positions, view="front")
            camera.orbit(turn, 0.0)
            pipeline.draw(camera, style, [Viewport(drawn, (0, 0, *SIZE))])
            images = passes.draw(camera, style, {"depth", "segmentation"})
            classes = images["segmentation"]
            assert not np.isin(classes, list(COVERED_SEGMENTS)).any(), (name, turn)
            is_mask = classes == Segment.FACE_WEAR
            assert is_mask.sum() > 800
            marks = labels_of_face(scene, camera, SIZE, images["depth"], is_mask)["landmarks"]
            hidden = [8, 30, 33, *range(48, 68)]
            assert not np.array(marks["visible"])[hidden].any(), (name, turn)


@pytest.mark.slow
def test_rows_of_the_table_choose_masks(tmp_path: Path):
    """A row of the table gives every person this mask, with its class and label."""
    table = tmp_path / "masked.toml"
    table.write_text("[masks]\nwhite = 1.0\n")
    request = request_of(tmp_path, seed=3, size=SIZE, passes=("segmentation",), sample=table)
    shot = Studio(request).shoot(0)
    assert shot.known.labels["person"]["mask"] == "white"
    assert (shot.known.images["segmentation"] == Segment.FACE_WEAR).sum() > 300
    assert not any(shot.known.labels["landmarks"]["visible"][48:68])
    assert set(MASK_COLOURS) == {"blue", "white", "black"}


@pytest.mark.parametrize(("number", "frame"), [(3, "round"), (12, "oval"), (19, "rectangular")])
def test_glasses_stand_before_a_mask(number, frame):
    """The rims of glasses do not sink into the mask over the nose."""
    person = person_of(number)
    worn = wearing(person, shirt="blue", frame=frame, cover="blue").parts
    parts = {part.name: part for part in worn}
    sheet = parts["mask"]
    rims = parts["glasses"].vertices
    ahead_of_ears = 40.0  # [mm]
    rims = rims[rims[:, 2] > ahead_of_ears]
    far, nearest = cKDTree(sheet.vertices).query(rims)
    heights = ((rims - sheet.vertices[nearest]) * sheet.normals[nearest]).sum(axis=1)
    assert heights[far < 6.0].min() > 0.5
