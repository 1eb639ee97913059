"""Real mouse events on the skin: pull to pose, the clicked muscle, its lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from risorius.app.viewer import Viewer

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    drag,
    middle,
    moved,
    on_screen,
    show_controls,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]
MAJOR = "zygomaticus_major"


def photograph(viewer: Viewer) -> np.ndarray:
    """What F12 writes."""
    before = set(viewer_pictures())
    xdotool(viewer, "key", "F12")
    assert until(viewer, lambda: bool(set(viewer_pictures()) - before))
    (path,) = set(viewer_pictures()) - before
    return np.asarray(Image.open(path)).astype(int)


def viewer_pictures() -> list[str]:
    """Screenshots in the present folder."""
    return [str(path) for path in Path.cwd().glob("*.png")]


def point_at_slider(viewer: Viewer) -> None:
    """The mouse on a muscle's slider."""
    show_controls(viewer, "zygom maj")
    xdotool(viewer, "key", "Return")
    xdotool(viewer, "mousemove", *middle(viewer, f"{MAJOR}_left"))
    assert until(viewer, lambda: f"{MAJOR}_left" in viewer.view.pointed)


def test_pictures_have_no_lines_of_a_slider_that_is_pointed_at(viewer: Viewer) -> None:
    """F12 writes the same picture whether the mouse is on a slider or not."""
    point_at_slider(viewer)
    with_mouse = photograph(viewer)
    assert viewer.view.pointed
    xdotool(viewer, "mousemove", *on_screen(viewer, 880, 300))
    assert until(viewer, lambda: not viewer.view.pointed)
    assert np.abs(with_mouse - photograph(viewer)).max() <= 2
    clear_search(viewer)


def landmark(viewer: Viewer, number: int) -> tuple[int, int]:
    """A landmark of the face, on the screen."""
    scene = viewer.session.scene
    return seen_at(viewer, scene.positions[scene.head.landmarks[number]])


def seen_at(viewer: Viewer, point: np.ndarray) -> tuple[int, int]:
    """A point of the scene, on the screen."""
    left, top, width, height = viewer.view.area
    camera = viewer.view.camera
    matrix = np.asarray(camera.view_matrix() @ camera.projection_matrix(width / height))
    clip = np.append(point, 1.0) @ matrix
    x, y = clip[:2] / clip[3]
    return on_screen(viewer, left + width * (0.5 + 0.5 * x), top + height * (0.5 - 0.5 * y))


def test_pulled_skin_stays_where_muscles_hold_it(viewer: Viewer) -> None:
    """Pull the left corner of the mouth up and out: it stays as the finger goes; Ctrl+Z undoes."""
    viewer.settings.is_linked = False
    drag(viewer, landmark(viewer, 54), (12, -14))
    assert until(viewer, lambda: viewer.session.values[f"{MAJOR}_left"] > 0.2)
    xdotool(viewer, "mouseup", 1)
    solved = dict(viewer.session.values)
    assert solved[f"{MAJOR}_left"] > 0.3
    assert len([name for name, value in solved.items() if value]) <= 4
    assert not any(value for name, value in solved.items() if name.endswith("_right"))
    assert viewer.messages.text.startswith("Smile muscle, left 0.")
    assert viewer.messages.text.endswith("mm short of the mouse")
    assert until(viewer, lambda: viewer.physics.is_at_rest)
    assert moved(viewer) > 4.0
    assert viewer.session.values == solved
    xdotool(viewer, "key", "ctrl+z")
    assert not any(viewer.session.values.values())
    assert until(viewer, lambda: moved(viewer) < 0.3)


def test_linked_sides_are_pulled_together(viewer: Viewer) -> None:
    """With the sides linked, the other corner of the mouth goes along."""
    viewer.settings.is_linked = True
    drag(viewer, landmark(viewer, 48), (-12, -14))
    assert until(viewer, lambda: viewer.session.values[f"{MAJOR}_right"] > 0.2)
    xdotool(viewer, "mouseup", 1)
    values = viewer.session.values
    assert values[f"{MAJOR}_right"] == values[f"{MAJOR}_left"] > 0.3
    assert not any(values[name] for name in values if "sideways" in name), "nothing to one side"
    assert viewer.messages.text.startswith("Smile muscle, both sides 0.")


def test_a_click_shows_the_muscle_in_the_panel(viewer: Viewer) -> None:
    """Its group opens, and its slider is scrolled to."""
    viewer.panel_state.wanted_tab = "Live"
    x, y = landmark(viewer, 54)
    xdotool(viewer, "mousemove", x + 15, y - 15, "click", 1)
    assert until(viewer, lambda: viewer.settings.folds.get("Upper lip and cheek", False))
    assert until(viewer, lambda: "search" in viewer.gui.places)
