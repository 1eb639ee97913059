"""Pictures of poses: a click takes one, a drag across it blends it in."""

from __future__ import annotations

import math
import time
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

from imgui_bundle import imgui

from risorius import render

from ...controls.mirror import mirrored
from ..gui import LEFT, Gui, em, ink_of, wake_up
from ..messages import Messages
from ..poses import Poses, Values
from ..session import Session
from .widgets import button, hint

WIDTH, LINE = 4.6, 1.1  # [em] of a picture at least, and the height of its name
MEANING = "a click takes it, a drag to the right blends it in; with Shift mirrored"


class PoseGrid:
    """Draws the pictures, one after the other; their places are there at once."""

    def __init__(
        self,
        gui: Gui,
        session: Session,
        messages: Messages,
        surface: render.WindowSurface,
        folder: Path | None,
    ) -> None:
        """folder: where the user's own are kept; None for nowhere."""
        self._gui, self._session, self._messages = gui, session, messages
        self._surface, self.folder = surface, folder
        self._poses = Poses(session.scene, folder)
        self._pictures: dict[str, tuple[Values, Any]] = {}  # by title: of which pose, texture
        self._ends: tuple[Values, Values] = ({}, {})  # of the blend that goes on
        self._share = 0.0
        self._due = math.inf  # when there is time for the next picture [s]: not in the first frame

    def draw(self) -> None:
        """All of them, the user's own first, as many in a row as there is room for."""
        if self._poses.scene is not self._session.scene:
            self.close()
            self._poses, self._pictures = Poses(self._session.scene, self.folder), {}
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
