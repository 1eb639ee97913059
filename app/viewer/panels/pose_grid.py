"""Pictures of poses, of the scene and a user's own: a click takes one, a drag blends it in.

A pose of the user's is a script of one pose in a folder, as `Save pose ...` writes it.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Mapping
from functools import cached_property, partial
from itertools import islice
from pathlib import Path
from typing import Any

from imgui_bundle import imgui

from risorius import render

from ...capture import Capture, CaptureOptions
from ...controls.mirror import mirrored
from ...controls.vocabulary import title_of
from ...errors import UserError
from ...files import Image
from ...scenes import FaceScene, Scene
from ...script import is_pose, load_script, pose_script, save_script
from ..context import ApplicationContext
from ..interface.gui import LEFT, em, ink_of, wake_up
from ..interface.widgets import button, hint

SIZE = (150, 150)  # [pixels] of a picture
VIEW = "0,0,1.7"  # the camera
SETTLED = 1.0  # [s] after which a pose stands still
LAYERS = ("Expressions", "Visemes")
OWN = "Pose"  # what the user's own are called, with a number

Values = Mapping[str, float]


class PoseLibrary:
    """The poses of one scene; without a folder there are none of the user's own."""

    def __init__(self, scene: Scene, folder: Path | None) -> None:
        self.scene, self._folder = scene, folder
        self.own: dict[str, Values] = {}
        self.read()

    @cached_property
    def built_in(self) -> dict[str, Values]:
        """The scene's expressions and visemes at their most, by their names."""
        scene = self.scene
        names = [name for layer in LAYERS for name in scene.groups.get(layer, ())]
        return {
            _title(name): {name: 1.0} for name in names if not name.endswith(("_left", "_right"))
        }

    def read(self) -> None:
        """Look into the folder; files that are no poses of this scene are passed by."""
        self.own = {}
        for path in sorted(self._folder.glob("*.toml")) if self._folder is not None else ():
            with contextlib.suppress(UserError):
                script = load_script(path)
                script.check(self.scene.limits)
                if is_pose(script) and script.scene == self.scene.name:
                    self.own[path.stem] = script.at(0.0)

    def save(self, values: Values) -> str:
        """Keep a pose in the folder; a line that says where. UserError where that cannot be."""
        if self._folder is None:
            raise UserError("poses are kept beside the settings, and this window has none")
        taken = {path.stem for path in self._folder.glob("*.toml")}
        name = next(f"{OWN} {n}" for n in range(1, len(taken) + 2) if f"{OWN} {n}" not in taken)
        self._folder.mkdir(parents=True, exist_ok=True)
        script = pose_script(values, title=name, scene=self.scene.name)
        save_script(self._folder / f"{name}.toml", script)
        self.read()
        return f"{name} is kept in {self._folder}"

    @cached_property
    def _capture(self) -> Capture:
        """The same head once more, which is posed where nobody sees it."""
        assert isinstance(self.scene, FaceScene)
        return Capture(self.scene.clone(), CaptureOptions(size=SIZE, camera=VIEW))

    def picture(self, values: Values) -> Image:
        """The face as it comes to rest in a pose, shape (H, W, 3).

        Another context of OpenGL than the caller's is current afterwards. UserError where there is
        no second one.
        """
        try:
            capture = self._capture
        except render.GLError as error:
            raise UserError(f"no pictures of poses: {error}") from None
        capture.surface.make_current()
        capture.scene.reset()
        capture.scene.pose(values)
        capture.scene.step(SETTLED)
        return capture.draw_image()

    def close(self) -> None:
        """Give back what pictures were drawn with."""
        if "_capture" in vars(self):
            self._capture.surface.make_current()
            self._capture.surface.close()
            del self._capture


def _title(name: str) -> str:
    """What is read on a picture: of a viseme the sound."""
    code, plain = title_of(name)
    return code or plain


WIDTH, LINE = 4.6, 1.1  # [em] of a picture at least, and the height of its name
MEANING = "a click takes it, a drag to the right blends it in; with Shift mirrored"


