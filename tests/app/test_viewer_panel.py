"""The Face panel, driven by real mouse and key events: search, names, sides, filters."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from risorius.app.viewer import Viewer
from risorius.assets.loading import read_words

from .driving import (
    NEEDS_A_SCREEN,
    clear_search,
    click,
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
    """A button shows its kind alone, a second click everything."""
    click(viewer, "only Visemes")
    assert all(name.startswith("viseme_") for name in rows_shown(viewer))
    click(viewer, "only Visemes")
    assert {"joy", "wink"} <= rows_shown(viewer)


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
