"""The Face panel, driven by real mouse and key events: search, names, sides, pads, filters."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from risorius.app.controls.vocabulary import filters, pads, title_of
from risorius.app.script import load_script
from risorius.app.viewer import Viewer
from risorius.app.viewer.panels.pose_grid import PoseGrid, PoseLibrary
from risorius.assets.loading import read_words

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    click,
    drag,
    drag_and_release,
    middle,
    replace_state,
    settle,
    show_controls,
    until,
    xdotool,
)

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm", "plain_panel")]
WIDTH = 22.5  # [em] of the panel
SMILE = "zygomaticus_major"


@pytest.fixture
def plain_panel(viewer: Viewer) -> Iterator[None]:
    """No filter, sides linked, and the panel as wide as at first afterwards."""
    yield
    viewer.face_panel.search = viewer.face_panel.filter = ""
    viewer.face_panel.rows.__init__(viewer)  # type: ignore[misc]
    viewer.settings.is_linked, viewer.settings.panel_width = True, WIDTH
    settle(viewer)


def rows_shown(viewer: Viewer) -> set[str]:
    """Labels of the rows in the panel."""
    settle(viewer)
    return {name.removeprefix("show ") for name in viewer.gui.places if name.startswith("show ")}


def test_plain_words_find_controls(viewer: Viewer) -> None:
    """What people would say finds expressions, units, shapes and muscles."""
    viewer.settings.zoom = 0.6  # room for all of them at once
    settle(viewer)  # until all is in its place
    try:
        for words, found in (
            ("smile", {"joy", "AU12", "mouthSmile", SMILE}),
            ("frown", {"anger", "AU4", "mouthFrown", "corrugator_supercilii"}),
            ("chew", {"AU26", "jawOpen", "jaw_open"}),
        ):
            show_controls(viewer, words)
            shown = rows_shown(viewer)
            assert found <= shown and len(shown) < 20, words
            clear_search(viewer)
    finally:
        viewer.settings.zoom = 1.0


def test_filters_show_one_kind(viewer: Viewer) -> None:
    """A button shows its kind alone, a second click everything; "In use" what is not 0."""
    click(viewer, "only Visemes")
    assert all(name.startswith("viseme_") for name in rows_shown(viewer))
    click(viewer, "only In use")
    assert not rows_shown(viewer)
    viewer.session.set(f"{SMILE}_left", 0.5)
    viewer.session.set("AU4", 0.5)
    assert rows_shown(viewer) == {SMILE, "AU4"}
    drag(viewer, middle(viewer, "AU4"), (-300, 0))
    assert viewer.session.values["AU4"] == 0.0 and "AU4" in rows_shown(viewer)
    xdotool(viewer, "mouseup", 1)
    assert rows_shown(viewer) == {SMILE}
    click(viewer, "only In use")
    assert {"joy", "wink"} <= rows_shown(viewer)


@pytest.mark.slow
def test_no_two_rows_read_alike(viewer: Viewer) -> None:
    """Of every group; and in a narrow panel every name is there, in as many lines as it takes."""
    controls, actions = viewer.session.controls, viewer.session.scene.actions
    viewer.settings.panel_width = 12.0
    texts = [
        "  ".join(filter(None, title_of(row.label, actions.get(row.names[-1], ""))))
        for names in controls.groups.values()
        for row in viewer.face_panel.rows.of(names)
    ]
    assert len(texts) == len(set(texts)) > 100 and "Smile muscle" in texts
    for title in filters():
        click(viewer, f"only {title}")
        for label in rows_shown(viewer):
            left, _, right, bottom = viewer.gui.places[f"show {label}"]
            assert 0.0 < left < right <= viewer.view.area[0], label
            below = [
                place
                for name, place in viewer.gui.places.items()
                if name in (label, f"{label}_left")
            ]
            assert all(bar[0] >= right or bar[1] >= bottom - 6.0 for bar in below), label
        click(viewer, f"only {title}")


def test_joy_of_one_side(viewer: Viewer) -> None:
    """A click takes the sides of a row apart while the face stays; another joins them."""
    session = viewer.session
    session.set("joy", 0.6)
    session.note()
    assert "joy_left" not in viewer.gui.places
    click(viewer, "sides joy")
    assert session.values["joy"] == 0.0
    assert session.values["joy_left"] == session.values["joy_right"] == 0.6
    drag_and_release(viewer, middle(viewer, "joy_right"), (-200, 0))
    assert session.values["joy_right"] == 0.0 and session.values["joy_left"] == 0.6
    xdotool(viewer, "key", "m")
    assert session.values["joy_left"] == 0.0 and session.values["joy_right"] == 0.6
    click(viewer, "sides joy")
    assert session.values["joy"] == 0.6 and session.values["joy_right"] == 0.0
    xdotool(viewer, "key", "ctrl+z", "ctrl+z")
    assert session.values["joy_left"] == 0.6


@pytest.mark.slow
def test_pads_move_two_controls_at_once(viewer: Viewer) -> None:
    """Eyes, jaw and head follow the mouse; a double click and Ctrl+Z take it back."""
    session = viewer.session
    for pad in pads():
        drag_and_release(viewer, middle(viewer, f"pad {pad.title}"), (15, 10))
        across, along = session.values[pad.across], session.values[pad.along]
        assert across > 0.1 and (along > 0.5 if pad.title == "Jaw" else along < -0.1), pad.title
        click(viewer, f"pad {pad.title}", times=2)
        assert session.values[pad.across] == session.values[pad.along] == 0.0, pad.title
    drag_and_release(viewer, middle(viewer, "pad Head"), (20, 0))
    xdotool(viewer, "key", "ctrl+z")
    assert session.values["head_yaw"] == 0.0


def test_one_side_is_copied_to_the_other(viewer: Viewer) -> None:
    """By the menu, whatever spells its sides how; eyes and jaw stay where they are."""
    session = viewer.session
    shown = {"AU12_left": 0.5, "mouthSmileRight": 0.3, "wink": 0.2, "gaze_horizontal_left": 0.4}
    for name, value in {**shown, "jaw_sideways": 0.1, "AU61": 0.2}.items():
        session.set(name, value)
    session.note()
    click(viewer, "menu Edit")
    click(viewer, "menu Edit: Left to right")
    values = {name: value for name, value in session.values.items() if value}
    assert values == {
        "AU12_left": 0.5, "AU12_right": 0.5, "wink": 0.2, "wink_right": 0.2,
        "gaze_horizontal_left": 0.4, "jaw_sideways": 0.1, "AU61": 0.2,
    }  # fmt: skip
    xdotool(viewer, "key", "ctrl+z")
    click(viewer, "menu Edit")
    click(viewer, "menu Edit: Right to left")
    assert until(viewer, lambda: session.values["mouthSmileLeft"] == 0.3)
    assert session.values["AU12_left"] == session.values["wink"] == 0.0


def test_words_are_of_controls_that_there_are(viewer: Viewer) -> None:
    """Names, synonyms and filters of the table all mean something."""
    controls = viewer.session.controls
    limits, words = controls.limits, read_words()

    def is_known(name: str) -> bool:
        return any(f"{name}{side}" in limits for side in ("", "_left", "Left"))

    found = {name for names in words["synonyms"].values() for name in names}
    assert all(map(is_known, [*words["names"], *found]))
    groups = {title for titles in words["filters"].values() for title in titles}
    assert groups == set(controls.groups)


def values_of(viewer: Viewer) -> dict[str, float]:
    """What is not 0."""
    return {name: value for name, value in viewer.session.values.items() if value}


@pytest.mark.slow
def test_a_picture_is_taken_blended_and_mirrored(viewer: Viewer) -> None:
    """By a click, a drag to the right, and with Shift; Ctrl+Z takes each back in one step."""
    viewer.settings.folds["Pose pictures"] = True
    assert until(viewer, lambda: "pose Joy" in viewer.gui.places)
    click(viewer, "pose Joy")
    assert values_of(viewer) == {"joy": 1.0}
    drag(viewer, middle(viewer, "pose Anger"), (10, 0))
    left, _, right, _ = viewer.gui.places["pose Anger"]
    xdotool(viewer, "mousemove_relative", "--", round(0.4 * (right - left)), 0)
    xdotool(viewer, "mouseup", 1)
    blended = values_of(viewer)
    assert 0.3 < blended["anger"] < 0.7 and blended["joy"] == pytest.approx(1.0 - blended["anger"])
    xdotool(viewer, "key", "ctrl+z")
    assert values_of(viewer) == {"joy": 1.0}
    xdotool(viewer, "keydown", "shift")
    click(viewer, "pose Wink")
    xdotool(viewer, "keyup", "shift")
    assert values_of(viewer) == {"wink_right": 1.0}
    xdotool(viewer, "key", "ctrl+z", "ctrl+z")
    assert not values_of(viewer)


def test_a_pose_is_kept_with_a_picture(viewer: Viewer, tmp_path: Path) -> None:
    """In a folder, as a plain script; and it is there the next time."""
    grid = viewer.face_panel.poses
    folder, unusable = tmp_path / "poses", tmp_path / "poses" / "broken.toml"
    folder.mkdir()
    unusable.write_text("[[pose")
    grid.close()
    replace_state(grid, PoseGrid(viewer, folder))
    viewer.settings.folds["Pose pictures"], viewer.settings.folds["Expressions"] = True, False
    viewer.session.set("jaw_open", 0.6)
    viewer.settings.zoom = 0.6
    settle(viewer)  # until all is in its place
    try:
        click(viewer, "Keep this pose")
        assert until(viewer, lambda: "pose Pose 1" in viewer.gui.places)
        viewer.session.neutral()
        click(viewer, "pose Pose 1")
    finally:
        viewer.settings.zoom = 1.0
    assert values_of(viewer) == {"jaw_open": 0.6}
    assert load_script(folder / "Pose 1.toml").at(0.0)["jaw_open"] == 0.6
    assert set(PoseLibrary(viewer.session.scene, folder).own) == {"Pose 1"}
