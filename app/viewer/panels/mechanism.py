"""The mechanism: refiner and its options, comparison, colours, overlays, times of a frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from functools import partial
from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius import refine, render
from risorius.assets.identities import NAMED

from ...anatomy import OPACITY, SIDES, STRUCTURES
from ...control_names import readable
from ...refining.presets import PRESETS, STATIC, THRESHOLDS, words_of_presets
from ...refining.refiners import DETAIL, OF, can_detail, options_of
from ...scenes import BUILT_IN, COARSE, OWN, head_in_words
from ..context import ApplicationContext
from ..documents.file_drop import FileDrop
from ..interface.widgets import LabelledRows, button, heading, muted
from ..messages import Message
from ..session.physics import PHASES
from ..settings import BACKGROUNDS, COMPARISONS, SKINS, TONES, Display, switch

# Hints for the mouse on a label, or on the item that has the label.
HINTS = {
    "Refine": "draw the refined mesh, or the simulated one as it is ([Refine])",
    "Look": "smooth: the best picture; paper: the paper's own rule ([Paper's look]). A look sets "
    "the refiner and all of its options",
    "Refiner": "kahler: the paper's; a look as it is goes to a graphics card (kahler-gl) by "
    "itself where the mesh is large",
    "Compare": "the simulated mesh or a look at the left, refined at the right, under one camera: "
    "wipe ([Compare: wipe]) or side by side ([Compare: side by side])",
    "Beside": "at the left of a comparison: a look, or none, the simulated mesh as it is",
    "Colour by splits": "of the edges of the simulated mesh's triangles ([Colour by splits])",
    "Wires of splits": "outlines of simulated triangles that are split more than at rest",
    "Wrinkles": "how deep they are where the simulated skin is compressed; pixel shading has them",
    "Wireframe": "the edges of all triangles that are drawn ([Wireframe])",
    "Skin maps": "fine shape (with pixel shading), and less light in folds (with texture)",
    "Skin tone": "by its typology angle; own: as this person has it",
    "Person": "another head, on which script and pose go on (--head takes any number)",
    "Muscles": "under translucent skin; they bulge and redden as they contract ([Muscles])",
    "Skull": "under translucent skin, fitted to the head; the mandible moves with the jaw",
    "Skin opacity": "over muscles and skull; 0: no skin",
    "Dissect": "the side of the face whose skin is translucent",
}
NUMBERS = ("integer", "number")  # kinds of options that are sliders
# Rows of fields of the display, by their labels.
FIELDS = {
    "Refine": "is_refined",
    "Skin tone": "tone",
    "Colour by splits": "splits",
    "Wires of splits": "wires",
}
FIELDS |= {each.name.capitalize().replace("_", " "): each.name for each in fields(Display)}


class MechanismPanel:
    """Everything about how the mesh becomes a picture."""

    def __init__(self, app: ApplicationContext, file_drop: FileDrop) -> None:
        self._gui = app.gui
        self._settings = app.settings
        self._messages = app.messages
        self._file_drop = file_drop
        self._stage = app.stage
        self._view = app.view
        self._times = app.times
        self._rows = LabelledRows(app.gui, share=0.45, hints=HINTS)
        self._before_reset: Display | None = None

    @property
    def _display(self) -> Display:
        return self._settings.display

    def draw(self) -> None:
        """Draw everything, inside the window's panel."""
        imgui.begin_child("mechanism")
        self._draw_reset()
        rate = self._times.frames_per_second
        times_label = f"Milliseconds, {rate:.0f} frames a second" if rate else "Milliseconds"
        for title, label, draw in (
            ("Refinement", "", self._draw_refinement),
            ("Advanced", "", self._draw_advanced),
            ("Style", "", self._draw_style),
            ("Anatomy", "", self._draw_anatomy),
            ("Light and person", "", self._draw_light_and_person),
            ("Milliseconds", times_label, self._draw_times),
        ):
            if title == "Anatomy" and self._stage.scene.face is None:
                continue
            if heading(self._gui, self._settings.folds, title, label):
                draw()
        display = self._display
        display.options = {name: chosen for name, chosen in display.options.items() if chosen}
        imgui.end_child()

    def _draw_reset(self) -> None:
        """A button that resets all; right after that, it takes the reset back."""
        is_first = self._display == Display()
        if not is_first:
            self._before_reset = None
        elif self._before_reset is not None:
            if button(self._gui, "Undo reset", meaning="all of this as it was before"):
                self._settings.display = self._before_reset
            return
        imgui.begin_disabled(is_first)
        if button(self._gui, "Reset all", meaning="all of this as at first, except the person"):
            self._before_reset = self._display
            self._settings.display = Display()
        imgui.end_disabled()

    def _draw_refinement(self) -> None:
        display = self._display
        stage = self._stage
        self._switch("Refine")
        look = display.preset_as_changed(stage.scene)
        self._choose("Look", look, tuple(PRESETS), display.choose_preset)
        has_thresholds = display.refinement_on(stage.scene).has_thresholds(stage.scene.name)
        for name, option in self._options().items():
            if option.kind in NUMBERS and (name not in THRESHOLDS or has_thresholds):
                self._draw_option(name, option)
        self._pick("Compare", COMPARISONS)
        if display.compare != "off":
            self._pick("Beside", (STATIC, *PRESETS))
        base = len(stage.scene.faces)
        for drawn, *_ in stage.viewports(display, self._view.viewport):
            count = drawn.triangle_count
            imgui.text(f"{drawn.label}: {count} triangles")
            imgui.same_line()
            muted(self._gui, f"({count / base:.2f} x)")

    def _draw_advanced(self) -> None:
        """Rows for settings that a look sets well: the refiner, its words and switches."""
        scene = self._stage.scene
        names = [name for name in refine.refiners.available() if name != STATIC]
        put = partial(self._display.choose_refiner, scene)
        self._choose("Refiner", self._display.refiner_on(scene), names, put)
        for name, option in self._options().items():
            if option.kind not in NUMBERS:
                self._draw_option(name, option)
        self._switch("Skin maps")

    def _options(self) -> dict[str, refine.Option]:
        """The options of the refiner and its criterion; none of one that cannot be loaded."""
        scene = self._stage.scene
        display = self._display
        criterion = display.refinement_on(scene).criterion_on(scene.name)
        try:
            return options_of(display.refiner_on(scene), criterion)
        except (ValueError, TypeError):  # which was reported
            return {}

    def _draw_option(self, name: str, option: refine.Option) -> None:
        """Draw a slider, a checkbox or a list for an option, by its kind."""
        scene = self._stage.scene
        refiner = self._display.refiner_on(self._stage.scene)
        stored = self._display.options.setdefault(refiner, {})
        of_look = PRESETS[self._display.look][scene.name].options_for(refiner)
        default = of_look.get(name, option.default)
        value = stored.get(name, default)
        label = name.replace("_", " ").replace(OF, " ")
        if option.help:
            self._rows.hints.setdefault(label, option.help)
        put = partial(stored.__setitem__, name)
        if option.kind == "switch":
            self._check(label, bool(value), partial(put, not value))
        elif option.kind == "integer":
            self._rows.begin(label)
            is_changed, chosen = imgui.input_int(f"##{label}", int(value))
            self._gui.remember(label)
            if is_changed and option.allows(chosen):
                put(chosen)
        elif option.kind == "number":
            limits = option.least or 0.0, 2.0 * float(default) or 1.0  # the look's is in the middle
            digits = max(3, 1 - math.floor(math.log10(limits[1])))
            slid = self._rows.slide(label, name, float(value), limits, default, digits=digits)
            if slid != value:
                put(slid)
                _keep_in_order(stored, name, slid, {**self._defaults(), **of_look})
        elif option.kind == "word":
            has_finer = can_detail(scene)
            allowed = [word for word in _choices(name) if word != DETAIL or has_finer]
            if allowed:
                self._choose(label, str(value), allowed, put)
        else:
            choices = option.choices
            present = next(word for word, each in choices.items() if each == value)
            self._choose(label, present, list(choices), lambda word: put(choices[word]))

    def _defaults(self) -> dict[str, Any]:
        return {name: option.default for name, option in self._options().items()}

    def _draw_style(self) -> None:
        display = self._display
        self._pick("Shading", [shading.value for shading in render.Shading])
        self._pick("Skin", tuple(SKINS))
        if self._stage.scene.skin.wrinkles is not None:
            now = display.wrinkles
            display.wrinkles = self._rows.slide("Wrinkles", "wrinkles", now, (0.0, 1.0), 1.0)
        self._switch("Wireframe")
        self._switch("Colour by splits")
        imgui.same_line(self._rows.second)
        self._switch("Wires of splits")

    def _draw_light_and_person(self) -> None:
        scene = self._stage.scene
        self._pick("Light", tuple(render.LIGHTS))
        self._pick("Background", tuple(BACKGROUNDS))
        if scene.skin.in_tone is not None:
            self._pick("Skin tone", tuple(TONES))
        if scene.called:
            listed = (COARSE, *NAMED, *range(20))  # and some of those without names
            people = {head_in_words(who): who for who in listed}
            who = int(scene.called) if scene.called.isdecimal() else scene.called
            present = scene.called if who in (BUILT_IN, OWN) else head_in_words(who)
            show = lambda name: self._file_drop.show_person(people.get(name))  # noqa: E731
            self._choose("Person", present, (BUILT_IN, *people), show)

    def _draw_anatomy(self) -> None:
        display = self._display
        for index, name in enumerate(STRUCTURES):
            if index:
                imgui.same_line(self._rows.second)
            is_on = name in display.overlays
            self._check(name.capitalize(), is_on, partial(display.toggle_overlay, name))
        if display.anatomy.structures:
            now = display.skin_opacity
            label = "Skin opacity"
            name = "skin_opacity"
            display.skin_opacity = self._rows.slide(label, name, now, (0.0, 1.0), OPACITY)
            self._pick("Dissect", tuple(SIDES))

    def _draw_times(self) -> None:
        """The median of each phase of the paper's Figure 1, of the frames in which it was done."""
        for name in PHASES:
            times = np.array(self._times.milliseconds[name])
            imgui.text(readable(name))
            imgui.same_line(self._rows.second)
            imgui.text(f"{np.median(times[times > 0.0]) if times.any() else 0.0:.2f}")

    def _switch(self, label: str) -> None:
        """A checkbox for a field of the display."""
        name = FIELDS[label]
        self._check(label, getattr(self._display, name), partial(switch, self._display, name))

    def _check(self, label: str, is_on: bool, switch: Callable[[], None]) -> None:
        is_clicked, _ = imgui.checkbox(readable(label), is_on)
        self._gui.remember(label)
        self._rows.end(label)
        if is_clicked:
            switch()

    def _pick(self, label: str, choices: Sequence[str]) -> None:
        """A row with a list for a field of the display."""
        name = FIELDS[label]
        put = partial(setattr, self._display, name)
        self._choose(label, getattr(self._display, name), choices, put)

    def _choose(
        self, label: str, present: str, choices: Sequence[str], put: Callable[[str], Message]
    ) -> None:
        """A row with a list to choose from."""
        chosen = self._rows.choose(label, present, choices)
        if chosen is not None:
            self._messages.carry_out(partial(put, chosen))


def _choices(option: str) -> tuple[str, ...]:
    """The words that an option of a refiner may be, those of looks and from outside among them."""
    registered = {"scheme": refine.schemes.available, "criterion": refine.criteria.available}
    if option not in registered:
        return ()
    return tuple(dict.fromkeys((*registered[option](), *words_of_presets(option))))


def _keep_in_order(
    stored: dict[str, Any], name: str, value: float, defaults: Mapping[str, Any]
) -> None:
    """Splitting twice never begins before splitting once: the other threshold gives way."""
    start = name.removesuffix("once").removesuffix("twice")
    first = f"{start}once"
    second = f"{start}twice"
    if name == first and second in defaults:
        stored[second] = max(value, stored.get(second, defaults[second]))
    elif name == second and first in defaults:
        stored[first] = min(value, stored.get(first, defaults[first]))
