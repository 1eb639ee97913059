"""Exported curves: readers of recordings read them, and the face moves in the same way."""

import csv

import numpy as np
from pytest import approx

from risorius.app.export.clip import record
from risorius.app.export.formats import ExportRequest, format_for, write
from risorius.app.performances import read_performance
from risorius.app.playback import LEAD_TIME, Playback
from risorius.app.recordings.reading import read_take
from risorius.app.script.script_file import parse_script

RATE = 60.0  # frames per second
SHAPES = """
duration = 1.4
[[pose]]
time = 0.0
[[pose]]
time = 0.4
jawOpen = 0.4
mouthClose = 0.1
mouthSmileLeft = 0.8
gaze_horizontal = 0.5
[[pose]]
time = 0.8
mouthPucker = 0.6
eyeBlinkRight = 0.7
head_yaw = 0.5
head_pitch = -0.4
head_roll = 0.3
[[pose]]
time = 1.2
browInnerUp = 0.5
"""
AS_IT_IS = Playback(neutral="none", gains=("eyeBlink*=1",))  # for a face that needs no calibration


def script_of(text):
    """A script."""
    return parse_script(text, source="test")


def table(clip, path):
    """The columns of the CSV file of a clip; the timecode as seconds."""
    write(clip, path, format_for(path, None), ExportRequest(progress=False))
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    found = {}
    for number, column in enumerate(names):
        cells = [row[number] for row in rows]
        if column == "Timecode":
            parts = np.array([cell.split(":") for cell in cells], float)
            found[column] = parts @ [3600.0, 60.0, 1.0, 1.0 / 60.0]
        else:
            found[column] = np.array(cells, float)
    return found


def replayed(path, scene, playback):
    """The clip made from a recording."""
    script, _ = read_performance(path, playback, scene.limits)
    return record(script, scene, RATE, progress=False)


def apart(first, second):
    """Distance between two clips [mm]: largest, and root mean square."""
    count = min(first.frame_count, second.frame_count)
    off = np.linalg.norm(first.skin.shapes[:count] - second.skin.shapes[:count], axis=2)
    return float(off.max()), float(np.sqrt((off**2).mean()))


def test_arkit_plays_the_same_again(scene, tmp_path):
    """A replayed script of ARKit shapes, eyes and head is off by less than 0.5 mm."""
    clip = record(script_of(SHAPES), scene, RATE, progress=False)
    path = tmp_path / "take.csv"
    table(clip, path)
    take = read_take(path)
    assert take.kind == "Live Link Face"
    assert len(take.times) == clip.frame_count
    assert np.allclose(take.times, clip.times, atol=1e-4)
    again = replayed(path, scene, AS_IT_IS)
    furthest, usual = apart(clip, again)
    assert furthest < 0.5
    assert usual < 0.1
    for bone in ("eye_left", "cranium", "mandible"):
        off = np.abs(clip.bones[bone] - again.bones[bone])
        assert off[:, :3, :3].max() < 0.01, bone
    still = replayed(path, scene, Playback(neutral="none", gains=("all=0",)))
    assert apart(clip, still)[0] > 5.0


def test_arkit_shows_set_values(scene, tmp_path):
    """The file has the script's values, delayed like muscles, with Live Link Face's header."""
    clip = record(script_of(SHAPES), scene, RATE, progress=False)
    columns = table(clip, tmp_path / "take.csv")
    names = list(columns)
    assert names[:2] == ["Timecode", "BlendShapeCount"]
    assert len(names) == 63
    assert names[16:20] == ["JawForward", "JawRight", "JawLeft", "JawOpen"]
    assert np.allclose(columns["Timecode"], clip.times, atol=1e-4)
    assert set(columns["BlendShapeCount"]) == {61.0}
    for name in ("jawOpen", "mouthClose", "mouthSmileLeft", "mouthPucker", "browInnerUp"):
        asked = [clip.script.at(max(time - LEAD_TIME, 0.0))[name] for time in clip.times]
        assert np.allclose(columns[name[0].upper() + name[1:]], asked, atol=0.01), name
    assert columns["MouthSmileRight"].max() == 0.0
    assert columns["HeadYaw"].min() == approx(np.radians(-22.5), abs=0.02)
    assert columns["LeftEyeYaw"].min() == approx(np.radians(-15.0 - 4.0), abs=0.02)


def test_expressions_become_shapes(scene, tmp_path):
    """Controls other than shapes are approximated by shapes, and the result looks the same."""
    text = "duration = 0.6\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 0.6\njoy = 1.0\n"
    clip = record(script_of(text), scene, RATE, progress=False)
    path = tmp_path / "take.csv"
    columns = table(clip, path)
    assert columns["MouthSmileLeft"][-1] > 0.4
    assert np.allclose(columns["MouthSmileLeft"], columns["MouthSmileRight"], atol=1e-3)
    furthest, usual = apart(clip, replayed(path, scene, AS_IT_IS))
    assert furthest < 3.5
    assert usual < 0.6
