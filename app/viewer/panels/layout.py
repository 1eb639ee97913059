"""The layout: menus above, controls at the left, the timeline below, the picture in the rest.

A message stands in a line at the upper edge of the picture.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from imgui_bundle import imgui

from ..context import ApplicationContext
from ..interface.commands import MenuBar
from ..interface.gui import LEFT_BUTTON, NOTE_FLAGS, Gui, colour, em, fixed_panel
from ..messages import Messages
from ..picture.stage import SceneView
from ..timeline.timeline import Timeline


def draw_message(gui: Gui, messages: Messages, view: SceneView) -> None:
    """Draw the current message, if there is one; a click or Escape removes it."""
    if not messages.text:
        return
    left, top, width, _ = view.area
    imgui.set_next_window_pos((left + em(0.8), top + em(0.8)))  # captions are at the lower edge
    imgui.set_next_window_size_constraints((0.0, 0.0), (max(width - em(1.6), 50.0), em(20)))
    imgui.begin("##message", None, NOTE_FLAGS)
    imgui.push_text_wrap_pos(min(width - em(2.4), em(46)))
    text = gui.with_keys(messages.text)
    if messages.is_error:
        imgui.text_colored(colour(gui.theme.error), text)
    else:
        imgui.text_unformatted(text)
    imgui.pop_text_wrap_pos()
    is_clicked = imgui.is_window_hovered() and imgui.is_mouse_clicked(0)
    if is_clicked or (imgui.is_key_pressed(imgui.Key.escape) and not gui.has_popup):
        messages.text = ""
    place = imgui.get_window_pos()
    size = imgui.get_window_size()
    imgui.end()
    gui.places["message"] = (place.x, place.y, place.x + size.x, place.y + size.y)


class PanelLayout:
    """Draws everything around the picture, and gives the picture its place."""

    def __init__(
        self,
        app: ApplicationContext,
        menus: MenuBar,
        tabs: Mapping[str, Callable[[], None]],
        timeline: Timeline,
    ) -> None:
        """tabs: functions that draw the panels at the left, by title or label###title."""
        self._app = app
        self._gui = app.gui
        self._settings = app.settings
        self._menus = menus
        self._tabs = tabs
        self._timeline = timeline

    def draw(self, view: SceneView) -> None:
        """Draw everything, and give the view its place."""
        view.pointed = {}
        display = imgui.get_io().display_size
        top = self._menus.draw()
        panel_widths = 12.0, 60.0  # [em]: least and greatest width of the left panel
        least, most = panel_widths
        wanted = em(min(max(self._settings.panel_width, least), most))
        left = round(min(wanted, 0.45 * display.x))
        below = round(self._timeline.height())
        with fixed_panel("Controls", (0.0, top), (left, display.y - top), resizes=True):
            is_other = round(imgui.get_window_width()) != left
            if is_other and imgui.is_mouse_down(LEFT_BUTTON):  # its edge is being dragged
                self._settings.panel_width = imgui.get_window_width() / em()
            self._draw_tabs()
        with fixed_panel("Time", (left, display.y - below), (display.x - left, below)):
            self._timeline.draw()
        view.area = left, top, max(display.x - left, 1.0), max(display.y - top - below, 1.0)

    def _draw_tabs(self) -> None:
        app = self._app
        if not imgui.begin_tab_bar("tabs"):
            return
        for label, draw_panel in self._tabs.items():
            title = label.rpartition("###")[2]
            flags = imgui.TabItemFlags_.set_selected if app.wanted_tab == title else 0
            is_open, _ = imgui.begin_tab_item(label, None, flags)
            self._gui.remember(f"tab {title}")
            if is_open:
                if app.wanted_tab == title:
                    app.wanted_tab = ""
                draw_panel()
                imgui.end_tab_item()
        imgui.end_tab_bar()
