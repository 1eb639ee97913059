"""The panel of the scene: light and background, the person and hair, and the lens."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from imgui_bundle import imgui

from risorius import render
from risorius.assets.identities import HAIR_NAME

from ...control_names import readable
from ...light_maps import LIGHT_SUFFIXES
from ...text import as_text
from ..context import ApplicationContext
from ..documents.file_drop import FileDrop
from ..interface.widgets import choose
from ..messages import Message
from ..settings import BACKGROUND_CHOICES, TONE_ANGLES
from .display_rows import DisplayRows
from .people import PeopleList

OTHER_MAP = "Map ..."
SCENE_HINTS = {
    "Light": "moves with the camera; the shadow follows the key. Map: a file .hdr or .exr with the "
    "light from all directions",
    "Background": "theme: of the window's colours; map: the light map behind the head, of "
    "clouds, room, street or a file",
    "Lens": "the angle of view from top to bottom [degrees]; the face keeps its size. Wide lenses "
    "stand near and make noses large",
    "Person": "another head, on which script and pose go on (--head takes any number)",
    "Skin tone": "by its typology angle; own: as this person has it",
    "Hair": "on the head; lashes and brows stay",
}


class ScenePanel:
    """The panel for everything in front of the camera except the face's motion."""

    def __init__(self, app: ApplicationContext, file_drop: FileDrop) -> None:
        self._app = app
        self._stage = app.stage
        self._view = app.view
        self._file_drop = file_drop
        self._rows = DisplayRows(app, SCENE_HINTS)
        self._people = PeopleList(app, file_drop, self._rows)

    def draw(self) -> None:
        """Draw the panel's content inside its window; for a plane, only the rows that apply."""
        imgui.begin_child("scene")
        rows = self._rows
        scene = self._stage.scene
        self._draw_lights()
        rows.pick("Background", tuple(BACKGROUND_CHOICES))
        camera = self._view.camera
        widest = 5.0, 90.0  # [degrees]
        now = camera.field_of_view
        chosen = rows.slider_row(
            "Lens", "lens", now, widest, render.OrbitCamera.field_of_view, digits=0
        )
        if chosen != now:
            camera.change_lens(chosen)
        if scene.called:
            self._people.draw(scene.called)
        if scene.skin.in_tone is not None:
            rows.pick("Skin tone", tuple(TONE_ANGLES))
        if any(part.name.startswith(HAIR_NAME) for part in scene.parts):
            rows.switch("Hair")
        imgui.end_child()

    def _draw_lights(self) -> None:
        """Draw the list of lights: those with a name, the last maps, and the choice of a file."""
        app = self._app
        present = app.settings.display.light
        maps = [each for each in app.settings.recent if Path(each).suffix.lower() in LIGHT_SUFFIXES]
        if present not in (*render.LIGHTS, *maps):
            maps.insert(0, present)
        self._rows.begin("Light")
        lights = (*render.LIGHTS, *maps, OTHER_MAP)
        chosen = choose(app.gui, "Light", present, lights, light_in_words)
        if chosen is not None:
            app.messages.carry_out(partial(self._choose_light, chosen))

    def _choose_light(self, name: str) -> Message:
        if name == OTHER_MAP:
            self._file_drop.ask_light()
        elif name in render.LIGHTS:
            self._app.settings.display.light = name
        else:
            return self._file_drop.open([name])
        return None


def light_in_words(name: str) -> str:
    """Return a light's name as the list shows it; for a map, the name of its file."""
    if name == OTHER_MAP or name in render.LIGHTS:
        return readable(name)
    return as_text(Path(name).name).replace("##", "# #")  # imgui hides the part after ##
