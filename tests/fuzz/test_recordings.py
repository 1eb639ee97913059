"""Recordings: good ones of every format, and hundreds with random damage."""

import json
import random

import numpy as np
import pytest

from risorius.app.errors import UserError
from risorius.app.recordings.names import ANGLE_NAMES, ARKIT_SHAPES, LARGEST_VALUE, VISEME_NAMES
from risorius.app.recordings.reading import is_recording, read_take
from tests.app.recording_files import live_link, openface, pyfeat, table

from .damage import SEED, changed
from .sandbox import bounded, check_line

pytestmark = pytest.mark.slow

ROUNDS = 1000
PICTURE_SCORES = [
    {"category_name": "jawOpen", "score": "0.5"},
    {"category_name": "cheekPuff", "score": 0},
]
SPEECH_TRACKS = {"channels": [{"name": "PP", "keys": [[0, 0.1], [0.2, 0.4], [0.4, 0]]}]}
CUES = {"mouthCues": [{"start": 0.0, "end": 0.2, "value": "A"}, {"start": 0.2, "value": "X"}]}
FILM_FRAMES = {"frames": [{"t": n / 30, "blendshapes": {"jawOpen": n / 9}} for n in range(9)]}
SIDED_COLUMNS = {"time": np.arange(9) / 30, "mouthSmile_L": np.arange(9) / 9, "AU12_L": np.zeros(9)}
READABLE_FILES = {
    "Live Link Face": table(live_link(20)).encode(),
    "OpenFace": table(openface(20)).encode(),
    "py-feat": table(pyfeat(10)).encode(),
    "named columns": table(SIDED_COLUMNS).encode(),
    "a picture": json.dumps(PICTURE_SCORES).encode(),
    "a film": json.dumps(FILM_FRAMES).encode(),
    "tracks": json.dumps(SPEECH_TRACKS).encode(),
    "cues": json.dumps(CUES).encode(),
}
TOKENS = (
    b"nan", b"inf", b"-1", b"1e400", b"9" * 400, b"-9.8e5", b"1e308", b"null", b"true", b"AU12",
    b'"', b"'", b",", b";", b"\t", b"\n", b"\n\n", b"\r", b":", b"::", b"{", b"[", b"}", b"]",
    b"{}", b"[]", b"\x00", b"\xff", b"\xef\xbb\xbf", b"time", "\u202e".encode(),
)  # fmt: skip


def check(take):
    """Check the properties of every Take, for any content of the file."""
    assert len(take.times) > 0
    assert take.times[0] == 0.0
    assert np.isfinite(take.times).all()
    assert np.all(np.diff(take.times) > 0.0)
    assert take.channels
    for name, values in take.channels.items():
        assert values.shape == take.times.shape, name
        assert np.isfinite(values).all(), name
        if name not in ANGLE_NAMES:
            assert name in (*ARKIT_SHAPES, *VISEME_NAMES) or name.startswith("AU"), name
            assert np.abs(values).max() <= LARGEST_VALUE, name  # trackers overshoot a little
    assert all(note.endswith(".") for note in take.notes)


@pytest.mark.parametrize("name", READABLE_FILES)
def test_good_recordings(name, tmp_path):
    """Undamaged recordings are read; otherwise damage in the next tests would have no effect."""
    path = tmp_path / "take"
    path.write_bytes(READABLE_FILES[name])
    assert is_recording(path)
    check(read_take(path))


def damaged(chance):
    """A good recording with a few places changed, more often near its beginning."""
    content = bytearray(READABLE_FILES[chance.choice(sorted(READABLE_FILES))])
    if chance.random() < 0.2:
        content = content[: chance.randrange(len(content))]
    return changed(content, chance, TOKENS, reaches=(200, 2000, 2**30))


def test_damaged_recordings(tmp_path):
    """Each damaged recording is read, or refused in one line; a good part of them is read."""
    path = tmp_path / "take"
    read = 0
    for seed in range(SEED, SEED + ROUNDS):
        path.write_bytes(damaged(random.Random(seed)))
        try:
            with bounded():
                is_recording(path)
                take = read_take(path)
        except UserError as error:
            check_line(str(error))
            continue
        check(take)
        read += 1
    assert read > ROUNDS // 10
