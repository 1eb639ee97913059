"""The viewer's panel: what is shown, the script, expressions, a slider for every control."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from imgui_bundle import imgui

import render  # isort: skip - after imgui_bundle, see app/gui.py

if TYPE_CHECKING:
    from .viewer import Viewer

WIDTH = 340.0  # [window units]
MUTED = imgui.ImVec4(0.62, 0.64, 0.68, 1.0)
SHORTCUTS = (
    ("1 .. 9", "expressions; again: neutral"),
    ("Space", "play / pause the script"),
    ("R", "refinement on / off"),
    ("W", "wireframe"),
    ("C", "colour by number of splits"),
    ("S", "shading: pixel, flat, Gouraud"),
    ("T", "texture on / off"),
    ("N", "everything back to neutral"),
    ("F", "frame the face again"),
    ("drag", "orbit; right drag: pan"),
    ("wheel", "zoom"),
)


@dataclass
class Panel:
    """Draws the panel and carries out what is done in it."""

    viewer: Viewer
    places: dict[str, tuple[float, float, float, float]] = field(default_factory=dict)

    def draw(self, height: float) -> None:
        """Draw everything; called once a frame, inside the GUI's frame."""
        imgui.set_next_window_pos(imgui.ImVec2(0.0, 0.0))
        imgui.set_next_window_size(imgui.ImVec2(WIDTH, height))
        flags = (
            imgui.WindowFlags_.no_title_bar
            | imgui.WindowFlags_.no_resize
            | imgui.WindowFlags_.no_move
            | imgui.WindowFlags_.no_collapse
        )
        imgui.begin("Risorius", None, flags)
        self._counts()
        self._display()
        self._script()
        if self.viewer.scene.expressions:
            self._expressions()
        self._controls()
        self._help()
        imgui.end()

    def _counts(self) -> None:
        viewer = self.viewer
        imgui.text(f"{viewer.frames_per_second:.0f} fps")
        imgui.same_line()
        drawn = viewer.picture.triangle_count
        imgui.text_colored(MUTED, f"{len(viewer.scene.faces)} triangles, {drawn} drawn")

    def _display(self) -> None:
        viewer = self.viewer
        style = viewer.style
        if self._checkbox("Refine (R)", viewer.is_refined):
            viewer.toggle_refinement()
        imgui.same_line()
        if self._checkbox("Wireframe (W)", style.wireframe):
            viewer.restyle(wireframe=not style.wireframe)
        imgui.same_line()
        if self._checkbox("Splits (C)", style.colour_by is render.ColourBy.SPLITS):
            viewer.toggle_splits()
        if self._checkbox("Texture (T)", style.textured):
            viewer.restyle(textured=not style.textured)
        imgui.same_line()
        if imgui.button(f"Shading (S): {style.shading.name.lower()}"):
            viewer.next_shading()

    def _checkbox(self, label: str, is_on: bool) -> bool:
        """Draw a checkbox; whether it was clicked."""
        was_clicked, _ = imgui.checkbox(label, is_on)
        self._remember(label)
        return bool(was_clicked)

    def _script(self) -> None:
        viewer = self.viewer
        imgui.separator_text(f"Script: {viewer.script.title}")
        if imgui.button("Pause" if viewer.is_playing else "Play"):
            viewer.toggle_playing()
        self._remember("play")
        imgui.same_line()
        imgui.set_next_item_width(-1.0)
        changed, time = imgui.slider_float(
            "##time", viewer.script_time, 0.0, viewer.script.duration, "%.2f s"
        )
        self._remember("time")
        if changed:
            viewer.seek(time)

    def _expressions(self) -> None:
        imgui.separator_text("Expressions")
        right_edge = WIDTH - 20.0
        x = 0.0
        for number, name in enumerate(self.viewer.scene.expressions, start=1):
            label = f"{number} {name}" if number <= 9 else name
            label = label.replace("_", " ")
            width = imgui.calc_text_size(label).x + 16.0
            if x and x + width < right_edge:
                imgui.same_line()
            else:
                x = 0.0
            x += width + 8.0
            if imgui.button(label):
                self.viewer.toggle_expression(name)
            self._remember(name)

    def _controls(self) -> None:
        viewer = self.viewer
        imgui.separator_text("Controls")
        if imgui.button("Neutral (N)"):
            viewer.neutral()
        self._remember("Neutral (N)")
        for title, names in viewer.scene.groups.items():
            is_open = imgui.collapsing_header(title)
            self._remember(title)
            if not is_open:
                continue
            for name in names:
                low, high = viewer.scene.limits[name]
                imgui.text_colored(MUTED, name.replace("_", " "))
                imgui.set_next_item_width(-1.0)
                changed, value = imgui.slider_float(
                    f"##{name}", viewer.controls[name], low, high, "%.2f"
                )
                self._remember(name)
                if changed:
                    viewer.set_control(name, value)

    def _help(self) -> None:
        if imgui.collapsing_header("Keys and mouse"):
            for key, meaning in SHORTCUTS:
                imgui.text(key)
                imgui.same_line(70.0)
                imgui.text_colored(MUTED, meaning)

    def _remember(self, name: str) -> None:
        """Keep where the last item is: whoever drives the window from outside needs it."""
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        self.places[name] = (low.x, low.y, high.x, high.y)
