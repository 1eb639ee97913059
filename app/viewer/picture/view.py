"""What is seen and how: the camera, the display, and where in the window the scene is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict

from imgui_bundle import imgui

from risorius import render

from ...capture.cameras import whole_scene
from ..interface.gui import THEMES, em
from ..session.session import Session
from ..settings import BACKGROUNDS, Display, Settings

WHITE = (1.0, 1.0, 1.0)


class View:
    """One view of a session's scene.

    area: the scene's part of the window: left, top, width, height [window units].
    pointed: the muscles of the control that the mouse is on, and how much each has to do with it.
    """

    camera: render.OrbitCamera
    area: tuple[float, float, float, float]
    pointed: Mapping[str, float]

    def __init__(self, session: Session, settings: Settings, surface: render.WindowSurface) -> None:
        self._session, self._settings, self._surface = session, settings, surface
        self.area = (0.0, 0.0, 1.0, 1.0)
        self.pointed = {}
        self.fit_scene()

    def fit_scene(self) -> None:
        """The camera as at first: all of the scene."""
        self.camera = whole_scene(self._session.scene, self._session.script.camera)

    def look_from(self, label: str) -> None:
        """Turn the camera to one of `render.VIEWS`, about what it looks at."""
        self.camera.yaw, self.camera.pitch = render.VIEWS[label.lower().replace(" ", "-")]

    @property
    def display(self) -> Display:
        """How the scene is drawn."""
        return self._settings.display

    @property
    def background(self) -> render.Background:
        """What is behind it."""
        return BACKGROUNDS[self.display.background] or THEMES[self._settings.theme].background

    @property
    def viewport(self) -> render.Rectangle:
        """Its part of the framebuffer."""
        return self.pixels(self.area)

    def pixels(self, area: tuple[float, float, float, float]) -> render.Rectangle:
        """A part of the window, as one of the framebuffer."""
        display = imgui.get_io().display_size
        width, height = self._surface.size
        across, along = width / max(display.x, 1.0), height / max(display.y, 1.0)
        left, top, wide, high = area
        x, y = round(left * across), round((display.y - top - high) * along)
        return max(x, 0), max(y, 0), max(round(wide * across), 1), max(round(high * along), 1)

    @property
    def letter(self) -> float:
        """How large words are in the window [pixels]: captions are no smaller."""
        return self.pixels((0.0, 0.0, em(), 1.0))[2]

    @property
    def state(self) -> object:
        """Everything that the picture depends on, but for the motion of the scene."""
        display = repr(asdict(self.display))
        camera = self.camera
        place = camera.yaw, camera.pitch, camera.distance, *camera.target.tolist()
        return place, display, self._settings.theme, self.viewport, self.pointed

    def divider(self) -> list[tuple[render.Rectangle, render.Colour]]:
        """The line between the two halves of a comparison, and what to drag it by."""
        if self.display.compare == "off":
            return []
        left, bottom, width, height = self.viewport
        unit = max(round(em(0.13) * width / max(self.area[2], 1.0)), 2)
        x, y = left + round(self.display.share * width), bottom + height // 2
        line = (x - unit // 2, bottom, unit, height)
        grip = (x - unit // 2 - unit, y - 10 * unit, 3 * unit, 20 * unit)
        rules = [(line, WHITE), (grip, THEMES[self._settings.theme].accent)]
        return rules if self.display.compare == "wipe" else rules[:1]
