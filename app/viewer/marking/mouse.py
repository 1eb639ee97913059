"""The mouse on a mesh that is marked: a click places the current mark, a drag moves one."""

from __future__ import annotations

from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius import render

from ..interface.gui import LEFT, em
from ..messages import Messages
from ..picture.mouse import CameraMouse
from ..picture.picking import Ray, skin_under
from .marking import Marking
from .picture import MarkingView, are_facing, places_in

REACH = 0.8  # [em] around a mark in which the mouse takes it


class MarkingMouse(CameraMouse):
    """Follows the mouse from press to release."""

    def __init__(
        self, view: MarkingView, surface: render.WindowSurface, marking: Marking, messages: Messages
    ) -> None:
        super().__init__(view, surface)
        self._marking, self._messages = marking, messages

    def _hover(self, io: Any) -> None:
        if self._mark_under(io) is not None:
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand)

    def _take(self, io: Any) -> str:
        pointed = self._mark_under(io)
        if pointed is None:
            return "orbit"
        self._marking.current = pointed
        return "mark"

    def _drag(self, io: Any) -> None:
        if not self._has_moved(io):
            return
        if self._doing == "mark":
            point = self._skin(io)
            if point is not None:
                self._marking.put(self._marking.current, point)
        super()._drag(io)

    def _release(self, io: Any) -> None:
        if self._doing == "mark":
            self._messages.attempt(self._marking.note)
        elif self._doing == "orbit" and imgui.is_mouse_released(LEFT) and not self._has_moved(io):
            point = self._skin(io)
            if point is None:
                self._messages.say("There is no skin here; click on the mesh")
            else:
                self._marking.put(self._marking.current, point)
                self._messages.attempt(self._marking.note)
        self.forget()

    def _skin(self, io: Any) -> Any:
        """The point of the mesh under the mouse, or None."""
        ray = Ray.through(self._view.camera, self._view.viewport, self._place(io))
        marking = self._marking
        return skin_under(ray, marking.positions, marking.faces, from_outside=False)

    def _mark_under(self, io: Any) -> int | None:
        marking, view = self._marking, self._view
        points, normals = marking.seen(marking.marks.places)
        places = np.reshape(places_in(view.area, view.camera, points), (-1, 2))
        off = np.linalg.norm(places - (io.mouse_pos.x, io.mouse_pos.y), axis=1)
        off[~are_facing(view.camera, points, normals)] = np.inf
        found = dict(zip(marking.marks.places, off.tolist(), strict=True))
        # Of marks in one place, as on lips that touch, the current one is meant.
        nearest = min(found, key=lambda n: found[n] - em(0.3) * (n == marking.current), default=0)
        return nearest if found.get(nearest, np.inf) < em(REACH) else None
