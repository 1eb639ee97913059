"""The life of a face without input: how often and how far it moves, and its repeatability.

Every other motion has priority.
"""

import numpy as np
import pytest

from risorius.app.capture.drawing import camera_for
from risorius.app.capture.recording import Capture, CaptureOptions
from risorius.app.control_names.angles import FULL_ANGLES, GAZE_ANGLE
from risorius.app.motion.life import (
    EYES_MOST,
    LID_CONTROL,
    Idle,
    Life,
    looking_at,
)
from risorius.app.scenes import FaceScene
from risorius.app.script import Channel, Key, Script
from risorius.assets import load

from .command_line import succeeded

NO_CONTROLS = frozenset[str]()


def test_angles_are_those_of_the_rig():
    """A control at 1 turns head and eyes as far as in the rig of all heads."""
    rig = load("head").rig
    for name in ("yaw", "pitch", "roll"):
        assert FULL_ANGLES[f"head_{name}"] == rig["head"][f"{name}_deg"]
    assert {FULL_ANGLES[name] for name in FULL_ANGLES if name.startswith("gaze")} == {GAZE_ANGLE}
    assert rig["eyes"]["gaze_deg"] == GAZE_ANGLE


def lids_gap(scene):
    """The opening of the right eye in the middle of its lids [mm]."""
    points = scene.positions[scene.landmarks]
    return float((points[[37, 38]] - points[[41, 40]])[:, 1].mean())


def pupils(scene):
    """The current place and direction of each eyeball, by side."""
    bones = scene.bone_transforms()
    found = {}
    for eye in scene.head.eyes:
        motion = bones[f"eye_{eye.name}"]
        centre = (motion @ [*eye.centre, 1.0])[:3]
        found[eye.name] = centre, motion[:3, :3] @ [0.0, 0.0, 1.0]
    return found


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_eyes_blink_as_often_as_people_do_at_rest(seed):
    """Eyes blink 17 times a minute (Bentivoglio et al. 1997), and blinks never overlap."""
    waits = np.diff(life_blinks(Life(seed), 300.0))
    assert 15.0 < len(waits) / 5.0 < 19.0
    assert waits.min() > 0.5
    assert waits.max() < 8.0
    assert np.ptp(waits) > 3.0


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_eyes_are_with_the_viewer_most_of_the_time(seed):
    """Eyes look at the viewer's face most of the time; glances beside it last some seconds."""
    life = Life(seed)
    off = []
    for time in np.arange(0.0, 600.0, 0.1):
        eyes = life.parts(time)["eyes"]
        off.append(GAZE_ANGLE * np.hypot(eyes["gaze_horizontal_left"], eyes["gaze_vertical_left"]))
    assert max(off[:13]) == 0.0  # straight at the viewer at the start
    assert 0.03 < np.mean(np.array(off) > 3.0) < 0.2
    assert max(off) < 12.5


def test_a_blink_shuts_the_eye_and_takes_as_long_as_one(scene):
    """Lids meet although the simulation is delayed, and close faster than they open."""
    life = Life(0)
    gaps = []
    start = life_blinks(life)[0]
    scene.reset()
    open_wide = lids_gap(scene)
    scene.pose({f"{LID_CONTROL}_{side}": 1.0 for side in ("left", "right")})
    scene.step(1.0)
    shut = lids_gap(scene)
    scene.reset()
    for frame in range(36):
        lids = life.parts(start + frame / 60.0)["lids"]
        scene.pose(lids)
        scene.step(1.0 / 60.0)
        gaps.append((open_wide - lids_gap(scene)) / (open_wide - shut))
    closed = np.array(gaps)
    down, up = np.flatnonzero(closed > 0.9)[[0, -1]] / 60.0
    assert closed.max() > 0.985
    assert 0.05 < down < 0.15  # of the way down
    assert 0.05 < up - down < 0.16
    assert abs(closed[-1]) < 0.02
    assert np.diff(closed).max() > -1.15 * np.diff(closed).min()


def life_blinks(life, seconds=30.0):
    """The times in the first seconds of a life at which lids begin to close."""
    times = [frame / 60.0 for frame in range(round(60.0 * seconds))]
    drawn = [life.parts(time)["lids"][f"{LID_CONTROL}_left"] for time in times]
    moments = zip(times, [0.0, *drawn], drawn, strict=False)
    return [time for time, before, now in moments if before < 1.0 == now]


@pytest.mark.parametrize("view", ["front", "three-quarter", "-20,15", "40,-10"])
def test_both_eyes_meet_the_camera(scene, view):
    """Both eyes look at the camera within 2 degrees, which is invisible; the head turns, too."""
    eye = camera_for(scene, view).eye
    _look(scene, eye)
    assert _off(scene, eye) < 1.5
    left, right = (pupils(scene)[side][1] for side in ("left", "right"))
    assert left[0] < right[0]  # the eyes converge
    scene.reset()


def _off(scene, viewer):
    """The angle [degrees] between a point and the gaze of the eye that misses it more."""
    off = []
    for centre, way in pupils(scene).values():
        there = (viewer - centre) / np.linalg.norm(viewer - centre)
        off.append(np.degrees(np.arccos(min(way @ there, 1.0))))
    return float(max(off))


