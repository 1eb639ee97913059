"""Takes in JSON: shapes from MediaPipe and pages with it, and speech as visemes."""

import json

import numpy as np
import pytest
from pytest import approx
from scipy.spatial.transform import Rotation

from risorius.app.errors import UserError
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.recordings.reading import is_recording, read_take

from .recording_files import has_note

NAMES = [name for name in sorted(ARKIT_SHAPES) if name != "tongueOut"]


def written(path, document):
    """Write the document to a file with the name of a recording; return its path."""
    path.write_text(json.dumps(document))
    assert is_recording(path)
    return path


def take_in(folder, document):
    """The take read from the document."""
    return read_take(written(folder / "take", document))


def categories(jaw, key="category_name", as_text=False):
    """MediaPipe's face landmarker result for one face."""
    scores = {name: jaw if name == "jawOpen" else 0.125 for name in ("_neutral", *NAMES)}
    return [
        {"index": number, "score": str(score) if as_text else score, key: name, "displayName": ""}
        for number, (name, score) in enumerate(scores.items())
    ]


@pytest.mark.parametrize("key", ["category_name", "categoryName"])
@pytest.mark.parametrize("as_text", [False, True])
def test_one_picture(key, as_text, tmp_path):
    """Both spellings of keys, and scores as numbers or texts, are read; `_neutral` is ignored."""
    take = take_in(tmp_path, categories(0.75, key, as_text))
    assert take.kind == "MediaPipe JSON"
    assert take.duration == 0.0
    assert set(take.channels) == set(NAMES)
    assert take.channels["jawOpen"] == approx([0.75])
    assert not take.unknown


JAW = [0.1, 0.2, 0.4, 0.3]
DOCUMENTS = {
    "a list of pictures": [categories(jaw) for jaw in JAW],
    "frames of faces": {"frames": [{"faceBlendshapes": [categories(jaw)]} for jaw in JAW]},
    "stamps in seconds": [
        {"time": number / 30.0, "blendshapes": {"jawOpen": jaw, "mouthClose": 0.125}}
        for number, jaw in enumerate(JAW)
    ],
    "stamps in milliseconds": {
        "frames": [
            {"timestampMs": 1000 + number * 100 / 3, "blendshapes": categories(jaw, "categoryName")}
            for number, jaw in enumerate(JAW)
        ]
    },
    "flat": [{"jawOpen": jaw, "mouthClose": 0.125, "frame": n} for n, jaw in enumerate(JAW)],
    "names and values": [
        {"time": number / 30.0, "blendshapes": [{"name": "jawOpen", "value": jaw}]}
        for number, jaw in enumerate(JAW)
    ],
    "names once in a head": {"metadata": {"fps": 30, "blendshapeNames": ["jawOpen"]},
                             "frames": [{"values": [jaw]} for jaw in JAW]},
    "columns and data": {"columns": ["time", "jawOpen"],
                         "data": [[number / 30.0, jaw] for number, jaw in enumerate(JAW)]},
    "names, and times beside rows": {"names": ["jawOpen"], "weights": [[jaw] for jaw in JAW],
                                     "time": [number / 30.0 for number in range(4)]},
    "lists over time": {"time": [number / 30.0 for number in range(4)], "jawOpen": JAW},
    "lists over time in a table": {"time": [number / 30.0 for number in range(4)],
                                   "blendshapes": {"jawOpen": JAW, "mouthClose": [0.1] * 4}},
    "columns under numbers of rows": {
        "timestamp_ms": {str(number): number * 100 / 3 for number in range(4)},
        "jawOpen": {str(number): jaw for number, jaw in enumerate(JAW)},
    },
    "an export of Audio2Face": {
        "exportFps": 30.0, "trackPath": "x", "numFrames": 4, "facsNames": ["jawOpen", "mouthClose"],
        "weightMat": [[jaw, 0.125] for jaw in JAW],
    },
}  # fmt: skip


@pytest.mark.parametrize("kind", DOCUMENTS)
def test_a_film(kind, tmp_path):
    """The take is the same however frames are packed."""
    take = take_in(tmp_path, DOCUMENTS[kind])
    assert take.channels["jawOpen"] == approx(JAW)
    assert take.times == approx(np.arange(4) / 30.0)