class PoseGrid:
    """Draws the pictures, one after the other; their places are there at once."""

    def __init__(self, app: ApplicationContext, folder: Path | None) -> None:
        """folder: where the user's own are kept; None for nowhere."""
        self._gui, self._session, self._messages = app.gui, app.session, app.messages
        self._surface, self.folder = app.surface, folder
        self._poses = PoseLibrary(app.session.scene, folder)
        self._pictures: dict[str, tuple[Values, Any]] = {}  # by title: of which pose, texture
        self._ends: tuple[Values, Values] = ({}, {})  # of the blend that goes on
        self._share = 0.0
        self._due = math.inf  # when there is time for the next picture [s]: not in the first frame

    def draw(self) -> None:
        """All of them, the user's own first, as many in a row as there is room for."""
        if self._poses.scene is not self._session.scene:
            self.close()
            self._poses, self._pictures = PoseLibrary(self._session.scene, self.folder), {}
        spacing = imgui.get_style().item_spacing.x
        room = imgui.get_content_region_avail().x + spacing
        columns = max(int(room / (em(WIDTH) + spacing)), 1)
        known = {**self._poses.own, **self._poses.built_in}
        for index, (title, values) in enumerate(known.items()):
            if index % columns:
                imgui.same_line()
            self._draw_pose(title, values, max(room / columns - spacing, 1.0))
        missing = (title for title in known if self._pictures.get(title, ({},))[0] != known[title])
        for title in islice(missing, 1):
            now, due = time.perf_counter(), self._due
            if due <= now and not imgui.is_any_mouse_down():
                self._messages.attempt(partial(self._take_picture, title, known[title]))
                due = 2.0 * time.perf_counter() - now  # half of the time is for all else
            self._due = now if due == math.inf else due
            wake_up()  # for the next
        if button(self._gui, "Keep this pose", meaning="the face as it is becomes one of these"):
            self._messages.attempt(partial(self._poses.save, self._session.current))

    def _take_picture(self, title: str, values: Values) -> None:
        self._pictures[title] = values, None  # it is tried once
        try:
            image = self._poses.picture(values)
        finally:
            self._surface.make_current()
        texture = self._surface.gl.texture(image.shape[1::-1], 3, image.tobytes(), alignment=1)
        self._pictures[title] = values, texture

    def _draw_pose(self, title: str, values: Values, width: float) -> None:
        session = self._session
        imgui.invisible_button(f"pose {title}", (width, width + em(LINE)))
        self._gui.remember(f"pose {title}")
        wanted, is_held = session.controls.pose(values), imgui.is_item_active()
        if imgui.is_item_activated():
            to = mirrored(wanted) if imgui.get_io().key_shift else wanted
            self._ends, self._share = (dict(session.values), to), 0.0
        dragged = imgui.get_mouse_drag_delta(LEFT).x
        if is_held and (dragged or self._share):
            self._share = min(max(dragged / width, 0.0), 1.0)
            session.blend(*self._ends, self._share)
        elif imgui.is_item_deactivated():
            if not self._share and imgui.is_item_hovered():  # a click
                session.blend(*self._ends, 1.0)
            session.note()
        else:
            hint(f"{title}: {MEANING}")
        share = self._share if is_held else float(session.values == wanted)
        self._paint(title, share, f"{share:.0%}" if is_held and share else title)

    def _paint(self, title: str, share: float, words: str) -> None:
        """The picture, and below it a bar of how much of it is taken, with its name."""
        theme, paper = self._gui.theme, imgui.get_window_draw_list()
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        foot = high.y - em(LINE)
        back = theme.raised if imgui.is_item_hovered() else theme.field
        paper.add_rect_filled(low, high, ink_of(back))
        full = (low.x + share * (high.x - low.x), high.y)
        paper.add_rect_filled((low.x, foot), full, ink_of(theme.accent, 0.6))
        texture = self._pictures.get(title, ({}, None))[1]
        if texture is not None:
            paper.add_image(imgui.ImTextureRef(texture.glo), low, (high.x, foot))
        paper.push_clip_rect(low, high, True)
        paper.add_text((low.x + em(0.25), foot), ink_of(theme.text), words)
        paper.pop_clip_rect()

    def close(self) -> None:
        """Give back textures, and what drew them."""
        for _, texture in self._pictures.values():
            if texture is not None:
                texture.release()
        self._poses.close()
        self._surface.make_current()
