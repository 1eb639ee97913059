"""Triangles that no sample beside an edge can see are left out, and no pixel shows it."""

from collections.abc import Iterator

import numpy as np
import pytest

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.drawing import camera_for
from risorius.app.refining.presets import STATIC, Refinement
from risorius.app.scenes import FaceScene
from risorius.render.edge_tiles import EdgeTiles

POSES = ({}, {"jaw_open": 1.0, "tongue_out": 1.0}, {"AU43": 1.0, "AU12": 1.0}, {"head_yaw": 1.0})
CAMERAS = ("front", "20,-60", "-30,10,6")


@pytest.fixture(scope="module")
def studio() -> Iterator[Capture]:
    """Two heads side by side, at a size that no tile divides."""
    options = CaptureOptions(
        size=(405, 231), beside=(Refinement(refiner=STATIC),), captions=False, samples=4
    )
    with Capture(FaceScene(), options) as opened:
        if not opened.surface.is_software:
            pytest.skip("a GPU leaves nothing out")
        yield opened


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("pose", POSES)
def test_no_pixel_changes(studio, camera, pose, monkeypatch):
    """From everywhere, close by, with eyes and mouth open or shut; and much is left out."""
    known = studio.scene.limits
    studio.scene.reset()
    studio.scene.pose({name: value for name, value in pose.items() if name in known})
    studio.scene.step(0.5)
    studio.camera = camera_for(studio.scene, camera)
    shares = []
    touched = EdgeTiles.touched

    def noted(*arguments):
        """Its words, and how many of them."""
        result = touched(*arguments)
        shares.append(float(np.mean(result)))
        return result

    monkeypatch.setattr(EdgeTiles, "touched", noted)
    sparing = studio.draw_image().astype(int)
    monkeypatch.setattr(EdgeTiles, "touched", lambda _, __, ___, faces: np.ones(len(faces), bool))
    whole = studio.draw_image().astype(int)
    off = np.abs(sparing - whole).max(axis=2)
    assert (off > 8).mean() < 1e-4
    assert len(shares) == 2
    assert max(shares) < 0.8