def test_columns_beside_shapes_are_read(tmp_path):
    """Columns beside shapes turn the head and mark rows without a face.

    Unknown columns are listed.
    """
    columns = ["jawOpen", "faceDetected", "headYaw", "mood"]
    rows = [[jaw, row != 1, 10.0 * row, 0.5] for row, jaw in enumerate(JAW)]
    over_time = dict(zip(columns, map(list, zip(*rows, strict=True)), strict=True))
    for document in ({"columns": columns, "data": rows}, over_time):
        take = take_in(tmp_path, document)
        assert take.channels.keys() == {"jawOpen", "head_yaw"}
        assert np.ptp(take.channels["head_yaw"]) == approx(30.0)
        assert take.channels["jawOpen"] == approx([0.1, 0.25, 0.4, 0.3])
        assert take.unknown == ("mood",)


def test_frames_without_a_face(tmp_path):
    """An empty list is a frame without a face."""
    frames = [{"faceBlendshapes": [categories(jaw)] if jaw else []} for jaw in (0.2, 0, 0.4)]
    take = take_in(tmp_path, {"frames": frames})
    assert take.channels["jawOpen"] == approx([0.2, 0.3, 0.4])
    assert has_note(take.notes, "No face in 1 of 3")


def test_several_faces(tmp_path):
    """With several faces the first is used; another one cannot be chosen."""
    frames = [{"faceBlendshapes": [categories(0.2), categories(0.6)]} for _ in range(3)]
    path = written(tmp_path / "take", frames)
    assert read_take(path).channels["jawOpen"] == approx([0.2] * 3)
    assert has_note(read_take(path).notes, "Up to 2 faces")
    with pytest.raises(UserError, match="names no faces"):
        read_take(path, face="1")


@pytest.mark.parametrize("layout", ["rows", "columns", "data"])
def test_the_matrix_of_the_head(layout, tmp_path):
    """A head turned 20 degrees to its left, in all layouts of MediaPipe's matrix."""
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_euler("y", 20.0, degrees=True).as_matrix()
    matrix[:3, 3] = [1.0, 2.0, -40.0]
    packed = {
        "rows": [matrix.tolist()],
        "columns": [matrix.T.ravel().tolist()],
        "data": [{"rows": 4, "columns": 4, "data": matrix.T.ravel().tolist()}],
    }[layout]
    frame = {"faceBlendshapes": [categories(0.2)], "facialTransformationMatrixes": packed}
    take = take_in(tmp_path, [frame] * 2)
    assert take.channels["head_yaw"] == approx([20.0] * 2)
    assert take.channels["head_pitch"] == approx([0.0] * 2, abs=1e-9)
    assert take.channels["head_roll"] == approx([0.0] * 2, abs=1e-9)


def test_the_nod_and_tilt_of_a_matrix(tmp_path):
    """A nod up and a tilt to the left shoulder are positive; x is to the subject's left, y up."""
    nod = Rotation.from_euler("x", -10.0, degrees=True).as_matrix()
    roll = Rotation.from_euler("z", -15.0, degrees=True).as_matrix()
    for turn, name, angle in ((nod, "head_pitch", 10.0), (roll, "head_roll", 15.0)):
        matrix = np.eye(4)
        matrix[:3, :3] = turn
        frame = {"blendshapes": categories(0.2), "matrix": matrix.tolist()}
        take = take_in(tmp_path, [frame])
        assert take.channels[name] == approx([angle])


@pytest.mark.parametrize(
    "text",
    ["{", "[[[", '{"category_name"', '{"a": 1}', "[]", "{}", "[1, 2]", '{"frames": 3}',
     '[{"category_name": "jawOpen"}]', '{"blendshapes": []}', '{"jawOpen": []}', "[" * 100_000,
     '{"jawOpen": "wide"}', '{"channels": []}', '{"frames": [{"blendshapes": null}]}',
     '{"jawOpen": ' + "9" * 5000 + "}"],
)  # fmt: skip
def test_json_of_something_else(text, tmp_path):
    """JSON with other content is refused in one line with the fault."""
    path = tmp_path / "take"
    path.write_text(text)
    with pytest.raises(UserError, match="take"):
        read_take(path)


# Visemes.


