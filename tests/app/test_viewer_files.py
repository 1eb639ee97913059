"""Files that come into the window and leave it, driven as a desktop would."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from app.viewer import Viewer

from .driving import NEEDS_A_SCREEN, nose, settle, until

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]

SCRIPT = "duration = 2.0\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = 2.0\njoy = 1.0\n"
POSE = "duration = 1.0\n[[pose]]\ntime = 0.0\njaw_open = 0.5\n"


def drop(viewer: Viewer, *paths: Path) -> None:
    """Let another program drop files onto the face; the window must have taken them."""
    command = [sys.executable, "-m", "tests.app.dropping", "Risorius", *map(str, nose(viewer))]
    source = subprocess.Popen(
        [*command, *map(str, paths)], stderr=subprocess.PIPE, text=True,
        cwd=Path(__file__).parents[2],
    )  # fmt: skip
    assert until(viewer, lambda: source.poll() is not None, 20.0)
    assert source.returncode == 0, source.communicate()[1]
    settle(viewer)


def test_files_can_be_dropped_onto_the_window(viewer: Viewer, tmp_path: Path) -> None:
    """A script, then a pose with an awkward name, from another program, by the X protocol."""
    script, pose = tmp_path / "smile.toml", tmp_path / "schöner & 50% größer.toml"
    script.write_text(SCRIPT)
    pose.write_text(POSE)
    drop(viewer, script)
    assert viewer.session.script.duration == 2.0
    assert "smile.toml" in viewer.messages.text and not viewer.messages.is_error
    drop(viewer, pose)
    assert viewer.session.values["jaw_open"] == 0.5
    assert viewer.session.script.duration == 2.0


def test_a_bad_file_dropped_is_told_and_survived(viewer: Viewer, tmp_path: Path) -> None:
    """Nonsense shows one line in the window, which goes on; the script that was there stays."""
    before, bad = viewer.session.script, tmp_path / "bad.toml"
    bad.write_text(POSE.replace("jaw_open", "no_such_muscle"))
    drop(viewer, bad)
    assert viewer.messages.is_error and "no_such_muscle" in viewer.messages.text
    assert "\n" not in viewer.messages.text and "message" in viewer.gui.places
    bad.write_bytes(bytes(range(256)))
    drop(viewer, bad)
    assert "cannot be read" in viewer.messages.text
    drop(viewer, tmp_path)
    assert viewer.messages.is_error and viewer.session.script is before
    bad.write_text(POSE)
    drop(viewer, bad)
    assert viewer.session.values["jaw_open"] == 0.5
