"""Headings that fold, and stay as they were left until the window is opened again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

if TYPE_CHECKING:
    from ..window import Viewer

# Open as long as nobody has folded them.
FIRST_OPEN = frozenset({"Expressions", "Refinement", "Look", "Overlays", "Milliseconds"})


def fold(viewer: Viewer, title: str, label: str = "", *, must_open: bool = False) -> bool:
    """Draw a heading; whether what belongs to it is to be seen.

    label: what it reads, where that is more than the title. must_open: for now, as in a search.
    """
    folds = viewer.settings.folds
    was_open = must_open or folds.get(title, title in FIRST_OPEN)
    imgui.set_next_item_open(was_open)
    is_open = imgui.collapsing_header(f"{label or title}###{title}")
    viewer.gui.remember(title)
    if is_open != was_open and not must_open:
        folds[title] = is_open
    return is_open
