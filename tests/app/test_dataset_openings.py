"""The labels that say how far mouth and eyes are open."""

from __future__ import annotations

import numpy as np
import pytest

from risorius import render
from risorius.app.dataset.labels import labels_of_face
from risorius.app.scenes import FaceScene


@pytest.fixture(scope="module")
def face() -> FaceScene:
    """The built-in head."""
    return FaceScene()


def apertures_of(face: FaceScene, pose: dict[str, float]) -> dict[str, float]:
    """What a label says of mouth and eyes in a pose."""
    face.reset()
    face.pose(pose)
    face.step(1.0)
    camera = render.OrbitCamera.framing(face.framed)
    labels = labels_of_face(face, camera, (64, 48), np.ones((48, 64)))
    found: dict[str, float] = labels["apertures"]
    return found


@pytest.mark.parametrize("shut", ["AU17 AU15 AU4", "AU24", "AU28", "AU12", "AU43 AU6", "AU43 AU51"])
def test_what_is_shut_has_no_aperture(face: FaceScene, shut: str) -> None:
    """Lips that roll inward and lids that are squeezed, whose landmarks lie 1 to 4 mm apart."""
    found = apertures_of(face, dict.fromkeys(shut.split(), 1.0))
    assert found.pop("mouth") < 0.1
    assert all((value < 0.1) == ("AU43" in shut) for value in found.values())


def test_apertures_grow_with_what_opens(face: FaceScene) -> None:
    """In proportion from where lips and lids part, each eye for itself, however the head turns."""
    parted = [apertures_of(face, {"AU25": value})["mouth"] for value in (0.25, 0.5, 0.75, 1.0)]
    assert parted[0] < 0.3
    assert np.diff(parted) == pytest.approx(1.1, abs=0.3)
    turned = apertures_of(face, {"AU25": 1.0, "AU43_left": 0.5, "AU51": 1.0, "AU54": 1.0})
    assert turned["mouth"] == pytest.approx(parted[-1], abs=0.1)
    assert turned["eye_left"] == pytest.approx(0.5 * turned["eye_right"], abs=0.5)
    assert apertures_of(face, {"AU27": 1.0})["mouth"] > 20.0