def test_a_camera_at_the_side_is_not_followed(scene):
    """With the camera at the side or behind, the face looks straight ahead, without jumps."""
    for view in ("profile", "180,0", "0,80"):
        parts = looking_at(scene.face, camera_for(scene, view).eye)
        assert all(value == 0.0 for part in parts.values() for value in part.values())
    walk = [
        looking_at(scene.face, camera_for(scene, f"{yaw},0").eye)["eyes"]["gaze_horizontal_left"]
        for yaw in range(-120, 121)
    ]
    assert np.abs(np.diff(walk)).max() < 0.2
    assert np.abs(walk).max() <= EYES_MOST / GAZE_ANGLE + 1e-9


def _look(scene, viewer):
    """Simulate until the face looks at a point."""
    idle = Idle(scene)
    scene.reset()
    for _ in range(90):
        scene.pose(idle.amounts(NO_CONTROLS, viewer, 0.0, is_still=True))
        scene.step(1.0 / 60.0)


def test_controls_moved_by_others_are_left_alone(scene):
    """Controls moved by a script are left alone, with all related controls.

    One lid stands for both lids, one direction of gaze for both eyes.
    """
    viewer = np.array([100.0, 0.0, 900.0])
    idle = Idle(scene)
    whole = idle.amounts(NO_CONTROLS, viewer, 5.6)
    assert {f"{LID_CONTROL}_left", "gaze_vertical_right", "head_roll"} <= whole.keys()
    for control, gone in (
        ("wink", LID_CONTROL),
        ("gaze_horizontal", "gaze"),
        ("AU61", "gaze"),
        ("head_roll", "head"),
    ):
        left = idle.amounts(scene.moved_by(control), viewer, 5.6)
        assert left and not any(name.startswith(gone) for name in left), control
        assert all(whole[name] == value for name, value in left.items())
    smiling = idle.amounts(scene.moved_by("AU12"), viewer, 5.6)
    assert smiling == whole


def test_a_speaking_head_nods(scene):
    """A speaking head nods by at most two degrees, unless a script moves the head."""
    viewer = np.array([100.0, 0.0, 900.0])
    idle = Idle(scene)
    silent = idle.amounts(NO_CONTROLS, viewer, 5.6)
    for opening, degrees in ((0.2, 0.8), (0.5, 2.0), (1.0, 2.0)):
        nodding = idle.amounts(NO_CONTROLS, viewer, 5.6, opening=opening)
        nod = 30.0 * (silent["head_pitch"] - nodding["head_pitch"])
        assert nod == pytest.approx(degrees)
        assert {**nodding, "head_pitch": silent["head_pitch"]} == silent
    assert "head_pitch" not in idle.amounts(frozenset({"head_yaw"}), viewer, 5.6, opening=1.0)


@pytest.mark.slow
def test_a_recording_without_head_motion_has_life(tmp_path):
    """A film of a recording without head motion, or of a script that is alive, blinks and nods.

    With head motion, or with --not-alive, it does not.
    """
    silent = {"jawOpen": 0.4}
    for name, channels, options, lives in (
        ("alone", silent, (), True),
        ("refused", silent, ("--not-alive",), False),
        ("with head", {**silent, "head_yaw": 8.0}, (), False),
    ):
        take = tmp_path / f"{name}.csv"
        rows = [("time", *channels)]
        for n in range(31):
            rise = min(n / 15.0, 1.0)
            rows.append((n / 30.0, *(rise * value for value in channels.values())))
        take.write_text("\n".join(",".join(map(str, row)) for row in rows))
        folders = [tmp_path / f"{name} {n}" for n in range(2)]
        for folder, more in zip(folders, (options, ("--not-alive",)), strict=True):
            succeeded("capture", take, "-o", folder, "--size", "64x64", "--fps", "10", *more)
        last = [sorted(folder.glob("*.png"))[-1].read_bytes() for folder in folders]
        assert (last[0] != last[1]) == lives, name
    script = tmp_path / "script.toml"
    script.write_text("alive = true\nduration = 1\ntracks.jaw_open = [{ time = 0, value = 0.4 }]\n")
    folder = tmp_path / "script"
    succeeded("capture", script, "-o", folder, "--size", "64x64", "--fps", "10")
    pictures = {picture.read_bytes() for picture in folder.glob("*.png")}
    assert len(pictures) > 1


@pytest.mark.slow
def test_a_film_with_life_is_the_same_twice_and_leaves_the_script_alone():
    """A film with life repeats exactly, and leaves all controls named by the script alone."""
    keys = (Key(0.0, 0.0), Key(2.9, 0.0), Key(3.0, 0.4))
    script = Script(
        "smile",
        3.0,
        "here",
        tracks={"AU12": Channel.from_keys(keys), "AU1": Channel.from_keys(keys)},
    )
    options = CaptureOptions(size=(64, 64), samples=0, is_alive=True)
    films = []
    for _ in range(2):
        with Capture(FaceScene(), options) as capture:
            values = [dict(capture.scene.values) for _ in capture.play(script, progress=False)]
            films.append((values, capture.scene.positions.copy()))
    assert films[0][0] == films[1][0]
    assert np.array_equal(films[0][1], films[1][1])
    values = films[0][0]
    assert max(each[f"{LID_CONTROL}_left"] for each in values) == 1.0
    assert any(each["gaze_horizontal_left"] for each in values)
    scripted = [script.at(frame / 30.0)["AU12"] for frame in range(91)]
    assert [each["AU12"] for each in values] == scripted
