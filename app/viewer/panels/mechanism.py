"""The mechanism: refiner and its options, comparison, colours, overlays, what a frame costs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from imgui_bundle import imgui

from risorius import refine, render

from ...refining import DETAIL, can_detail, options_of
from .. import commands
from ..colours import COLOURS
from ..gui import colour, em
from ..overlays import overlays_of
from ..setting_rules import COMPARISONS, SKINS
from ..stage import STAGES
from .folds import fold
from .sliders import Sliders
from .words import hint

if TYPE_CHECKING:
    from ..window import Viewer

# Words that options of refiners may be, asked of the plug-in.
CHOICES: dict[str, Sequence[str]] = {
    "scheme": refine.schemes.available(),
    "criterion": ("normal", "normal+rest", *refine.criteria.available()[1:]),
}
# What the mouse is told that rests on a label or on what it is the label of.
HINTS = {
    "Refine": "draw the refined mesh, or the simulated one as it is (R)",
    "Refiner": "any that is registered",
    "Compare": "the simulated mesh beside the refined one: wipe (D), side by side (Shift+D)",
    "threshold once": "an edge splits once where the normals at its ends have turned apart by more "
    "than this since rest (drop of their dot product)",
    "threshold twice": "the same for splitting twice",
    "criterion": "by what it is decided which edges split; normal: where the face moves (the "
    "paper's), rest: where it is round at rest, so that outlines are",
    "scheme": "where the new points go",
    "blend": "new points grow out of the edge, and nothing pops",
    "coherent": "an edge keeps its split a little longer, and nothing flickers",
    "levels": "how often all triangles are split",
    "Shading": "S goes through them",
    "Colours": "of the simulated mesh's triangles, whatever they are refined to (C: splits)",
    "Skin": "T switches the texture",
    "Wrinkles": "how deep they are where the simulated skin is compressed; pixel shading has them",
    "Wireframe": "the edges of all triangles that are drawn (W)",
    "Occlusion": "less light from all around in folds of the textured skin",
    "Muscles": "their fibres, redder the more they contract (U)",
    "Springs": "the skin's: stretched red, compressed blue",
    "Skull": "the bone under the skin; the mandible moves with the jaw",
    "Landmarks": "the 68 points that the muscles are placed by",
}
LABEL_SHARE = 0.45  # of a row
HIGHEST = 0.25  # of a slider for a number that is no whole one, as far as it is not more already


class MechanismPanel:
    """Everything about how the mesh becomes a picture."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer
        self._sliders = Sliders(viewer.gui)

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        imgui.begin_child("mechanism", imgui.ImVec2(0.0, 0.0))
        self._draw_refinement()
        self._draw_look()
        self._draw_overlays()
        self._draw_times()
        imgui.end_child()

    def _draw_refinement(self) -> None:
        viewer, look = self._viewer, self._viewer.look
        if not fold(viewer, "Refinement"):
            return
        self._check("Refine", look.is_refined, lambda: commands.toggle(viewer, "is_refined"))
        names = [name for name in refine.available() if name != "none"]
        self._choose("Refiner", "refiner", names)
        self._choose("Compare", "compare", COMPARISONS)
        for name, default in options_of(look.refiner).items():
            self._draw_option(name, default)
        shots = viewer.stage.shots(look, viewer.viewport)
        base = len(viewer.scene.faces)
        for shot in shots:
            count = shot.picture.triangle_count
            imgui.text(f"{shot.label}: {count} triangles")
            imgui.same_line()
            imgui.text_colored(colour(viewer.gui.theme.muted), f"({count / base:.2f} x)")
        splits = viewer.stage.refined.refiner.splits
        once, twice = int((splits == 1).sum()), int((splits == 2).sum())
        imgui.text_colored(
            colour(viewer.gui.theme.muted),
            f"{len(splits)} edges: {once} split once, {twice} twice",
        )

    def _draw_option(self, name: str, default: Any) -> None:
        """A slider, a checkbox or a list for an option, by what its default is."""
        viewer, look = self._viewer, self._viewer.look
        stored = look.options.setdefault(look.refiner, {})
        scenes = viewer.scene.refiner_options.get(look.refiner, {})
        value = stored.get(name, scenes.get(name, default))
        label = name.replace("_", " ")
        if isinstance(default, bool):
            self._check(label, bool(value), lambda: _put(stored, name, not value))
        elif isinstance(default, int):
            is_changed, chosen = imgui.input_int(label, int(value))
            viewer.gui.remember(label)
            if is_changed:
                stored[name] = chosen
        elif isinstance(default, float):
            most = max(HIGHEST, 2.0 * default)
            imgui.align_text_to_frame_padding()
            imgui.text(label)
            hint(HINTS.get(label, ""))
            imgui.same_line(_label_width())
            slid = self._sliders.draw(
                name, float(value), (0.0, most), width=-1.0, neutral=default, digits=3
            )
            if slid.is_changed:
                stored[name] = slid.value
                _keep_in_order(stored, name, slid.value, scenes)
        elif isinstance(default, str):
            has_finer = can_detail(viewer.scene)
            allowed = [word for word in CHOICES.get(name, ()) if word != DETAIL or has_finer]
            if allowed:
                self._choose(label, name, allowed, of=stored, default=str(value))
        elif default is None:
            words = {"as it suits": None, "on": True, "off": False}
            present = next(word for word, each in words.items() if each is value)
            self._choose_among(label, present, list(words), lambda w: _put(stored, name, words[w]))

    def _draw_look(self) -> None:
        viewer, look = self._viewer, self._viewer.look
        if not fold(viewer, "Look"):
            return
        self._choose("Shading", "shading", [shading.value for shading in render.Shading])
        self._choose("Colours", "colours", tuple(COLOURS))
        if COLOURS[look.colours].legend:
            imgui.text_colored(colour(viewer.gui.theme.muted), COLOURS[look.colours].legend)
        self._choose("Skin", "skin", tuple(SKINS))
        if viewer.scene.wrinkles is not None:
            self._draw_wrinkles()
        self._check("Wireframe", look.wireframe, lambda: commands.toggle(viewer, "wireframe"))
        imgui.same_line(_label_width())
        self._check("Occlusion", look.occlusion, lambda: commands.toggle(viewer, "occlusion"))

    def _draw_wrinkles(self) -> None:
        look = self._viewer.look
        imgui.align_text_to_frame_padding()
        imgui.text("Wrinkles")
        hint(HINTS["Wrinkles"])
        imgui.same_line(_label_width())
        slid = self._sliders.draw("wrinkles", look.wrinkles, (0.0, 1.0), width=-1.0, neutral=1.0)
        look.wrinkles = slid.value

    def _draw_overlays(self) -> None:
        viewer = self._viewer
        names = overlays_of(viewer.scene)
        if not fold(viewer, "Overlays"):
            return
        for index, name in enumerate(names):
            if index % 2:
                imgui.same_line(_label_width())
            is_on = name in viewer.look.overlays
            self._check(
                name.capitalize(), is_on, lambda name=name: commands.toggle_overlay(viewer, name)
            )

    def _draw_times(self) -> None:
        """A scrolling plot for each stage of the paper's Figure 1, and the median of a second."""
        stage, rate = self._viewer.stage, self._viewer.frames_per_second
        if not fold(self._viewer, "Milliseconds", f"Milliseconds, {rate:.0f} frames a second"):
            return
        spacing = imgui.get_style().item_spacing.x
        width = 0.5 * (imgui.get_content_region_avail().x - spacing)
        for index, name in enumerate(STAGES):
            if index % 2:
                imgui.same_line()
            times = np.array(stage.times[name], np.float32)
            recent = times[-60:][times[-60:] > 0.0]
            median = float(np.median(recent)) if len(recent) else 0.0
            imgui.plot_lines(
                f"##{name}",
                times,
                overlay_text=f"{name}  {median:.2f}",
                scale_min=0.0,
                scale_max=max(float(times.max()), 0.1) * 1.3,
                graph_size=imgui.ImVec2(width, em(2.2)),
            )
        self._viewer.gui.remember("plot")

    def _check(self, label: str, is_on: bool, switch: Any) -> None:
        is_clicked, _ = imgui.checkbox(label, is_on)
        self._viewer.gui.remember(label)
        hint(HINTS.get(label, ""))
        if is_clicked:
            switch()

    def _choose(
        self,
        label: str,
        name: str,
        choices: Sequence[str],
        *,
        of: dict[str, Any] | None = None,
        default: str = "",
    ) -> None:
        """A list to choose from, for a field of the look or an entry of a table."""

        def take(choice: str) -> None:
            if of is not None:
                of[name] = choice
            else:
                setattr(self._viewer.look, name, choice)

        present = default if of is not None else getattr(self._viewer.look, name)
        self._choose_among(label, present, choices, take)

    def _choose_among(
        self, label: str, present: str, choices: Sequence[str], take: Callable[[str], None]
    ) -> None:
        imgui.align_text_to_frame_padding()
        imgui.text(label)
        hint(HINTS.get(label, ""))
        imgui.same_line(_label_width())
        imgui.set_next_item_width(-1.0)
        is_open = imgui.begin_combo(f"##{label}", present)
        self._viewer.gui.remember(label)
        if not is_open:
            return
        for choice in choices:
            is_clicked, _ = imgui.selectable(choice, choice == present)
            self._viewer.gui.remember(f"{label}: {choice}")
            if is_clicked:
                take(choice)
        imgui.end_combo()


def _label_width() -> float:
    """Where the second column begins, from the left edge of the panel."""
    return float(LABEL_SHARE * imgui.get_window_width())


def _put(stored: dict[str, Any], name: str, value: Any) -> None:
    stored[name] = value


def _keep_in_order(
    stored: dict[str, Any], name: str, value: float, scenes: Mapping[str, Any]
) -> None:
    """Splitting twice never begins before splitting once: the other threshold gives way."""
    first, second = "threshold_once", "threshold_twice"
    defaults = {first: refine.THRESHOLD_ONCE, second: refine.THRESHOLD_TWICE, **scenes}
    if name == first:
        stored[second] = max(value, stored.get(second, defaults[second]))
    elif name == second:
        stored[first] = min(value, stored.get(first, defaults[first]))
