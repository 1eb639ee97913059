"""Comparisons, views, light and persons, by real events."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from risorius.app.capture.captions import plate
from risorius.app.viewer import Viewer
from risorius.app.viewer.settings import SKINS, Display

from .driving import (
    NEEDS_A_SCREEN,
    click,
    settle,
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
    titles = ("Refinement", "Style", "Anatomy", "Light and person", "Milliseconds")
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
        ("static\n2030 triangles", f"smooth\n{count} triangles"),
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


def test_the_refiner_on_the_card_is_one_of_the_list(viewer: Viewer) -> None:
    """Chosen by the mouse it draws from the card, and the picture is as it was; set back, too."""
    only_open(viewer, "Refinement")
    pictures = [viewer.stage.draw_image(viewer.view)]
    in_panel(viewer, ("Refiner", "kahler-gl"))
    assert isinstance(viewer.stage.refined.stream, render.GpuStream)
    pictures.append(viewer.stage.draw_image(viewer.view))
    assert viewer.stage.refined.label == "kahler-gl" and not viewer.messages.text
    assert np.array_equal(*pictures)
    in_panel(viewer, ("scheme", "detail"))
    assert "scheme must be one of ('loop', 'cubic')" in viewer.messages.text
    click(viewer, "Reset all")
    assert isinstance(viewer.stage.refined.stream, render.Stream)


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