def tracks():
    """A word in OpenFaceFX's format: silence, aa, PP, oh, silence, with overlapping weights."""
    keys = {
        "sil": [[0.0, 0.44], [0.2, 0.0], [0.8, 0.0], [1.0, 0.44]],
        "aa": [[0.0, 0.3], [0.2, 0.8], [0.4, 0.4], [0.6, 0.1]],
        "PP": [[0.2, 0.05], [0.4, 0.42], [0.6, 0.05]],
        "O": [[0.0, 0.2], [0.4, 0.1], [0.6, 0.7], [1.0, 0.3]],
        "tail": [[0.0, 1.0]],
    }
    return {
        "format": "openfacefx.track", "version": 1, "fps": 60, "duration": 1.0,
        "viseme_set": list(keys), "channels": [{"name": n, "keys": k} for n, k in keys.items()],
    }  # fmt: skip


def test_tracks_of_visemes(tmp_path):
    """OpenFaceFX's I, O, U become ih, oh, ou; lips meet at PP, and silence moves nothing."""
    take = take_in(tmp_path, tracks())
    assert take.kind == "Viseme tracks"
    assert take.is_calibrated
    assert take.unknown == ("tail",)
    assert set(take.channels) == {"viseme_sil", "viseme_aa", "viseme_PP", "viseme_oh"}
    at = list(take.times).index(0.4)
    assert take.channels["viseme_PP"][at] == approx(1.0)
    assert take.channels["viseme_sil"][0] == approx(1.0)
    assert take.channels["viseme_aa"][0] == approx(0.0, abs=1e-9)
    assert take.channels["viseme_oh"][-1] == approx(0.0, abs=1e-9)
    assert take.channels["viseme_aa"][list(take.times).index(0.2)] == approx(0.8)


@pytest.mark.parametrize(
    "keys", [3, [1], [[0.0]], [["a", 1]], [[0.0, None]], [[0, True]], [{"time": 0}], [[1e300, 0]]]
)
def test_wrong_keys(keys, tmp_path):
    """The message names the channel of wrong keys."""
    document = {"channels": [{"name": "aa", "keys": [[0, 1]]}, {"name": "PP", "keys": keys}]}
    path = tmp_path / "take"
    path.write_text(json.dumps(document))
    with pytest.raises(UserError, match="'channels' 2, 'keys'"):
        read_take(path)


CUES = [(0.0, "X"), (0.4, "A"), (0.5, "D"), (1.0, "F"), (1.4, "X")]


def test_mouth_shapes_of_rhubarb(tmp_path):
    """Each mouth shape holds, and changes to the next around its start."""
    ends = [start for start, _ in CUES[1:]] + [1.6]
    cues = [
        {"start": start, "end": end, "value": value}
        for (start, value), end in zip(CUES, ends, strict=True)
    ]
    document = {"metadata": {"soundFile": "a.wav", "duration": 1.6}, "mouthCues": cues}
    take = take_in(tmp_path, document)
    assert take.kind == "Rhubarb Lip Sync"

    def value(name, time):
        """Value of a channel at a time."""
        return float(np.interp(time, take.times, take.channels[name]))

    assert take.channels.keys() == {f"viseme_{sound}" for sound in ("sil", "PP", "aa", "ou")}
    assert value("viseme_PP", 0.45) == approx(1.0)
    assert value("viseme_aa", 0.75) == approx(0.9)
    assert value("viseme_aa", 0.5) == approx(0.45)
    assert value("viseme_ou", 1.2) == approx(0.9)
    assert value("viseme_sil", 0.2) == approx(1.0)
    assert np.all(np.diff(take.times) > 0.0)


@pytest.mark.parametrize(
    ("cues", "words"),
    [([], "no mouth cues"), ([3], "'mouthCues' 1"), ([{"start": 0}], "'value': is missing"),
     ([{"start": 0, "value": "Q"}], "'Q', must be one of A, B, C"),
     ([{"start": "x"}], "'start': was 'x', must be a number")],
)  # fmt: skip
def test_wrong_mouth_shapes(cues, words, tmp_path):
    """The message has the number of the cue, and the allowed names."""
    with pytest.raises(UserError, match=words):
        take_in(tmp_path, {"mouthCues": cues})
