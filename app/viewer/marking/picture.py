"""The picture of the marking, and the mouse in it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from imgui_bundle import imgui

from risorius import render

from ...passes.camera import CameraLabels
from ...refining.presets import STATIC_REFINER
from ..interface.gui import LEFT_BUTTON, em
from ..messages import Messages
from ..picture.mouse import CameraMouse
from ..picture.stage import SceneView, Stage
from ..settings import Display, Settings
from .marking import Marking

ScreenPoint = tuple[float, float]  # [window units]


class MarkingView(SceneView):
    """The view of the mesh, in clay; the camera frames all of it."""

    def __init__(self, marking: Marking, settings: Settings, surface: render.WindowSurface) -> None:
        self._marking = marking
        self._settings = settings
        self._surface = surface
        self.fit_scene()

    def fit_scene(self) -> None:
        marking = self._marking
        self.camera = render.OrbitCamera.framing(marking.positions)
        if marking.is_upright:  # frame only the face, without hair and shoulders
            self.camera.fit(marking.seen(marking.marks.places)[0], 0.14)

    @property
    def display(self) -> Display:
        return Display(skin="clay", refiner=STATIC_REFINER)

    @property
    def state(self) -> object:
        return super().state, id(self._marking.positions)

    def places(self) -> dict[int, ScreenPoint]:
        """The places of the marks on the visible side, by number."""
        numbers = list(self._marking.marks.places)
        points, normals = self._marking.seen(numbers)
        spots = places_in(self.area, self.camera, points)
        to_eye = self.camera.eye - points
        toward = np.einsum("nki,ni->nk", normals, to_eye).max(axis=1)
        toward /= np.linalg.norm(to_eye, axis=1)
        least_facing_cosine = 0.15  # cosine to the line of sight above which a mark is visible
        faces = toward > least_facing_cosine
        return {n: spots[index] for index, n in enumerate(numbers) if faces[index]}


def places_in(
    area: tuple[float, float, float, float], camera: render.OrbitCamera, points: npt.ArrayLike
) -> list[ScreenPoint]:
    """Project points (n, 3) by a camera whose picture fills an area of the window [units]."""
    left, top, width, height = area
    seen = CameraLabels.from_camera(camera, (width, max(height, 1.0))).project(np.asarray(points))
    return [(left + x, top + y) for x, y in seen.tolist()]


class MarkingMouse(CameraMouse):
    """A click places the current mark; a drag moves a mark, or turns the camera."""

    def __init__(
        self, view: MarkingView, stage: Stage, marking: Marking, messages: Messages
    ) -> None:
        super().__init__(view, stage)
        self._seen = view
        self._marking = marking
        self._messages = messages

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
            self._put(io)
        super()._drag(io)

    def _release(self, io: Any) -> None:
        is_click = self._doing == "orbit" and imgui.is_mouse_released(LEFT_BUTTON)
        is_click = is_click and not self._has_moved(io)
        if is_click and not self._put(io):
            self._messages.show(
                "There is no skin here that faces you; click beside the mouth or the eye"
            )
        elif is_click or self._doing == "mark":
            self._messages.carry_out(self._marking.note)
        self.forget()

    def _put(self, io: Any) -> bool:
        """Place the current mark under the mouse; return False without visible skin there."""
        marking = self._marking
        before = self._marking.marks
        point = self._skin_under(io)
        if point is None:
            return False
        marking.place(marking.current, point)
        is_seen = marking.current in self._seen.places()
        marking.marks = marking.marks if is_seen else before
        return is_seen

    def _mark_under(self, io: Any) -> int | None:
        # Of several marks in one place, for example on touching lips, take the current one.
        off = {
            number: math.dist(spot, io.mouse_pos) - em(0.3) * (number == self._marking.current)
            for number, spot in self._seen.places().items()
        }
        nearest = min(off, key=lambda number: off[number], default=0)
        mark_reach = 0.8  # [em] from a mark within which the mouse grabs it
        return nearest if off.get(nearest, math.inf) < em(mark_reach) else None
