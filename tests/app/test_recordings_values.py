"""Units of values, flags of rows without a face, head angles: in tables and in JSON."""

import json

import numpy as np
import pytest
from pytest import approx
from scipy.spatial.transform import Rotation

from risorius.app.recordings.reading import is_recording, read_take
from risorius.sim.skull import turn_head

from .recording_files import has_note, written

FRAME_COUNT = 150
RISE = np.sin(np.linspace(0.0, np.pi, FRAME_COUNT)) ** 2
TIMES = np.arange(FRAME_COUNT) / 30.0
RESTING_SHAPES = (
    "browDownLeft",
    "browDownRight",
    "noseSneerLeft",
    "noseSneerRight",
    "mouthShrugUpper",
)
FRAMES = [
    {"time": time, "blendshapes": {"jawOpen": value, "mouthClose": 0.1}}
    for time, value in zip(TIMES.tolist(), RISE.tolist(), strict=True)
]


def of_table(folder, columns):
    """The take of a table with these columns beside times."""
    return read_take(written(folder / "take.csv", {"timestamp": TIMES, **columns}))


def of_json(folder, document):
    """The take of a document."""
    path = folder / "take.json"
    path.write_text(json.dumps(document))
    assert is_recording(path)
    return read_take(path)


VALUE_UNITS = {
    "shapes in percent": ({"jawOpen": 100 * RISE}, "jawOpen", 1.0, "0 to 100"),
    "shapes": ({"jawOpen": RISE}, "jawOpen", 1.0, ""),
    "units in percent": ({"AU12": 100 * RISE}, "AU12", 1.0, "0 to 100"),
    "units of FACS": ({"AU12": 4.0 * RISE}, "AU12", 0.8, "divided by 5"),
    "smoothed units": ({"AU12": 1.02 * RISE}, "AU12", 1.02, ""),
    "OpenFace": ({"confidence": [0.9] * FRAME_COUNT, "AU12_r": 4.0 * RISE}, "AU12", 0.8, ""),
    "OpenFace, 0 to 1": (
        {"success": [1] * FRAME_COUNT, "AU12_r": RISE, "AU12_c": [1] * FRAME_COUNT},
        "AU12",
        1.0,
        "0 to 1",
    ),
    "OpenFace in percent": (
        {"success": [1] * FRAME_COUNT, "AU12_r": 100.0 * RISE}, "AU12", 1.0, "0 to 100",
    ),
    "visemes in percent": ({"viseme_aa": 100 * RISE}, "viseme_aa", 1.0, "0 to 100"),
    "LibreFace": (
        {"au_12": np.round(RISE), "au_12_intensity": 4.0 * RISE}, "AU12", 0.8, "detections",
    ),
    "a presence beside": (
        {"AU12_presence": np.round(RISE), "AU12": 4.0 * RISE}, "AU12", 0.8, "detections",
    ),
    "only a presence": (
        {"AU12_detection": np.round(RISE)}, "AU12", 1.0, "only present or absent",
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", VALUE_UNITS)
def test_units(kind, tmp_path):
    """Values in all units become fractions of 0 to 1, and a guessed unit is reported."""
    columns, channel, peak, note = VALUE_UNITS[kind]
    take = of_table(tmp_path, columns)
    assert take.channels.keys() == {channel}
    assert take.channels[channel].max() == approx(peak, abs=2e-3)
    assert has_note(take.notes, note) or not note
    assert not has_note(take.notes, "No face")


def test_stray_values_are_no_percent(tmp_path):
    """A few stray values do not turn the others into per cent."""
    jaw = RISE.copy()
    jaw[[20, 70]] = 80.0
    take = of_table(tmp_path, {"jawOpen": jaw})
    assert take.channels["jawOpen"].max() == approx(1.0, abs=1e-3)
    assert has_note(take.notes, "2 values of shapes are far from 0 to 1")


def lost_columns(value):
    """Columns of a face with brows and nose at 0.4 at rest, and `value` in rows 60 to 99."""
    lost = (np.arange(FRAME_COUNT) >= 60) & (np.arange(FRAME_COUNT) < 100)
    shapes = {name: np.where(lost, value, 0.4 + 0.02 * RISE) for name in RESTING_SHAPES}
    return {"jawOpen": np.where(lost, value, 0.2 + 0.5 * RISE), **shapes}, lost


@pytest.mark.parametrize(
    ("flag", "seen", "unseen"),
    [
        ("", "", ""),
        ("faceDetected", "true", "false"),
        ("face_detected", 1, 0),
        ("isTracked", "True", "False"),
        ("tracked", "yes", "no"),
        ("success", 1, 0),
        ("confidence", 0.9, 0.1),
        ("confidence", 90, 10),
        ("BlendShapeCount", 61, 0),
    ],
)
@pytest.mark.parametrize("is_json", [False, True])
def test_rows_without_a_face(flag, seen, unseen, is_json, tmp_path):
    """Rows of zeros without a face hold the pose, and are not taken as the neutral face.

    The take is not recognised as calibrated.
    """
    columns, lost = lost_columns(0.0)
    if flag:
        columns[flag] = [unseen if each else seen for each in lost]
    if is_json:
        names = [name for name in columns if name != flag]
        frames = []
        for row, time in enumerate(TIMES.tolist()):
            shapes = {name: float(columns[name][row]) for name in names}
            frames.append({"t": time, "blendshapes": shapes})
            if flag:
                frames[-1][flag] = columns[flag][row]
        take = of_json(tmp_path, frames)
    else:
        take = of_table(tmp_path, columns)
    assert not take.is_calibrated
    assert has_note(take.notes, "No face in 40 of 150 frames")
    assert take.channels["browDownLeft"].min() > 0.39
    assert not take.unknown


@pytest.mark.parametrize("flag", ["faceDetected", "BlendShapeCount"])
def test_a_frozen_face(flag, tmp_path):
    """Values that a tracker repeats without a face are ignored."""
    columns, lost = lost_columns(0.9)
    take = of_table(tmp_path, columns | {flag: np.where(lost, 0, 52).tolist()})
    assert take.channels["browDownLeft"].max() < 0.5


def test_zeros_of_a_calibrated_face_are_rest(tmp_path):
    """If a face is often at 0, zeros are its rest."""
    shapes = {name: np.maximum(RISE - 0.5, 0.0) for name in RESTING_SHAPES}
    take = of_table(tmp_path, shapes)
    assert take.is_calibrated
    assert not has_note(take.notes, "No face")


YAW = 20.0 * np.sin(TIMES + 0.1)
HEAD_TURNS = Rotation.from_euler("y", YAW[:, None], degrees=True)  # y is up: + is to the left


def heads():
    """For each layout: values of the frames, their key, and the sign of yaw."""
    quaternions = HEAD_TURNS.as_quat()
    degrees = [{"yaw": yaw, "pitch": 1.0, "roll": 0.5} for yaw in YAW]
    radians = [{"Yaw": yaw, "Pitch": 0.01} for yaw in np.radians(YAW)]
    scalar_last = [list(each) for each in quaternions]
    scalar_first = [list(np.roll(each, 1)) for each in quaternions]
    named = [dict(zip("xyzw", each, strict=True)) for each in quaternions]
    matrices = [turn.tolist() for turn in HEAD_TURNS.as_matrix()]
    return {
        "degrees": (degrees, "headRotation", -1.0),
        "radians": (radians, "head_pose", -1.0),
        "x, y, z, w": (scalar_last, "headQuaternion", 1.0),
        "w, x, y, z": (scalar_first, "rotation", 1.0),
        "named": (named, "orientation", 1.0),
        "3 x 3": (matrices, "headMatrix", 1.0),
        "an angle": (list(YAW), "headYaw", -1.0),
    }


@pytest.mark.parametrize("layout", heads())
def test_heads_beside_shapes(layout, tmp_path):
    """The head turns by 20 degrees in all notations."""
    values, key, sign = heads()[layout]
    take = of_json(
        tmp_path, [{**frame, key: value} for frame, value in zip(FRAMES, values, strict=True)]
    )
    assert take.channels["head_yaw"] == approx(sign * YAW, abs=1e-6)
    assert not take.unknown


def test_a_head_turned_about_three_axes(tmp_path):
    """Yaw, pitch and roll of a matrix are those by which the simulation turns a head."""
    angles = np.radians([20.0, -15.0, -12.0])  # to the left, down, and to the right shoulder
    turn, _ = turn_head(np.zeros((2, 3)), (0.0, 0.0, 0.0), tuple(angles))
    rows = [{**frame, "headMatrix": turn.tolist()} for frame in FRAMES]
    channels = of_json(tmp_path, rows).channels
    assert channels["head_yaw"] == approx(20.0)
    assert channels["head_pitch"] == approx(15.0)
    assert channels["head_roll"] == approx(12.0)


@pytest.mark.parametrize("value", [[1.0, 20.0, 3.0], {"x": 1.0, "y": 20.0, "z": 3.0}, "left"])
def test_heads_that_are_not_clear(value, tmp_path):
    """Head angles without names are left out, and this is reported."""
    take = of_json(tmp_path, [{**frame, "headRotation": value} for frame in FRAMES])
    assert "head_yaw" not in take.channels
    assert take.unknown == ("headrotation",)


def in_categories(frame):
    """The shapes in the form of MediaPipe's web page."""
    shapes = [{"categoryName": n, "score": v} for n, v in frame["blendshapes"].items()]
    return [{"categories": shapes}]


LAYOUTS = {
    "under results": [
        {"timestamp": f["time"], "results": {"faceBlendshapes": in_categories(f)}} for f in FRAMES
    ],
    "under a result in it": {
        "data": [{"result": {"face": {"blendshapes": f["blendshapes"], "time": f["time"]}}}
                 for f in FRAMES]
    },
    "names once": {
        "names": ["jawOpen", "mouthClose"],
        "frames": [{"weights": [*f["blendshapes"].values()], "time": f["time"]} for f in FRAMES],
    },
    "names once, rows": {
        "fps": 30, "blendShapeNames": ["jawOpen", "mouthClose"],
        "data": [[*f["blendshapes"].values()] for f in FRAMES],
    },
}  # fmt: skip


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts_of_json(layout, tmp_path):
    """Shapes are found in nested tables, and under names that occur once."""
    take = of_json(tmp_path, LAYOUTS[layout])
    assert take.channels["jawOpen"] == approx(RISE)
    assert take.times == approx(TIMES)
    assert not take.unknown


def test_unknown_keys_of_json_are_reported(tmp_path):
    """Unknown keys, and a shape under two names, are reported."""
    frames = [{**frame, "emotion": "joy"} for frame in FRAMES]
    frames[3]["blendshapes"] = {"jawOpen": 0.25, "JawOpen": 0.75}
    take = of_json(tmp_path, frames)
    assert take.unknown == ("emotion",)
    assert take.channels["jawOpen"][3] == 0.25
    assert has_note(take.notes, "repeat another name, and were left out: 'JawOpen'")


@pytest.mark.parametrize("form", ["{:.1f}%", "{:.1f} %"])
def test_percent_signs_in_cells(form, tmp_path):
    """Cells with a per cent sign are divided by 100 in any column, also for small values."""
    values = np.linspace(0.0, 0.02, 30).round(3)
    rows = [[form.format(100.0 * value), form.format(20.0 + 75.0 * (value > 0.01)), "0.5"]
            for value in values]  # fmt: skip
    names = ["jawOpen", "confidence", "cheekPuff"]
    path = tmp_path / "take"
    with_commas = [[cell.replace(".", ",") for cell in row] for row in rows]
    table = "\n".join(",".join(row) for row in [names, *rows])
    table_with_commas = "\n".join(";".join(row) for row in [names, *with_commas])
    document = json.dumps([dict(zip(names, row, strict=True)) for row in rows])
    for text in (table, table_with_commas, document):
        path.write_text(text)
        take = read_take(path)
        assert take.channels["jawOpen"][-5:] == approx(values[-5:])
        assert take.channels["cheekPuff"] == approx(0.5)
        assert has_note(take.notes, "No face in")
