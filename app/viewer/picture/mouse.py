"""The mouse in the picture: drag the skin, click a muscle, turn the camera, drag the divider.

The left button drags skin; beside the skin it orbits. The right button orbits anywhere, the middle
button or Shift pans, and the wheel zooms to the mouse. skin.py moves the skin during a drag.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius.geometry.arrays import Floats64

from ..interface.gui import LEFT_BUTTON, MIDDLE_BUTTON, RIGHT_BUTTON, em
from ..messages import Messages
from .skin import HoveredMuscle, MuscleFinder, Ray, SkinDrag, skin_under
from .stage import SceneView, Stage

Grab = Callable[..., SkinDrag]
Select = Callable[[str], None]


class CameraMouse:
    """Turns and moves a camera by the mouse; subclasses give the left button more actions."""

    def __init__(self, view: SceneView, stage: Stage) -> None:
        self._view = view
        self._stage = stage
        self.forget()

    def forget(self) -> None:
        """End every drag, because the picture under the mouse has changed."""
        self._doing = ""  # orbit, pan, or the left button's action
        self._pressed_at = (0.0, 0.0)

    @property
    def is_dragging(self) -> bool:
        """Whether the mouse drags something in the picture."""
        return bool(self._doing)

    def follow(self) -> None:
        """Carry out the mouse's actions since the last frame."""
        io = imgui.get_io()
        if self._doing:
            self._drag(io)
            if not any(
                imgui.is_mouse_down(button) for button in (LEFT_BUTTON, RIGHT_BUTTON, MIDDLE_BUTTON)
            ):
                self._release(io)
        elif io.want_capture_mouse or not imgui.is_mouse_pos_valid():
            self._view.hovered = None
        else:
            self._hover(io)
            for button in (LEFT_BUTTON, RIGHT_BUTTON, MIDDLE_BUTTON):
                if imgui.is_mouse_clicked(button):
                    self._press(io, button)
            if io.mouse_wheel:
                self._zoom(io)

    def _hover(self, io: Any) -> None:
        """Respond to the mouse over the picture while no button is pressed."""

    def _take(self, io: Any) -> str:
        """Return the action for a press of the left button here."""
        return "orbit"

    def _press(self, io: Any, button: int) -> None:
        self._pressed_at = (io.mouse_pos.x, io.mouse_pos.y)
        self._view.hovered = None
        if button == MIDDLE_BUTTON or io.key_shift:
            self._doing = "pan"
        elif button == RIGHT_BUTTON or io.key_alt:
            self._doing = "orbit"
        else:
            self._doing = self._take(io)

    def _drag(self, io: Any) -> None:
        camera = self._view.camera
        delta = io.mouse_delta
        if self._doing == "orbit":
            degrees = 5.5 / em()
            camera.orbit(-delta.x * degrees, delta.y * degrees)
        elif self._doing == "pan":
            height = max(self._view.area[3], 1.0)
            camera.pan(-delta.x / height, delta.y / height)

    def _release(self, io: Any) -> None:
        self.forget()

    def _has_moved(self, io: Any) -> bool:
        x, y = self._pressed_at
        click_distance = 4.0  # [window units]: a press with less motion is a click
        return bool(abs(io.mouse_pos.x - x) + abs(io.mouse_pos.y - y) > click_distance)

    def _ray(self, io: Any) -> Ray:
        """Return the ray through the mouse, in the viewport under the mouse."""
        width, height = self._stage.surface.size
        x = io.mouse_pos.x * width / max(io.display_size.x, 1.0)
        y = height - io.mouse_pos.y * height / max(io.display_size.y, 1.0)
        viewports = self._stage.viewports(self._view.display, self._view.viewport)
        under = [each for each in viewports if x >= each.seen[0]] or viewports[:1]
        return Ray.through(self._view.camera, under[-1].area, (x, y))

    def _skin_under(self, io: Any) -> Floats64 | None:
        """Return the point of the mesh under the mouse; None beside the mesh."""
        scene = self._stage.scene
        return skin_under(self._ray(io), scene.positions, scene.faces)

    def _zoom(self, io: Any) -> None:
        """Zoom about the point under the mouse, on the skin or at the target's distance."""
        camera = self._view.camera
        point = self._skin_under(io)
        before = self._view.camera.distance
        if point is None:
            point = self._ray(io).at_depth_of(camera.target, camera.axes()[2])
        closest = 0.15 * camera.scene_radius  # a moving head stays this far away
        room = float(np.linalg.norm(camera.eye - point)) / closest
        zoom_per_notch = 1.1
        camera.zoom(min(zoom_per_notch**io.mouse_wheel, max(room, 1.0)))
        camera.target = point + (camera.target - point) * (camera.distance / before)


class Mouse(CameraMouse):
    """The mouse on a face: it drags the skin, or the line that divides two compared pictures."""

    skin_drag: SkinDrag | None = None

    def __init__(
        self, view: SceneView, stage: Stage, messages: Messages, grab: Grab, select_muscle: Select
    ) -> None:
        """grab: begins to drag the skin. select_muscle: gets the name of a clicked muscle."""
        super().__init__(view, stage)
        self._messages = messages
        self._grab = grab
        self._select_muscle = select_muscle
        self._muscles = MuscleFinder()

    def forget(self) -> None:
        super().forget()
        if self.skin_drag is not None:  # otherwise the skin would stay pulled
            self.skin_drag.drop()
        self.skin_drag = None

    @property
    def is_dragging_skin(self) -> bool:
        """Whether the skin is being dragged."""
        return self.skin_drag is not None and bool(self.skin_drag.offset.any())

    def _hover(self, io: Any) -> None:
        if self._is_at_divider(io.mouse_pos.x):
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
            return
        if io.mouse_delta.x or io.mouse_delta.y:
            self._view.hovered = self._muscle_under(io)

    def _muscle_under(self, io: Any) -> HoveredMuscle | None:
        """Return the muscle under the mouse; None beside the skin."""
        face = self._stage.scene.face
        point = None if face is None else self._skin_under(io)
        if face is None or point is None:
            return None
        return self._muscles.at(face.simulation, point)

    def _take(self, io: Any) -> str:
        if self._is_at_divider(io.mouse_pos.x):
            return "divider"
        point = self._skin_under(io)
        if point is None or self._stage.scene.face is None:
            return "orbit"
        self.skin_drag = self._grab(point, self._ray(io).direction, poses=not io.key_ctrl)
        return "skin"

    def _drag(self, io: Any) -> None:
        super()._drag(io)
        left, _, width, _ = self._view.area
        if self._doing == "divider":
            self._view.display.divider = min(max((io.mouse_pos.x - left) / width, 0.0), 1.0)
        elif self.skin_drag is not None and (self._has_moved(io) or self.is_dragging_skin):
            across = self._view.camera.axes()[2]
            to = self._ray(io).at_depth_of(self.skin_drag.point, across)
            self._messages.attempt(partial(self.skin_drag.drag_to, to))

    def _release(self, io: Any) -> None:
        if self.skin_drag is not None:
            self._messages.attempt(self.skin_drag.release)
            if not self.is_dragging_skin and not self._has_moved(io):
                name = self.skin_drag.muscle()
                if name is not None:
                    self._select_muscle(name)
        self.forget()

    def _is_at_divider(self, x: float) -> bool:
        display = self._view.display
        left, _, width, _ = self._view.area
        return display.compare == "wipe" and abs(x - left - display.divider * width) < 0.4 * em()
