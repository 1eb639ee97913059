"""Takes of OpenFace and py-feat, and of tables with other names for shapes and units."""

import numpy as np
import pytest
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.recordings.reading import read_take

from .recording_files import has_note, openface, pyfeat, pyfeat_2, table, take_in, written

# OpenFace.


def test_openface(tmp_path):
    """Units are from 0 to 5, or detections without intensity; angles have the project's signs."""
    columns = openface()
    take = take_in(tmp_path, columns)
    assert take.kind == "OpenFace 2"
    assert not take.unknown
    assert take.times == approx(np.arange(60) / 30.0, abs=1e-6)
    smile = np.array(columns["AU12_r"]) / 5.0
    assert take.channels["AU12"] == approx(smile, abs=1e-6)
    assert np.all(take.channels["AU1"] <= 0.0), "a negative intensity is none"
    assert set(take.channels["AU28"]) == {0.0, 1.0}
    assert set(take.channels) == {
        "AU1", "AU12", "AU45", "AU28", "head_yaw", "head_pitch", "head_roll",
        "eye_yaw_left", "eye_yaw_right", "eye_pitch_left", "eye_pitch_right",
    }  # fmt: skip
    for ours, theirs, sign in (
        ("head_pitch", "pose_Rx", -1.0),
        ("head_yaw", "pose_Ry", -1.0),
        ("head_roll", "pose_Rz", 1.0),
    ):
        there = sign * np.degrees(np.array(columns[theirs], dtype=float))
        assert take.channels[ours] == approx(there, abs=1e-3)


def test_openface_sees_the_gaze_from_the_camera(tmp_path):
    """Eyes that stay on the camera turn against the head, and look ahead in the middle."""
    columns = openface()
    take = take_in(tmp_path, columns)
    head = take.channels["head_yaw"]
    eye = take.channels["eye_yaw_left"]
    assert np.ptp(head + eye) < 1e-3
    up = -np.degrees(np.array(columns["gaze_angle_y"], dtype=float))
    assert np.ptp(take.channels["head_pitch"] + take.channels["eye_pitch_left"] - up) < 1e-3
    assert np.median(eye) == approx(0.0, abs=1e-9)
    assert has_note(take.notes, "camera")


def test_openface_1(tmp_path):
    """OpenFace 1 files are read: no face_id or gaze_angle, blanks before names.

    Gaze is computed from the vectors of both eyes.
    """
    columns = openface()
    for name in ("face_id", "gaze_angle_x", "gaze_angle_y"):
        del columns[name]
    turn = np.array(columns["pose_Ry"], dtype=float)
    columns |= {"gaze_0_x": np.full(60, -0.1), "gaze_1_x": np.full(60, 0.1)}
    for eye in "01":
        columns |= {f"gaze_{eye}_y": np.full(60, 0.2), f"gaze_{eye}_z": np.full(60, -0.97)}
    path = tmp_path / "take.csv"
    header, _, rows = table(columns).partition("\n")
    path.write_text(header.replace(",", ", ") + "\n" + rows)
    take = read_take(path)
    assert take.kind == "OpenFace 1"
    assert not take.unknown
    eye = take.channels["eye_yaw_right"]
    assert eye == approx(np.degrees(turn - np.median(turn)), abs=1e-3)


@pytest.mark.parametrize(("unit", "name"), [(1e3, "milli"), (1e6, "micro"), (1e9, "nano")])
def test_stamps_in_other_units(unit, name, tmp_path):
    """Time stamps in s, ms, us or ns are recognised by their steps."""
    columns = openface()
    columns["timestamp"] = [round(stamp * unit) for stamp in np.arange(60) / 30.0]
    take = take_in(tmp_path, columns)
    assert take.duration == approx(59 / 30.0, abs=1e-3)
    assert has_note(take.notes, name)


def test_no_face_at_all(tmp_path):
    """A recording without any face is refused."""
    path = written(tmp_path / "take.csv", openface() | {"success": [0] * 60})
    with pytest.raises(UserError, match="no frame shows a face"):
        read_take(path)


def test_rows_of_nan(tmp_path):
    """Cells without a number are gaps."""
    columns = openface()
    cells = list(np.full(60, 2.0))
    cells[10:14] = ["nan", "inf", "NaN", "1e99"]
    take = take_in(tmp_path, columns | {"AU12_r": cells})
    assert has_note(take.notes, "4 cells hold no usable number")
    cells[11] = ""
    cells[20] = "two"
    take = take_in(tmp_path, columns | {"AU12_r": cells})
    assert take.channels["AU12"] == approx(0.4)
    assert has_note(
        take.notes, "5 cells hold no usable number, the first in line 12, column 'AU12_r'"
    )


def test_several_faces(tmp_path):
    """With several faces, the one in most rows is used, or the chosen one."""
    one = openface()
    other = openface(20)
    header, *rows = table(one).splitlines()
    _, *more_rows = table(other | {"face_id": [3] * 20}).splitlines()
    path = tmp_path / "take.csv"
    path.write_text("\n".join([header, *rows, *more_rows]))
    take = read_take(path)
    assert len(take.times) == 60
    assert has_note(take.notes, "2 faces are in the file; '0'")
    assert len(read_take(path, face="3").times) == 20
    with pytest.raises(UserError, match=r"no face '7'; in it are '0', '3'"):
        read_take(path, face="7")
    path = written(tmp_path / "empty.csv", one | {"face_id": ["nan"] * 60})
    with pytest.raises(UserError, match="no face '0'; no row of it names one"):
        read_take(path, face="0")


