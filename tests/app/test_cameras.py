"""The place of a camera, given by a name or by numbers."""

import numpy as np
import pytest
from pytest import approx

from risorius.app.capture.drawing import DEFAULT_VIEW, camera_for, camera_for_whole_scene
from risorius.app.errors import UserError

from .command_line import refusal, risorius


def test_numbers_stand_around_the_middle_of_the_face(scene):
    """Yaw and pitch [degrees] turn about the landmarks, not the skull.

    Zoom 2 halves the distance.
    """
    camera = camera_for(scene, "-15,2,2.3")
    assert (camera.yaw, camera.pitch) == approx((-15.0, 2.0))
    assert camera.target == approx(scene.framing.focus)
    assert scene.framing.focus[2] > camera_for(scene, "front").target[2] + 20.0
    near, far = (camera_for(scene, f"0,0,{zoom}").distance for zoom in (2, 1))
    assert near == approx(0.5 * far)
    assert camera_for(scene, "0,0").distance == far


def test_a_whole_scene_is_seen_and_no_nearer_than_wished(scene):
    """A camera too near to show the whole scene moves back; one farther away stays."""
    near = camera_for_whole_scene(scene, "0,0,4")
    far = camera_for_whole_scene(scene, "0,0,0.2")
    for camera in (near, far, camera_for(scene, "150,5,1")):
        clip = camera.projection_matrix(1.0) * camera.view_matrix()
        ends = np.column_stack([scene.rest_positions, np.ones(len(scene.rest_positions))])
        seen = ends @ np.asarray(clip)
        assert np.abs(seen[:, :2] / seen[:, 3:]).max() < 1.0
    assert near.distance > camera_for(scene, "0,0,4").distance
    assert far.distance == camera_for(scene, "0,0,0.2").distance


@pytest.mark.parametrize(
    "text", ["behind", "1", "1,2,3,4", "nan,0", "0,inf", "0,0,0", "0,0,-1", ""]
)
def test_wrong_cameras_are_refused(scene, text):
    """Unknown names and numbers are refused with the allowed ones; no word: the usual view."""
    if not text:
        assert camera_for(scene, text).yaw == camera_for(scene, DEFAULT_VIEW).yaw
        return
    with pytest.raises(UserError, match=r"allowed are front, .* zoom above 0"):
        camera_for(scene, text)


def test_a_wrong_camera_or_sound_of_a_script_is_reported_with_its_name(tmp_path):
    """A wrong camera or sound in a script is reported with the script's name.

    A value from the command line needs no name.
    """
    script = tmp_path / "mine.toml"
    target = tmp_path / "film.mp4"
    key = "duration = 0.1\n[[pose]]\ntime = 0.0\njoy = 1.0\n"
    script.write_text(f'camera = "behind"\n{key}')
    words = ("capture", script, "-o", target, "--size", "64x64")
    assert f"{script}: camera 'behind': allowed are front, " in refusal(risorius(*words))
    message = refusal(risorius(*words, "--camera", "above"))
    assert message.startswith("risorius: camera 'above': allowed are front, ")
    script.write_text(f'sound = "none.wav"\n{key}')
    wanted = f"{script}, 'sound': {tmp_path / 'none.wav'}: no such sound file"
    assert wanted in refusal(risorius(*words))
    assert list(tmp_path.iterdir()) == [script]
