"""The slider of the muscle that was clicked, beside the mouse."""

from __future__ import annotations

from imgui_bundle import imgui

from ...controls.mirror import twin_of
from ...controls.vocabulary import called
from ..gui import LEFT, NOTE_FLAGS, Gui, em
from ..session import Session
from ..settings import Settings
from ..view import View
from .sliders import Sliders
from .widgets import muted

WIDTH = 12.0  # [em] of the slider


class MuscleNote:
    """A note that a click elsewhere or Escape takes away."""

    def __init__(self, gui: Gui, session: Session, settings: Settings, view: View) -> None:
        self._gui, self._session, self._settings, self._view = gui, session, settings, view
        self._sliders = Sliders(gui)
        self.name = ""  # of the muscle, "" for none

    def draw(self) -> None:
        """Draw the note, if there is one; it comes up below the mouse."""
        session, name, twin = self._session, self.name, twin_of(self.name)
        if name not in session.values:
            return
        mouse, display = imgui.get_mouse_pos(), imgui.get_io().display_size
        place = min(mouse.x + em(), display.x - em(WIDTH + 2.0)), mouse.y + em()
        imgui.set_next_window_pos(place, imgui.Cond_.appearing)
        imgui.begin("##muscle", None, NOTE_FLAGS)
        values, limits = session.current, session.controls.limits[name]
        is_linked = self._settings.is_linked and twin != name and values[name] == values[twin]
        names = (name, twin) if is_linked else (name,)
        imgui.text_unformatted(called(*names).capitalize())
        slid = self._sliders.draw(name, values[name], limits, width=em(WIDTH))
        self._gui.places["note"] = self._gui.places[name]
        if slid.is_changed:
            session.set(name, slid.value, linked=is_linked)
        if slid.is_done:
            session.note()
        imgui.push_text_wrap_pos(em(WIDTH + 0.5))
        muted(self._gui, session.scene.actions.get(name, ""))
        imgui.pop_text_wrap_pos()
        is_on = imgui.is_window_hovered(imgui.HoveredFlags_.allow_when_blocked_by_active_item)
        imgui.end()
        if is_on or not self._view.pointed:  # as long as the note is there
            self._view.pointed = dict.fromkeys(names, 1.0)
        is_left = imgui.is_mouse_clicked(LEFT) and not is_on
        is_typing = imgui.get_io().want_text_input
        if is_left or (imgui.is_key_pressed(imgui.Key.escape) and not is_typing):
            self.name = ""
