"""Comparisons, what differs from the start, views, light and persons, by real events."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from risorius.app.capture.captions import plate
from risorius.app.viewer import Viewer
from risorius.app.viewer.setting_rules import SKINS
from risorius.app.viewer.settings import Display

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    click,
    drag,
    drag_and_release,
    middle,
    nose,
    on_screen,
    settle,
    show_controls,
    until,
    xdotool,
)

from risorius import render  # isort: skip
from risorius.app.anatomy import AnatomyView
from risorius.app.capture import Capture, CaptureOptions

pytestmark = [*NEEDS_A_SCREEN, pytest.mark.usefixtures("calm")]


def in_panel(viewer: Viewer, *rows: tuple[str, str]) -> None:
    """Choose in lists of the Mechanism panel."""
    for row, choice in rows:
        click(viewer, row)
        click(viewer, f"{row}: {choice}")


def only_open(viewer: Viewer, title: str) -> None:
    """Fold all of the Mechanism panel but one heading, so that there is room for it."""
    viewer.panel_state.wanted_tab = "Mechanism"
    titles = ("Refinement", "Style", "Overlays", "Light and person", "Milliseconds")
    viewer.settings.folds.update({each: each == title for each in titles})
    settle(viewer)


def seen_labels(viewer: Viewer, page: np.ndarray, origin: tuple[int, int]) -> list[bool]:
    """Whether each label of the window is in a picture whose lower left corner is there."""
    seen = []
    for x, y, image in viewer.surface.labels:
        bottom = len(page) - (y - origin[1])
        part = page[bottom - len(image) : bottom, x - origin[0] :][:, : image.shape[1]]
        is_opaque = image[..., 3] == 255
        seen.append(bool(is_opaque.any() and (part == image[..., :3])[is_opaque].all()))
    return seen


def test_both_sides_have_captions_and_colours_a_bar(viewer: Viewer, tmp_path: Path) -> None:
    """In the window and in a screenshot alike; none where nothing is compared or coloured."""
    assert not viewer.surface.labels
    viewer.settings.display.colours = "tension"
    xdotool(viewer, "key", "d")
    assert until(viewer, lambda: viewer.is_idle)
    assert len(viewer.surface.labels) == 3
    height = viewer.view.viewport[3]
    size = max(height / 36.0, 15.0)
    count = viewer.stage.refined.triangle_count
    for text, label in zip(
        ("A   static\n2030 triangles", f"B   smooth\n{count} triangles"),
        viewer.surface.labels,
        strict=False,
    ):
        assert np.array_equal(label[2], plate(text, size))
    assert seen_labels(viewer, viewer.surface.read(), (0, 0)) == [True] * 3
    xdotool(viewer, "key", "F12")
    (path,) = tmp_path.glob("*.png")
    page = np.asarray(Image.open(path))
    assert seen_labels(viewer, page, viewer.view.viewport[:2]) == [True] * 3
    viewer.settings.display = Display()
    settle(viewer)
    assert not viewer.surface.labels


def test_any_two_are_compared_and_flipped(viewer: Viewer) -> None:
    """Each side has a list; B shows one and the other in all of the picture."""
    only_open(viewer, "Refinement")
    viewer.settings.display.compare = "side by side"
    settle(viewer)
    in_panel(viewer, ("A", "loop"), ("B", "paper"))
    shots = viewer.stage.viewports(viewer.settings.display, viewer.view.viewport)
    assert [shot.drawn.label for shot in shots] == ["loop", "paper"]
    in_panel(viewer, ("B", "as chosen above"))
    seen = []
    for _ in range(3):
        xdotool(viewer, "key", "b")
        (shot,) = viewer.stage.viewports(viewer.settings.display, viewer.view.viewport)
        assert shot.seen == viewer.view.viewport and len(viewer.surface.labels) == 1
        seen.append((viewer.settings.display.compare, shot.drawn.label))
    assert seen == [("B alone", "smooth"), ("A alone", "loop"), ("B alone", "smooth")]
    assert not viewer.messages.text


def test_rows_show_what_differs_and_are_set_back(viewer: Viewer) -> None:
    """Each by the mark beside it, options of the refiner among them; all by one button."""
    only_open(viewer, "Refinement")
    assert not [place for place in viewer.gui.places if place.startswith("reset ")]
    display = viewer.settings.display
    display.look, display.options = "paper", {"kahler": {"scheme": "cubic", "coherent": True}}
    display.colours, display.skin = "splits", "clay"
    click(viewer, "reset scheme")
    assert display.options == {"kahler": {"coherent": True}}
    click(viewer, "reset Look")
    assert viewer.stage.refined.label == "smooth"
    only_open(viewer, "Style")
    click(viewer, "reset Skin")
    assert viewer.settings.display == Display(colours="splits")
    marks = {place for place in viewer.gui.places if place.startswith("reset ")}
    assert marks == {"reset Colours"}
    click(viewer, "Reset all")
    assert viewer.settings.display == Display()


def test_what_is_seen_can_be_undone_like_a_pose(viewer: Viewer) -> None:
    """Ctrl+Z takes each change back in turn, whether of the face or of how it is drawn."""
    assert not viewer.session.can_undo
    xdotool(viewer, "key", "w")
    xdotool(viewer, "key", "1")
    pose = dict(viewer.session.values)
    xdotool(viewer, "key", "d")
    left, top, width, height = viewer.view.area
    drag(viewer, on_screen(viewer, left + 0.5 * width, top + 0.1 * height), (90, 0))
    xdotool(viewer, "mousemove_relative", 20, 0)
    xdotool(viewer, "mouseup", 1)
    divider = viewer.settings.display.divider
    assert divider > 0.6
    xdotool(viewer, "key", "ctrl+z")  # the drag is one step
    assert viewer.settings.display == Display(wireframe=True, compare="wipe")
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.settings.display == Display(wireframe=True) and viewer.session.values == pose
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.settings.display == Display(wireframe=True) and viewer.session.values != pose
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.settings.display == Display() and not viewer.session.can_undo
    xdotool(viewer, "key", "ctrl+shift+z")
    assert viewer.settings.display == Display(wireframe=True)


def test_the_number_pad_looks_from_all_sides(viewer: Viewer) -> None:
    """Exactly, and about the same point from as far; Alt does where there is no number pad."""
    camera = viewer.view.camera
    place = camera.distance, camera.target.tolist()
    for keys, yaw, pitch in (
        ("KP_Next", 90.0, 0.0),
        ("ctrl+KP_Next", -90.0, 0.0),
        ("KP_Down", 35.0, 4.0),
        ("ctrl+KP_Down", -35.0, 4.0),
        ("KP_Home", 0.0, 90.0),
        ("KP_End", 0.0, 0.0),
        ("alt+3", 90.0, 0.0),
    ):
        xdotool(viewer, "key", keys)
        assert (camera.yaw, camera.pitch) == (yaw, pitch), keys
    assert (camera.distance, camera.target.tolist()) == place
    assert not any(viewer.session.values.values())  # alt+3 is no expression


def test_orthographic_shows_and_finds_what_is_there(viewer: Viewer) -> None:
    """The picture changes and back; the skin is where it is seen; F keeps the projection."""
    assert until(viewer, lambda: viewer.is_idle)
    before = viewer.surface.read()
    xdotool(viewer, "key", "KP_Begin")
    assert until(viewer, lambda: viewer.is_idle)
    assert np.abs(viewer.surface.read().astype(int) - before).mean() > 1.0
    xdotool(viewer, "key", "f")
    assert viewer.view.camera.is_orthographic and viewer.settings.display.is_orthographic
    tip = viewer.session.scene.positions[viewer.session.scene.positions[:, 2].argmax()].copy()
    drag(viewer, nose(viewer), (0, 12))
    assert viewer.mouse.skin_drag is not None
    assert np.linalg.norm(viewer.mouse.skin_drag.point - tip) < 3.0
    xdotool(viewer, "mouseup", 1)
    xdotool(viewer, "key", "KP_Begin")
    assert not viewer.view.camera.is_orthographic


@pytest.mark.slow
def test_light_background_and_tone_are_chosen(viewer: Viewer) -> None:
    """Each changes the picture at once, and none keeps the others."""
    only_open(viewer, "Light and person")
    assert until(viewer, lambda: viewer.is_idle)
    pages = [viewer.surface.read()[:, 400:].astype(int)]
    for row, choice in (("Background", "white"), ("Light", "hard"), ("Skin tone", "dark")):
        in_panel(viewer, (row, choice))
        assert until(viewer, lambda: viewer.is_idle)
        pages.append(viewer.surface.read()[:, 400:].astype(int))
        assert np.abs(pages[-1] - pages[-2]).mean() > 1.0
    assert viewer.settings.display == Display(background="white", light="hard", tone="dark")
    click(viewer, "Reset all")
    assert until(viewer, lambda: viewer.is_idle)
    assert np.abs(viewer.surface.read()[:, 400:] - pages[0]).mean() < 0.1


@pytest.mark.slow
def test_a_person_takes_the_place_and_goes_again(viewer: Viewer) -> None:
    """Script, pose and what can be undone stay; the menu brings the built-in head back."""
    show_controls(viewer, "jaw open")
    drag_and_release(viewer, middle(viewer, "jaw_open"), (60, 0))
    clear_search(viewer)
    pose, script = dict(viewer.session.values), viewer.session.script
    built_in = viewer.session.scene.rest_positions
    only_open(viewer, "Light and person")
    in_panel(viewer, ("Person", "Kofi, man, about 40"))
    assert until(viewer, lambda: viewer.session.scene.called == "kofi")
    assert viewer.stage.scene is viewer.session.scene and not viewer.messages.text
    assert np.abs(viewer.session.scene.rest_positions - built_in).max() > 3.0
    assert viewer.session.values == pose and viewer.session.script is script
    click(viewer, "menu File")
    click(viewer, "menu File: Built-in head")
    assert until(viewer, lambda: viewer.session.scene.called == "built-in")
    assert np.array_equal(viewer.session.scene.rest_positions, built_in)
    xdotool(viewer, "key", "ctrl+z")
    assert viewer.session.values["jaw_open"] == 0.0


def test_a_key_shows_the_muscles_as_capture_draws_them(viewer: Viewer) -> None:
    """U switches them on and off; nothing stays behind."""
    settle(viewer)
    usual = viewer.stage.draw_image(viewer.view).astype(int)
    xdotool(viewer, "key", "u")
    settle(viewer)
    assert viewer.settings.display.overlays == ["muscles"]
    shown = viewer.stage.draw_image(viewer.view).astype(int)
    assert (np.abs(shown - usual).max(axis=2) > 16).mean() > 0.05
    size = shown.shape[1], shown.shape[0]
    style = render.Style(albedo=SKINS["textured"][1], background=viewer.view.background)
    options = CaptureOptions(size=size, style=style, anatomy=AnatomyView(("muscles",)))
    with Capture(viewer.session.scene, options) as capture:
        capture.camera = viewer.view.camera
        off = np.abs(capture.draw_image().astype(int) - shown)
    assert np.percentile(off, 99) <= 2.0
    viewer.surface.make_current()
    xdotool(viewer, "key", "u")
    settle(viewer)
    assert np.array_equal(viewer.stage.draw_image(viewer.view), usual)
