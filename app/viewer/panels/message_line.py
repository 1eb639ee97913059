"""The line of messages, at the foot of the picture."""

from __future__ import annotations

from imgui_bundle import imgui

from ..gui import NOTE_FLAGS, Gui, colour, em
from ..messages import Messages
from ..view import View


def draw_message(gui: Gui, messages: Messages, view: View) -> None:
    """Draw the line, if there is one; a click or Escape takes it away."""
    if not messages.text:
        return
    left, top, width, height = view.area
    foot = top + height - view.foot - em(0.8)
    imgui.set_next_window_pos((left + em(0.8), foot), 0, (0.0, 1.0))
    imgui.set_next_window_size_constraints((0.0, 0.0), (max(width - em(1.6), 50.0), em(20)))
    imgui.begin("##message", None, NOTE_FLAGS | imgui.WindowFlags_.no_nav_focus)
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
    place, size = imgui.get_window_pos(), imgui.get_window_size()
    imgui.end()
    gui.places["message"] = (place.x, place.y, place.x + size.x, place.y + size.y)
