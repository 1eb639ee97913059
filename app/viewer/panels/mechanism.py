"""The mechanism: refiner and its options, comparison, colours, overlays, what a frame costs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius import refine, render

from ...looks import LOOKS, STATIC, named, words_of_looks
from ...refining import DETAIL, can_detail
from ..colours import COLOURS
from ..control_rows import readable
from ..frame_times import PHASES, FrameTimes
from ..gui import Gui, em
from ..overlays import overlays_of
from ..setting_rules import COMPARISONS, SKINS
from ..settings import Display, Settings
from ..stage import Stage
from ..view import View
from .sliders import Sliders
from .widgets import begin_row, choose, heading, hint, muted

# What the mouse is told that rests on a label or on what it is the label of.
HINTS = {
    "Refine": "draw the refined mesh, or the simulated one as it is (R)",
    "Look": "smooth: what looks best; paper: the paper's own rule (P). A look sets the refiner and "
    "all that it is told; choose it again to undo changes",
    "Refiner": "any that is registered",
    "Compare": "two meshes under one camera: wipe (D), side by side (Shift+D)",
    "with": "what is seen on the left: the simulated mesh, a look, or a refiner",
    "threshold once": "an edge splits once where the normals at its ends have turned apart by more "
    "than this since rest (drop of their dot product)",
    "threshold twice": "the same for splitting twice",
    "criterion": "by what it is decided which edges split; normal: where the face moves (the "
    "paper's), rest: where it is round at rest, so that outlines are, bulge: where the scheme "
    "moves edges, border: where a mouth opens",
    "scheme": "where the new points go",
    "normals": "what light sees; linear: those of the simulated mesh, in between (the paper's), "
    "refined: those of the refined surface",
    "blend": "new points grow out of the edge, and nothing pops",
    "coherent": "triangles are cut in the order in which their edges split, and no line turns; for "
    "flat shading",
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
THRESHOLDS = "threshold_once", "threshold_twice"  # of this criterion alone:
PAPERS_CRITERION = "normal"
LABEL_SHARE = 0.45  # of a row
HIGHEST = 0.25  # of a slider for a number that is no whole one, as far as it is not more already


class MechanismPanel:
    """Everything about how the mesh becomes a picture."""

    def __init__(
        self, gui: Gui, settings: Settings, stage: Stage, view: View, times: FrameTimes
    ) -> None:
        self._gui, self._settings = gui, settings
        self._stage, self._view, self._times = stage, view, times
        self._sliders = Sliders(gui)

    @property
    def _display(self) -> Display:
        return self._settings.display

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        imgui.begin_child("mechanism", (0.0, 0.0), imgui.ChildFlags_.nav_flattened)
        rate = self._times.frames_per_second
        times_label = f"Milliseconds, {rate:.0f} frames a second" if rate else "Milliseconds"
        for title, label, draw in (
            ("Refinement", "", self._draw_refinement),
            ("Style", "", self._draw_style),
            ("Overlays", "", self._draw_overlays),
            ("Milliseconds", times_label, self._draw_times),
        ):
            if heading(self._gui, self._settings, title, label):
                draw()
        imgui.end_child()

    def _draw_refinement(self) -> None:
        display, stage = self._display, self._stage
        self._check("Refine", display.is_refined, partial(display.switch, "is_refined"))
        look = display.look_as_changed(stage.scene)
        self._choose("Look", look, tuple(LOOKS), display.choose_look)
        names = [name for name in refine.available() if name != STATIC]
        put = partial(display.choose_refiner, stage.scene)
        self._choose("Refiner", display.refiner_on(stage.scene), names, put)
        self._choose("Compare", display.compare, COMPARISONS, partial(setattr, display, "compare"))
        if display.compare != "off":
            self._draw_beside((STATIC, *LOOKS, *names))
        for name, default in stage.refiner_options.items():
            if name not in THRESHOLDS or self._has_thresholds():
                self._draw_option(name, default)
        base = len(stage.scene.faces)
        for shot in stage.shots(display, self._view.viewport):
            count = shot.drawn.triangle_count
            imgui.text(f"{shot.drawn.label}: {count} triangles")
            imgui.same_line()
            muted(self._gui, f"({count / base:.2f} x)")
        splits = stage.refined.refiner.splits
        once, more = int((splits == 1).sum()), int((splits > 1).sum())
        muted(self._gui, f"{len(splits)} edges: {once} split once, {more} more often")

    def _draw_beside(self, names: Sequence[str]) -> None:
        """A list of what can be compared with, as captions call it."""
        display = self._display
        labels = {named(name, display.look).label: name for name in names}
        present = named(display.beside, display.look).label
        self._choose(
            "with", present, list(labels), lambda label: setattr(display, "beside", labels[label])
        )

    def _has_thresholds(self) -> bool:
        """Whether the criterion is, or has in it, the one that the thresholds are of."""
        _, told = self._display.refinement_on(self._stage.scene).on(self._stage.scene.name)
        return PAPERS_CRITERION in str(told.get("criterion", PAPERS_CRITERION)).split("+")

    def _draw_option(self, name: str, default: Any) -> None:
        """A slider, a checkbox or a list for an option, by what its default is."""
        scene, refiner = self._stage.scene, self._display.refiner_on(self._stage.scene)
        stored = self._display.options.setdefault(refiner, {})
        told = LOOKS[self._display.look][scene.name].told(refiner)
        value = stored.get(name, told.get(name, default))
        label, put = name.replace("_", " "), partial(stored.__setitem__, name)
        if isinstance(default, bool):
            self._check(label, bool(value), partial(put, not value))
        elif isinstance(default, int):
            is_changed, chosen = imgui.input_int(readable(label), int(value))
            self._gui.remember(label)
            if is_changed:
                put(chosen)
        elif isinstance(default, float):
            limits = 0.0, max(HIGHEST, 2.0 * default)
            slid = self._slide(label, name, float(value), limits, default, digits=3)
            if slid is not None:
                put(slid)
                _keep_in_order(stored, name, slid, told)
        elif isinstance(default, str):
            has_finer = can_detail(scene)
            allowed = [word for word in _choices(name) if word != DETAIL or has_finer]
            if allowed:
                self._choose(label, str(value), allowed, put)
        elif default is None:
            choices = self._stage.open_choices[name]
            present = next(word for word, each in choices.items() if each == value)
            self._choose(label, present, list(choices), lambda word: put(choices[word]))

    def _draw_style(self) -> None:
        display = self._display
        shadings = [shading.value for shading in render.Shading]
        self._choose("Shading", display.shading, shadings, partial(setattr, display, "shading"))
        put = partial(setattr, display, "colours")
        self._choose("Colours", display.colours, tuple(COLOURS), put)
        if COLOURS[display.colours].legend:
            muted(self._gui, COLOURS[display.colours].legend)
        self._choose("Skin", display.skin, tuple(SKINS), partial(setattr, display, "skin"))
        if self._stage.scene.wrinkles is not None:
            depth = self._slide("Wrinkles", "wrinkles", display.wrinkles, (0.0, 1.0), 1.0)
            display.wrinkles = display.wrinkles if depth is None else depth
        self._check("Wireframe", display.wireframe, partial(display.switch, "wireframe"))
        imgui.same_line(_label_width())
        self._check("Occlusion", display.occlusion, partial(display.switch, "occlusion"))

    def _draw_overlays(self) -> None:
        display = self._display
        for index, name in enumerate(overlays_of(self._stage.scene)):
            if index % 2:
                imgui.same_line(_label_width())
            is_on = name in display.overlays
            self._check(name.capitalize(), is_on, partial(display.toggle_overlay, name))

    def _draw_times(self) -> None:
        """A scrolling plot for each phase of the paper's Figure 1, and the median of a second."""
        spacing = imgui.get_style().item_spacing.x
        width = 0.5 * (imgui.get_content_region_avail().x - spacing)
        for index, name in enumerate(PHASES):
            if index % 2:
                imgui.same_line()
            times = np.array(self._times.milliseconds[name], np.float32)
            recent = times[-60:][times[-60:] > 0.0]
            median = float(np.median(recent)) if len(recent) else 0.0
            imgui.plot_lines(
                f"##{name}",
                times,
                overlay_text=f"{readable(name)}  {median:.2f}",
                scale_min=0.0,
                scale_max=max(float(times.max()), 0.1) * 1.3,
                graph_size=(width, em(2.2)),
            )
        self._gui.remember("plot")

    def _check(self, label: str, is_on: bool, switch: Callable[[], None]) -> None:
        is_clicked, _ = imgui.checkbox(readable(label), is_on)
        self._gui.remember(label)
        hint(HINTS.get(label, ""))
        if is_clicked:
            switch()

    def _slide(
        self,
        label: str,
        name: str,
        value: float,
        limits: tuple[float, float],
        neutral: float,
        *,
        digits: int = 2,
    ) -> float | None:
        """A row with a slider; what it was moved to, None if it was not."""
        begin_row(label, HINTS.get(label, ""), LABEL_SHARE)
        slid = self._sliders.draw(name, value, limits, width=-1.0, neutral=neutral, digits=digits)
        return slid.value if slid.is_changed else None

    def _choose(
        self, label: str, present: str, choices: Sequence[str], put: Callable[[str], None]
    ) -> None:
        """A row with a list to choose from."""
        begin_row(label, HINTS.get(label, ""), LABEL_SHARE)
        chosen = choose(self._gui, label, present, choices)
        if chosen is not None:
            put(chosen)


def _label_width() -> float:
    """Where the second column begins, from the left edge of the panel."""
    return float(LABEL_SHARE * imgui.get_window_width())


def _choices(option: str) -> tuple[str, ...]:
    """The words that an option of a refiner may be, those of looks and from outside among them."""
    registered = {"scheme": refine.schemes.available, "criterion": refine.criteria.available}
    if option not in registered:
        return ()
    return tuple(dict.fromkeys((*registered[option](), *words_of_looks(option))))


def _keep_in_order(
    stored: dict[str, Any], name: str, value: float, told: Mapping[str, Any]
) -> None:
    """Splitting twice never begins before splitting once: the other threshold gives way."""
    first, second = THRESHOLDS
    defaults = {first: refine.THRESHOLD_ONCE, second: refine.THRESHOLD_TWICE, **told}
    if name == first:
        stored[second] = max(value, stored.get(second, defaults[second]))
    elif name == second:
        stored[first] = min(value, stored.get(first, defaults[first]))
