"""Reports on recordings: only true statements, and everything that was left out."""

import json

import numpy as np
import pytest

from risorius.app.performances import read_performance
from risorius.app.recordings.calibration import calibration_for
from risorius.app.recordings.reading import read_take
from risorius.app.recordings.report import report_of

from .recording_files import has_note, openface, written

CUES = [(0.0, 0.1, "X"), (0.1, 0.2, "B"), (0.2, 2.2, "A"), (2.2, 2.3, "D"), (2.3, 3.0, "X")]


def rhubarb(path, sound=None):
    """Rhubarb's output for these cues; one cue lasts two seconds."""
    metadata = {"duration": 3.0}
    if sound is not None:
        metadata["soundFile"] = sound
    cues = [{"start": start, "end": end, "value": mouth} for start, end, mouth in CUES]
    path.write_text(json.dumps({"metadata": metadata, "mouthCues": cues}))
    return path


def lines_of(path):
    """The lines of the report on a recording."""
    take = read_take(path)
    return "\n".join(report_of(take, calibration_for(take)).lines)


def test_cues_are_keys(tmp_path):
    """A held mouth shape is not reported as a gap, and keys have no rate."""
    report = lines_of(rhubarb(tmp_path / "take.json"))
    assert "keys in 3.00 s" in report
    assert "a second" not in report
    assert "missing in" not in report


def test_keys_of_visemes_far_apart(tmp_path):
    """Between two keys a track of a viseme is straight, however far apart they are."""
    keys = [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0], [0.3, 0.0], [4.3, 0.9]]
    path = tmp_path / "take.json"
    path.write_text(json.dumps({"channels": [{"name": "aa", "keys": keys}]}))
    take = read_take(path)
    assert np.interp(2.3, take.times, take.channels["viseme_aa"]) == pytest.approx(0.45)
    assert "missing in" not in lines_of(path)


def script_of(path):
    """The script made from a recording."""
    script, _ = read_performance(path)
    return script


@pytest.mark.parametrize("name", ["voice.wav", "sounds/voice.wav", "C:\\takes\\voice.wav", "full"])
def test_the_sound_of_rhubarb(name, tmp_path):
    """The sound file that Rhubarb names is found at its path, or beside the recording."""
    sound = tmp_path / ("sounds/voice.wav" if name == "sounds/voice.wav" else "voice.wav")
    sound.parent.mkdir(exist_ok=True)
    sound.write_bytes(b"RIFF")
    path = rhubarb(tmp_path / "take.json", str(sound) if name == "full" else name)
    assert script_of(path).sound == sound
    assert has_note(read_take(path).notes, "The sound is 'voice.wav'")


def test_a_missing_sound(tmp_path):
    """A missing sound is named, and the mouth moves without it."""
    path = rhubarb(tmp_path / "take.json", "gone.wav")
    assert script_of(path).sound is None
    assert "The sound file 'gone.wav' is not there; --sound names another." in lines_of(path)


def test_time_stamps_of_no_use(tmp_path):
    """Unusable time stamps are reported, but not as missing times."""
    report = lines_of(written(tmp_path / "take.csv", openface() | {"timestamp": [0.0] * 60}))
    assert "The time stamps do not rise, and were not used." in report
    assert "Instead 30 frames a second were assumed." in report
    assert "No times are given" not in report


def test_one_of_a_kind(tmp_path):
    """A single place, row, cell or value is reported in the singular."""
    times = [*np.arange(30) / 30.0, *(3.0 + np.arange(30) / 30.0)]
    jaw = [0.5] * 60
    times[5] = ""
    jaw[20] = "wide"
    jaw[40] = 50.0
    report = lines_of(written(tmp_path / "take.csv", {"time": times, "jawOpen": jaw}))
    assert "Rows are missing in 1 place, " in report
    assert "1 row without a time was left out" in report
    assert "1 cell holds no usable number" in report
    assert "1 value of shapes is far from 0 to 1 and was left out" in report


def test_all_notes_are_shown(tmp_path):
    """Any number of notes is printed."""
    columns = openface() | {"timestamp": [0.0] * 60, "frame": list(range(0, 120, 2))}
    columns["AU12_r"] = ["wide", *([2.0] * 59)]
    columns["success"] = [*([1] * 50), *([0] * 10)]
    path = written(tmp_path / "take.csv", columns)
    take = read_take(path)
    assert len(take.notes) > 6
    assert len(report_of(take, calibration_for(take)).notes) == len(take.notes)
