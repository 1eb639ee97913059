"""What somebody met who used the window for the first time, with real mouse and keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from risorius.app.viewer import Viewer
from risorius.app.viewer.overlays import pointed_lines
from risorius.app.viewer.settings import ExportChoices

from .driving import (
    NEEDS_A_SCREEN,
    click,
    middle,
    nose,
    on_screen,
    settle,
    show_controls,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def test_escape_closes_a_menu_whose_submenu_is_pointed_at(viewer: Viewer) -> None:
    """The mouse on History, which opens what Escape just closed, keeps nothing open."""
    xdotool(viewer, "key", "n")
    click(viewer, "menu Edit")
    xdotool(viewer, "mousemove", *middle(viewer, "menu Edit: History"))
    assert until(viewer, lambda: imgui.get_current_context().open_popup_stack.size() == 2)
    xdotool(viewer, "key", "Escape")
    settle(viewer)
    assert not viewer.gui.has_popup


def test_the_bar_of_one_side_shows_the_muscles_of_that_side(viewer: Viewer) -> None:
    """Where an expression has a bar for each side, each draws its own muscles into the face."""
    show_controls(viewer, "joy")
    xdotool(viewer, "key", "Return")
    click(viewer, "sides joy")
    xdotool(viewer, "mousemove", *middle(viewer, "joy_left"))
    assert until(viewer, lambda: "zygomaticus_major_left" in viewer.view.pointed)
    assert "zygomaticus_major_right" not in viewer.view.pointed
    xdotool(viewer, "mousemove", *middle(viewer, "show joy"))
    assert until(viewer, lambda: "zygomaticus_major_right" in viewer.view.pointed)


def test_a_hovered_expression_lights_what_does_it(viewer: Viewer) -> None:
    """A kiss lights the lips and no forehead; a clicked muscle is seen while it is named."""
    xdotool(viewer, "mousemove", *middle(viewer, "show kiss"))
    assert until(viewer, lambda: "orbicularis_oris_sphincter" in viewer.view.pointed)
    scene, shares = viewer.session.scene, viewer.view.pointed
    drawn = pointed_lines(scene, shares)
    brows = scene.rest_positions[scene.head.landmarks[27], 1]
    points = np.concatenate([line for lines in drawn for line in lines.polylines])
    assert len(drawn) >= 6 and points[:, 1].max() < brows
    assert max(lines.opacity for lines in drawn) > 0.8 > min(lines.opacity for lines in drawn)
    xdotool(viewer, "mousemove", *on_screen(viewer, 880, 300))
    assert until(viewer, lambda: not viewer.view.pointed)
    x, y = nose(viewer)
    xdotool(viewer, "mousemove", x + 40, y, "click", 1)
    assert until(viewer, lambda: bool(viewer.muscle_note.name))
    assert until(viewer, lambda: viewer.muscle_note.name in viewer.view.pointed)
    xdotool(viewer, "key", "Escape")


def test_enter_opens_the_file_that_was_clicked(viewer: Viewer, tmp_path: Path) -> None:
    """As in every list of files."""
    (tmp_path / "mine.toml").write_text("[[pose]]\ntime = 0.0\n[[pose]]\ntime = 2.0\njoy = 1.0\n")
    xdotool(viewer, "key", "ctrl+o")
    click(viewer, "file mine.toml")
    xdotool(viewer, "key", "Return")
    assert until(viewer, lambda: viewer.session.script.duration == 2.0)


def test_a_name_is_free_for_its_kind(viewer: Viewer, tmp_path: Path) -> None:
    """A film of that name is no reason to call a mesh otherwise."""
    viewer.settings.export = ExportChoices(kind="mp4", folder=str(tmp_path))
    xdotool(viewer, "key", "F10")
    name = viewer.exporter.name
    xdotool(viewer, "key", "Escape")
    (tmp_path / f"{name}.mp4").touch()
    xdotool(viewer, "key", "F10")
    assert viewer.exporter.name == f"{name}-2"
    viewer.settings.export.kind = "gltf"
    viewer.exporter.propose()
    assert viewer.exporter.name == name
    xdotool(viewer, "key", "Escape")
