"""Triangles that are surely hidden are left out, and no pixel shows it."""

from collections.abc import Iterator

import numpy as np
import pytest

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.refining.presets import STATIC, Refinement
from risorius.app.scenes import FaceScene
from risorius.render.hidden import FarthestDepths

POSES = ({}, {"jaw_open": 1.0, "tongue_out": 1.0}, {"AU43": 1.0, "AU12": 1.0}, {"head_yaw": 1.0})
CAMERAS = ("front", "20,-60", "-30,10,6")


@pytest.fixture(scope="module")
def studio() -> Iterator[Capture]:
    """Two heads side by side, multisampled, at a size that no tile divides."""
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
    """From everywhere, close by, behind, with eyes and mouth open or shut; and much is left out."""
    from risorius.app.capture.drawing import camera_for

    known = studio.scene.limits
    studio.scene.reset()
    studio.scene.pose({name: value for name, value in pose.items() if name in known})
    studio.scene.step(0.5)
    studio.camera = camera_for(studio.scene, camera)
    shares = []
    may_be_seen = FarthestDepths.may_be_seen

    def noted(*arguments, **sides):
        """Its words, and how many of them."""
        result = may_be_seen(*arguments, **sides)
        shares.append(float(np.mean(result)))
        return result

    monkeypatch.setattr(FarthestDepths, "may_be_seen", noted)
    sparing = studio.draw_image()
    monkeypatch.setattr(
        FarthestDepths, "may_be_seen", lambda _, __, faces, **sides: np.ones(len(faces), bool)
    )
    whole = studio.draw_image()
    assert np.array_equal(sparing, whole)
    assert len(shares) == 4
    assert min(shares) < 0.9
