"""Scenes: values stay within limits, the plane waves, the face follows controls."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from risorius import refine
from risorius.app.errors import UserError
from risorius.app.live.frame import set_shape
from risorius.app.playback import Playback
from risorius.app.recordings.calibration import Calibration
from risorius.app.recordings.conversion import script_of
from risorius.app.recordings.mapping import controls_of
from risorius.app.refining.presets import PRESETS, Refinement
from risorius.app.refining.refiners import refiner_for
from risorius.app.scenes import PlaneScene
from risorius.app.script import Channel, Pose, Script
from risorius.app.viewer.session.document import LiveOverride
from risorius.app.viewer.session.session import Session
from tests.sim.poses import advance

from .recording_files import take_of


@given(value=st.floats(-2.9, 2.9), gain=st.floats(0.0, 9.0))
@settings(max_examples=20, deadline=None)
def test_a_value_beyond_its_limits_is_cut_off_from_each_door(scene, value, gain):
    """Values from scripts, sliders, recordings and live faces are limited after their sum."""
    limits = scene.limits
    rest = scene.limits.pose({})
    frame = dict[str, float]()
    script = Script("", 1.0, "", poses=(Pose(0.0, {"jaw_open": 0.5}),))
    tracked = replace(script, tracks={"jaw_open": Channel([0.0], [value])})
    session = Session(scene, script)
    session.set("jaw_open", value)
    gains = Playback(neutral="none", gains=(f"all={gain}",))
    recorded, _ = script_of(take_of(seconds=0.0, jawOpen=value), gains, limits)
    recorded.check(limits)
    set_shape(frame, "jawOpen", value)
    override = LiveOverride(limits)
    override.override(controls_of(Calibration(default_gain=gain).apply(frame)) | {"none": 1.0}, 1.0)
    for asked, name, values in (
        (0.5 + value, "jaw_open", tracked.values(0.0, limits)),
        (value, "jaw_open", session.current),
        (gain * value, "jawOpen", recorded.values(0.0, limits)),
        (gain * value, "jawOpen", override.applied_to(rest)),
    ):
        scene.set_controls(values)
        assert scene.values[name] == pytest.approx(min(max(asked, 0.0), 1.0), abs=2e-3)


def test_the_plane_waves():
    """The plane has 154 triangles, moves along its normal only, and returns exactly to rest."""
    plane = PlaneScene()
    assert len(plane.faces) == 154
    plane.pose({"amplitude": 1.0, "phase": 0.25})
    plane.step(0.1)
    moved = plane.positions - plane.rest_positions
    assert np.ptp(moved, axis=0).max() > 0.3 * np.ptp(plane.rest_positions, axis=0).max()
    assert np.count_nonzero(np.abs(moved).max(axis=0) > 1e-9) == 1
    plane.reset()
    assert np.array_equal(plane.positions, plane.rest_positions)


def test_the_face_takes_controls_of_every_layer(face):
    """A pose may mix layers, the next pose replaces it, and an unknown name is refused."""
    with pytest.raises(UserError, match="there is no control called 'c'"):
        face.pose({"c": 1.0})
    assert len(face.expressions) >= 9
    face.pose({"joy": 0.5, "AU4_left": 1.7, "viseme_aa": 0.2, "jaw_open": 0.1})
    assert face.values["joy"] == 0.5
    assert face.values["AU4_left"] == 1.0
    face.pose({"AU12": 1.0})
    assert {name for name, value in face.values.items() if value} == {"AU12"}


def test_a_long_step_is_divided(face):
    """A step of a second moves the face like sixty steps of a sixtieth."""
    face.pose({"joy": 1.0})
    face.step(1.0)
    coarse = face.positions.copy()
    face.reset()
    face.pose({"joy": 1.0})
    advance(face, 60)
    assert np.abs(coarse - face.positions).max() < 1e-9


def test_the_face_is_round_at_rest(face):
    """From the side, the outline of the crown has no sharp corner, and there is no crack."""
    highest = {}
    for name in PRESETS:
        refiner = refiner_for(face, Refinement(name))
        mesh = refiner.refine(face.rest_positions)
        refine.check(refiner, mesh, face.rest_positions)
        outline = mesh.positions[abs(mesh.positions[:, 0]) < 1e-4, 1:].astype(np.float64)
        height = outline[:, 0]
        crown = outline[height > 0.65 * height.max() + 0.35 * height.min()]
        around = crown - [crown[:, 0].min(), crown[:, 1].mean()]
        crown = crown[np.argsort(np.arctan2(*around.T))]
        # The distance of each point from the line between its neighbours.
        chords = crown[2:] - crown[:-2]
        aside = (crown[1:-1] - crown[:-2]) @ [[0, 1], [-1, 0]]
        heights = (aside * chords).sum(axis=1) / np.linalg.norm(chords, axis=1)
        highest[name] = abs(heights).max()
    assert highest["paper"] > 1.0  # [mm]
    assert highest["smooth"] < 0.6 * highest["paper"]
