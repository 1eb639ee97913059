"""The panel of the scene: light and background, the person and hair, and the lens."""

from __future__ import annotations

from imgui_bundle import imgui

from risorius import render
from risorius.assets.identities import HAIR

from ..context import ApplicationContext
from ..documents.file_drop import FileDrop
from ..settings import BACKGROUNDS, TONES
from .display_rows import DisplayRows
from .people import PeopleList

HINTS = {
    "Light": "hangs on the camera; the shadow follows the key",
    "Background": "theme: of the window's colours; map: what the lights clouds, room and street "
    "show behind the head",
    "Lens": "the angle of view from top to bottom [degrees]; the face keeps its size. Wide lenses "
    "stand near and make noses large",
    "Person": "another head, on which script and pose go on (--head takes any number)",
    "Skin tone": "by its typology angle; own: as this person has it",
    "Hair": "on the head; lashes and brows stay",
}


class ScenePanel:
    """The panel for everything in front of the camera except the face's motion."""

    def __init__(self, app: ApplicationContext, file_drop: FileDrop) -> None:
        self._stage = app.stage
        self._view = app.view
        self._rows = DisplayRows(app, HINTS)
        self._people = PeopleList(app, file_drop, self._rows)

    def draw(self) -> None:
        """Draw the panel's content inside its window; for a plane, only the rows that apply."""
        imgui.begin_child("scene")
        rows = self._rows
        scene = self._stage.scene
        rows.pick("Light", tuple(render.LIGHTS))
        rows.pick("Background", tuple(BACKGROUNDS))
        camera = self._view.camera
        widest = 5.0, 90.0  # [degrees]
        now = camera.field_of_view
        chosen = rows.slide("Lens", "lens", now, widest, render.OrbitCamera.field_of_view, digits=0)
        if chosen != now:
            camera.change_lens(chosen)
        if scene.called:
            self._people.draw(scene.called)
        if scene.skin.in_tone is not None:
            rows.pick("Skin tone", tuple(TONES))
        if any(part.name.startswith(HAIR) for part in scene.parts):
            rows.switch("Hair")
        imgui.end_child()
