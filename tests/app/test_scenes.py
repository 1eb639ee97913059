"""Scenes: values are kept within limits, the plane waves, the face obeys."""

import numpy as np
import pytest

from risorius import refine
from risorius.app.errors import UserError
from risorius.app.refining.presets import PRESETS, Refinement
from risorius.app.refining.refiners import refiner_for
from risorius.app.scenes import FaceScene, PlaneScene, clamped

LIMITS = {"a": (0.0, 1.0), "b": (-1.0, 1.0)}


def test_values_are_cut_off_at_their_limits() -> None:
    """What a script adds up to may be too much; a name without limits is an error."""
    assert clamped(LIMITS, {"a": 1.4, "b": -3.0}) == {"a": 1.0, "b": -1.0}
    assert clamped(LIMITS, {"a": 0.4}) == {"a": 0.4}
    with pytest.raises(UserError, match="there is no control called 'c'"):
        clamped(LIMITS, {"c": 1.0})


def test_the_plane_waves() -> None:
    """154 triangles; the wave lifts vertices along the normal only, and rest is rest again."""
    plane = PlaneScene()
    assert len(plane.faces) == 154
    plane.pose({"amplitude": 1.0, "phase": 0.25})
    plane.step(0.1)
    moved = plane.positions - plane.rest_positions
    assert np.ptp(moved, axis=0).max() > 0.3 * np.ptp(plane.rest_positions, axis=0).max()
    assert np.count_nonzero(np.abs(moved).max(axis=0) > 1e-9) == 1
    plane.reset()
    assert np.array_equal(plane.positions, plane.rest_positions)


def test_the_face_takes_controls_of_every_layer(face: FaceScene) -> None:
    """A pose may mix layers; the next pose forgets it."""
    assert len(face.expressions) >= 9
    face.pose({"joy": 0.5, "AU4_left": 1.7, "viseme_aa": 0.2, "jaw_open": 0.1})
    assert face.values["joy"] == 0.5 and face.values["AU4_left"] == 1.0
    face.pose({"AU12": 1.0})
    assert {name for name, value in face.values.items() if value} == {"AU12"}


def test_a_long_step_is_divided(face: FaceScene) -> None:
    """A film at one frame a second moves the face as steps of a sixtieth do."""
    face.pose({"joy": 1.0})
    face.step(1.0)
    coarse = face.positions.copy()
    face.reset()
    face.pose({"joy": 1.0})
    for _ in range(60):
        face.step(1.0 / 60.0)
    assert np.abs(coarse - face.positions).max() < 1e-9


def test_the_face_is_round_at_rest(face: FaceScene) -> None:
    """The outline of the crown, seen from aside, has no high corners, and there are no cracks."""
    highest = {}
    for name in PRESETS:
        refiner = refiner_for(face, Refinement(name))
        mesh = refiner.refine(face.rest_positions)
        refine.check(refiner, mesh, face.rest_positions)
        outline = mesh.positions[abs(mesh.positions[:, 0]) < 1e-4, 1:].astype(np.float64)
        crown = outline[outline[:, 0] > 0.65 * outline[:, 0].max() + 0.35 * outline[:, 0].min()]
        around = crown - [crown[:, 0].min(), crown[:, 1].mean()]
        crown = crown[np.argsort(np.arctan2(*around.T))]
        # How far each point stands out of the line between its neighbours.
        chords = crown[2:] - crown[:-2]
        aside = (crown[1:-1] - crown[:-2]) @ [[0, 1], [-1, 0]]
        heights = (aside * chords).sum(axis=1) / np.linalg.norm(chords, axis=1)
        highest[name] = abs(heights).max()
    assert highest["paper"] > 1.0  # [mm]
    assert highest["smooth"] < 0.6 * highest["paper"]
