"""File > Export motion, driven with mouse and keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from risorius.app.export.clip import record
from risorius.app.motion import scene_of
from risorius.app.script import load_script, parse_script
from risorius.app.viewer import Viewer

from .driving import NEEDS_A_SCREEN, click, drop, until, write, xdotool

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]

SCRIPT = "duration = 0.5\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 0.5\njoy = 1.0\n"


def test_the_script_is_exported_by_the_menu(viewer: Viewer, tmp_path: Path) -> None:
    """What `risorius export` writes; the face in the window and its script stay as they are."""
    script = tmp_path / "smile.toml"
    script.write_text(SCRIPT)
    drop(viewer, script)
    before = viewer.session.scene.positions.copy()
    click(viewer, "menu File")
    click(viewer, "menu File: Export motion ...")
    assert viewer.files.request is not None
    assert viewer.files.request.proposed.name.startswith("smile.")
    xdotool(viewer, "key", "ctrl+a")
    write(viewer, "moved.npz")
    xdotool(viewer, "key", "Return")
    assert until(viewer, lambda: "16 frames written" in viewer.messages.text, 60.0)
    assert not viewer.messages.is_error and np.allclose(viewer.session.scene.positions, before)
    played = load_script(script)
    clip = record(played, scene_of(played), 30.0, progress=False)
    with np.load(tmp_path / "moved.npz") as arrays:
        assert np.array_equal(arrays["positions"], clip.skin.shapes)


def test_a_pose_is_held_where_there_is_no_script(viewer: Viewer, tmp_path: Path) -> None:
    """After New script what is exported is the face as it is set."""
    xdotool(viewer, "key", "ctrl+n")
    viewer.session.set("jaw_open", 0.5)
    xdotool(viewer, "key", "ctrl+e")
    xdotool(viewer, "key", "ctrl+a")
    write(viewer, "pose.csv")
    xdotool(viewer, "key", "Return")
    assert until(viewer, lambda: "frames written" in viewer.messages.text, 60.0)
    rows = [line.split(",") for line in (tmp_path / "pose.csv").read_text().splitlines()]
    jaw = rows[0].index("JawOpen")
    assert {float(row[jaw]) for row in rows[1:]} == {0.5}
    assert viewer.session.values["jaw_open"] == 0.5


def test_what_cannot_be_exported_is_told(viewer: Viewer, tmp_path: Path) -> None:
    """A suffix that is none, and a folder that takes no files, are one line in the window."""
    viewer.session.open(parse_script(SCRIPT, source="smile.toml"))
    for name, words in (("x.jpeg", "what is '.jpeg'?"), ("/proc/none/x.npz", "cannot be written")):
        viewer.messages.text = ""
        xdotool(viewer, "key", "ctrl+e")
        xdotool(viewer, "key", "ctrl+a")
        write(viewer, name)
        xdotool(viewer, "key", "Return")
        assert until(viewer, lambda words=words: words in viewer.messages.text, 10.0), words
        assert viewer.messages.is_error and "\n" not in viewer.messages.text
        assert not viewer.motion_export.has_announced