def test_pyfeat_1(tmp_path):
    """Frame numbers are the times.

    Head angles are in degrees: up, right, left shoulder are positive.
    """
    take = take_in(tmp_path, pyfeat())
    assert take.kind == "py-feat 1"
    assert not take.unknown
    assert take.duration == approx(19 / 30.0)
    assert take.channels["AU12"][-1] == approx(0.9)
    assert take.channels["head_pitch"][-1] == approx(10.0)
    assert take.channels["head_yaw"][-1] == approx(-20.0)
    assert take.channels["head_roll"][-1] == approx(3.0)
    assert has_note(take.notes, "degrees")


def test_pyfeat_2(tmp_path):
    """Rows are every other frame, angles are in radians; units replace missing shapes only."""
    take = take_in(tmp_path, pyfeat_2())
    assert take.kind == "py-feat 2"
    assert not take.unknown
    assert take.duration == approx(38 / 30.0)
    assert take.channels["mouthSmileLeft"][-1] == approx(0.5)
    assert take.channels["head_pitch"][-1] == approx(-10.0, abs=1e-3)
    assert take.channels["head_yaw"][-1] == approx(-20.0, abs=1e-3)
    assert take.channels["head_roll"][-1] == approx(-3.0, abs=1e-3)
    assert "AU12" not in take.channels
    assert "cheekSquintLeft" not in take.channels
    assert take.channels["AU6"] == approx(0.4)
    assert has_note(take.notes, "the shapes were used, and AU6 and AU9")
    assert has_note(take.notes, "one in 2 frames")


def test_pyfeat_names_persons(tmp_path):
    """Faces named Person_0 and so on, in alternating rows, are separated."""
    columns = pyfeat_2(20)
    columns["Identity"] = ["Person_0", "Person_1"] * 10
    columns["frame"] = np.repeat(np.arange(10), 2).tolist()
    take = read_take(written(tmp_path / "take.csv", columns), face="Person_1")
    assert len(take.times) == 10
    assert take.channels["jawOpen"] == approx(np.linspace(0.0, 0.5, 20)[1::2], abs=1e-6)


# Named columns.


@pytest.mark.parametrize(
    "spelled",
    ["mouthSmileLeft", "MouthSmileLeft", "mouthSmile_L", "MOUTHSMILE_LEFT", "mouth_smile_left",
     "blendShapes.mouthSmileLeft", "head:mouthSmile_L", "head|mouthSmile_L",
     " mouthSmileLeft ", "Mouth Smile Left"],
)  # fmt: skip
def test_spellings_of_a_shape(spelled, tmp_path):
    """Capitals, underscores, blanks, and text before the last dot make no difference."""
    columns = {"time": np.arange(5) / 30.0, spelled: np.arange(5) / 10.0}
    take = take_in(tmp_path, columns)
    assert take.channels.keys() == {"mouthSmileLeft"}
    assert take.channels["mouthSmileLeft"] == approx(np.arange(5) / 10.0)


@pytest.mark.parametrize(
    ("spelled", "meant"),
    [
        (["AU12"], ["AU12"]),
        (["au6", "AU_07"], ["AU6", "AU7"]),
        (["AU12_L", "AU12_R"], ["AU12_left", "AU12_right"]),
        (["AU12_left", "AU12right", "AU4"], ["AU12_left", "AU12_right", "AU4"]),
        (["viseme_PP", "viseme_O", "viseme_I"], ["viseme_PP", "viseme_oh", "viseme_ih"]),
    ],
)
def test_spellings_of_units_and_visemes(spelled, meant, tmp_path):
    """`_R` means the right side if there is a left side."""
    columns = {name: np.full(3, 0.1 + place / 10.0) for place, name in enumerate(spelled)}
    take = take_in(tmp_path, columns)
    first_values = {name: values[0] for name, values in take.channels.items()}
    assert first_values == approx({name: 0.1 + place / 10.0 for place, name in enumerate(meant)})


@pytest.mark.parametrize("largest", [1.0, 5.0])
def test_units_of_action_units(largest, tmp_path):
    """Action units may be from 0 to 1, or from 0 to 5 (A to E)."""
    columns = {"t": np.arange(11) / 30.0, "AU12": np.linspace(0.0, largest, 11)}
    take = take_in(tmp_path, columns)
    assert take.channels["AU12"] == approx(np.linspace(0.0, 1.0, 11))
    assert has_note(take.notes, "divided") == (largest > 1.0)


def test_a_table_of_something_else(tmp_path):
    """A table of unknown columns has another message than a file without a table."""
    path = written(tmp_path / "take.csv", {"date": ["x"] * 3, "price": [1.0] * 3})
    with pytest.raises(UserError, match=r"no column is known \('date', 'price'.*Live Link Face"):
        read_take(path)
