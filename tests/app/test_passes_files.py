"""Files of `capture --passes`: readable by other programs, complete or missing."""

import json
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from PIL import Image

from .command_line import risorius, succeeded

pytestmark = pytest.mark.usefixtures("shared_scenes")

ALL_PASSES = "depth,normal,triangle,splits,segmentation,landmarks"
CAPTURE_COMMAND = ("capture", "--size", "160x120", "--quiet", "--fps", "10")
SMILE_SCRIPT = """
title = "Smile"
[[pose]]
time = 0.0
[[pose]]
time = 0.2
AU12 = 1.0
"""


def channels_of(path):
    """All channels of an OpenEXR file, read by the library of the format."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: np.array(channel.pixels) for name, channel in file.channels().items()}


def names_in(folder):
    """The names of all files in a folder."""
    return sorted(path.name for path in folder.iterdir())


def test_every_frame_has_its_passes_beside_it(tmp_path):
    """Each frame has five files with the same picture, and their numbers agree."""
    script = tmp_path / "smile.toml"
    frames = tmp_path / "frames"
    script.write_text(SMILE_SCRIPT)
    succeeded(*CAPTURE_COMMAND, script, "--passes", ALL_PASSES, "-o", frames)
    ends = (".exr", ".json", ".png", "_ldmks.txt", "_seg.png")
    assert names_in(frames) == [f"frame_0000{k}{end}" for k in range(3) for end in ends]

    stem = frames / "frame_00002"
    channels = channels_of(Path(f"{stem}.exr"))
    assert {name: each.dtype.name for name, each in channels.items()} == {
        **dict.fromkeys(["depth.Z", "normal.X", "normal.Y", "normal.Z"], "float32"),
        **dict.fromkeys(["triangle.ID", "splits"], "uint32"),
    }
    depth = channels["depth.Z"]
    triangle = channels["triangle.ID"].astype(np.int32)
    assert depth.shape == (120, 160)
    assert 400.0 < depth.max() < 1500.0
    assert triangle.min() == -1
    assert 1500 < triangle.max() < 2030
    assert (channels["normal.Z"][depth > 0.0] < 0.0).mean() > 0.98  # folds tilt some normals
    classes = np.asarray(Image.open(f"{stem}_seg.png"))
    assert classes.dtype == np.uint8
    assert np.array_equal(classes > 0, depth > 0.0)
    colours = np.asarray(Image.open(f"{stem}.png")).astype(int)
    redness = colours[..., 0] - colours[..., 1]
    of_lips = redness[np.isin(classes, (10, 11))].mean()
    of_skin = redness[classes == 1].mean()
    assert of_lips > of_skin + 5.0

    labels = json.loads(Path(f"{stem}.json").read_text())
    pixels = np.loadtxt(f"{stem}_ldmks.txt")
    assert pixels.shape == (70, 2)
    assert np.abs(pixels - labels["landmarks"]["pixels"]).max() < 0.001
    points = np.array(labels["landmarks"]["points"])
    matrix, turn, shift = (np.array(labels["camera"][name]) for name in ("K", "R", "t"))
    seen = (points @ turn.T + shift) @ matrix.T
    assert np.abs(seen[:, :2] / seen[:, 2:] - pixels).max() < 0.001
    assert labels["controls"] == {"AU12": 1.0}
    assert "head" in labels
    assert "gaze" in labels


def test_only_requested_passes_are_written(tmp_path):
    """A picture with classes alone has no OpenEXR file, and no landmarks in its numbers."""
    target = tmp_path / "deep" / "joy.png"
    succeeded(*CAPTURE_COMMAND, "--set", "joy", "--passes", "segmentation", "-o", target)
    assert names_in(target.parent) == ["joy.json", "joy.png", "joy_seg.png"]
    assert "landmarks" not in json.loads((target.parent / "joy.json").read_text())


@pytest.mark.slow
def test_the_colours_are_those_without_passes(tmp_path):
    """Colours are the same to the last byte with passes and without; two runs are equal, too."""
    for name, passes in (
        ("a", ("--passes", ALL_PASSES)),
        ("b", ("--passes", ALL_PASSES)),
        ("c", ()),
    ):
        assert (
            risorius(
                *CAPTURE_COMMAND, "--set", "joy", *passes, "-o", tmp_path / f"{name}.png"
            ).exit_code
            == 0
        )
    for end in (".png", ".exr", "_seg.png", ".json"):
        assert (tmp_path / f"a{end}").read_bytes() == (tmp_path / f"b{end}").read_bytes()
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "c.png").read_bytes()


def test_no_input_is_written_over(tmp_path):
    """A picture take.png of a recording take.json is refused.

    The labels of this picture, take.json, would replace the recording.
    """
    recording = tmp_path / "take.json"
    recording.write_text("[]")
    result = risorius(*CAPTURE_COMMAND, recording, "--passes", "depth", "-o", tmp_path / "take.png")
    assert result.exit_code == 2
    assert "take.json: is both an input and an output" in result.output
    assert names_in(tmp_path) == ["take.json"]
    assert recording.read_text() == "[]"
