"""Recordings of faces in the window: dropped, opened by the menu, played, saved as scripts."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from risorius.app.script import load_script
from risorius.app.viewer import Viewer
from tests.heads import stranger

from .driving import NEEDS_A_SCREEN, click, drop, moved, until, xdotool

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def written(path: Path) -> Path:
    """A table of a jaw that opens within a second, and of a column that nobody knows."""
    rows = [f"{k / 30:.4f},{k / 60:.4f},7" for k in range(31)]
    path.write_text("\n".join(["time,jawOpen,mood", *rows]), encoding="utf-8")
    return path


def test_a_recording_is_dropped_played_and_saved_as_a_script(
    viewer: Viewer, tmp_path: Path
) -> None:
    """The window says as what it was taken; unsaved work is asked about before; saving asks where.

    The recording itself is never written.
    """
    take = written(tmp_path / "take.csv")
    before = take.read_bytes()
    viewer.session.set("jaw_open", 0.4)
    drop(viewer, take)
    assert viewer.question.is_open and viewer.session.has_unsaved_pose
    click(viewer, "question: Open without saving")
    assert "take.csv: Table of named columns, 31 frames in 1.00 s" in viewer.messages.text
    assert viewer.session.script.duration == pytest.approx(1.0)
    assert not viewer.session.unsaved, "the file has it all"
    viewer.session.seek(1.0)
    assert until(viewer, lambda: moved(viewer) > 5.0)
    xdotool(viewer, "key", "ctrl+s")
    assert viewer.files.is_waiting
    xdotool(viewer, "key", "Return")
    saved = load_script(tmp_path / "take.toml")
    assert saved.at(0.5)["jawOpen"] == pytest.approx(viewer.session.script.at(0.5)["jawOpen"])
    assert take.read_bytes() == before


@pytest.mark.slow
def test_json_is_a_recording_or_landmarks_by_what_it_holds(viewer: Viewer, tmp_path: Path) -> None:
    """Scores of a tracker are played, on a head that is dropped with them if there is one."""
    scores = [{"categoryName": "jawOpen", "score": 0.5}, {"categoryName": "_neutral", "score": 0}]
    picture = tmp_path / "scores.json"
    picture.write_text(json.dumps(scores))
    drop(viewer, picture)
    assert "one frame" in viewer.messages.text and not viewer.messages.is_error
    assert viewer.session.values["jawOpen"] == 0.5
    before = viewer.session.scene
    mesh, landmarks = stranger().write(tmp_path)
    try:
        drop(viewer, landmarks, picture, mesh)
        assert until(viewer, lambda: viewer.session.scene is not before)
        assert "with stranger" in viewer.messages.text
        assert viewer.session.values["jawOpen"] == 0.5
    finally:
        viewer.show_scene(before)


def test_a_recording_is_opened_by_the_menu(viewer: Viewer, tmp_path: Path) -> None:
    """The chooser lists tables beside scripts; a broken one is told, and the script stays."""
    written(tmp_path / "take.csv")
    (tmp_path / "broken.csv").write_text("jawOpen\nwide\n")
    before = viewer.session.script
    xdotool(viewer, "key", "ctrl+o")
    click(viewer, "file broken.csv", times=2)
    assert viewer.messages.is_error and "broken.csv" in viewer.messages.text
    assert viewer.session.script is before
    xdotool(viewer, "key", "ctrl+o")
    click(viewer, "file take.csv", times=2)
    np.testing.assert_allclose(viewer.session.script.duration, 1.0, atol=1e-6)
