"""The mouse on a mesh that is marked: a click places the current mark, a drag moves one."""

from __future__ import annotations

from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius import render

from ..gui import em
from ..messages import Messages
from ..mouse import CameraMouse
from ..picking import Ray, skin_under
from .marking import Marking
from .picture import MarkingView

REACH = 0.8  # [em] around a mark in which the mouse takes it


class MarkingMouse(CameraMouse):
    """Follows the mouse; what it is on is `pointed`."""

    pointed: int | None = None  # the mark under the mouse

    def __init__(
        self,
        view: MarkingView,
        surface: render.WindowSurface,
        marking: Marking,
        messages: Messages,
    ) -> None:
        super().__init__(view, surface)
        self._marking_view, self._marking, self._messages = view, marking, messages

    def _hover(self, io: Any) -> None:
        self.pointed = self._mark_under(io)
        if self.pointed is not None:
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand)

    def _take(self, io: Any) -> str:
        if self.pointed is None:
            return "orbit"
        self._marking.current = self.pointed
        return "mark"

    def _drag(self, io: Any) -> None:
        if self._doing == "mark":
            point = self._skin(io)
            if self._has_moved(io) and point is not None:
                self._marking.put(self._marking.current, point)
        elif self._doing != "orbit" or self._has_moved(io):
            super()._drag(io)

    def _release(self, io: Any) -> None:
        is_click = self._doing == "orbit" and imgui.is_mouse_released(0) and not self._has_moved(io)
        point = self._skin(io) if is_click else None
        if point is not None:
            self._marking.put(self._marking.current, point)
        if point is not None or self._doing == "mark":
            self._messages.attempt(self._marking.note)
        self.forget()

    def _skin(self, io: Any) -> Any:
        """The point of the mesh under the mouse, or None."""
        ray = Ray.through(self._view.camera, self._view.viewport, self._place(io))
        marking = self._marking
        return skin_under(ray, marking.positions, marking.faces, from_outside=False)

    def _mark_under(self, io: Any) -> int | None:
        marking, view = self._marking, self._marking_view
        points, normals = marking.seen(marking.marks.places)
        off = np.linalg.norm(view.on_screen(points) - (io.mouse_pos.x, io.mouse_pos.y), axis=1)
        off[~view.are_seen(points, normals)] = np.inf
        found = dict(zip(marking.marks.places, off.tolist(), strict=True))
        # Of marks in one place, as on lips that touch, the current one is meant.
        nearest = min(found, key=lambda n: found[n] - em(0.3) * (n == marking.current), default=0)
        return nearest if found.get(nearest, np.inf) < em(REACH) else None
