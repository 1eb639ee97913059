"""Where everything stands: menus above, controls at the left, time below, the picture in the rest.

Hidden, all of it makes room for the picture; menus come up with the mouse at its upper edge.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from ..gui import em, fixed_panel
from .chrome import draw_menus

if TYPE_CHECKING:
    from ..window import Viewer

PANEL_WIDTHS = 12.0, 60.0  # [em] between which the left panel may be drawn wider
PANEL_SHARE = 0.45  # of the window, at most
EDGE = 1.6  # [em] of the picture's upper edge, where menus come up that are hidden


def draw(viewer: Viewer) -> None:
    """Draw what is to be seen around the picture, and say where the picture is."""
    viewer.face_panel.pointed = ()
    if viewer.is_bare:
        _draw_bare(viewer)
    else:
        _draw_around(viewer)


def _draw_bare(viewer: Viewer) -> None:
    io = imgui.get_io()
    viewer.picture_area = (0.0, 0.0, max(io.display_size.x, 1.0), max(io.display_size.y, 1.0))
    is_in_menu = imgui.is_popup_open("", imgui.PopupFlags_.any_popup)
    if 0.0 <= io.mouse_pos.y < em(EDGE) or is_in_menu:
        draw_menus(viewer, viewer.actions)


def _draw_around(viewer: Viewer) -> None:
    display = imgui.get_io().display_size
    top = draw_menus(viewer, viewer.actions)
    left, strip = _panel_width(viewer, display.x), round(viewer.timeline.height())
    with fixed_panel("Controls", (0.0, top), (left, display.y - top), resizes=True):
        if round(imgui.get_window_width()) != left:  # its edge is being dragged
            viewer.settings.panel_width = imgui.get_window_width() / em()
        _draw_tabs(viewer)
    with fixed_panel("Time", (left, display.y - strip), (display.x - left, strip)):
        viewer.timeline.draw()
    width, height = max(display.x - left, 1.0), max(display.y - top - strip, 1.0)
    viewer.picture_area = (left, top, width, height)


def _panel_width(viewer: Viewer, window_width: float) -> int:
    """Of the left panel [window units]: as it was dragged, as far as there is room."""
    least, most = PANEL_WIDTHS
    wanted = min(max(viewer.settings.panel_width, least), most)
    return round(min(em(wanted), PANEL_SHARE * window_width))


def _draw_tabs(viewer: Viewer) -> None:
    if not imgui.begin_tab_bar("tabs"):
        return
    for title, panel in (("Face", viewer.face_panel), ("Mechanism", viewer.mechanism_panel)):
        flags = imgui.TabItemFlags_.set_selected if viewer.wanted_tab == title else 0
        is_open, _ = imgui.begin_tab_item(title, None, flags)
        viewer.gui.remember(f"tab {title}")
        if is_open:
            if viewer.wanted_tab in ("", title):
                viewer.settings.tab, viewer.wanted_tab = title, ""
            panel.draw()
            imgui.end_tab_item()
    imgui.end_tab_bar()
