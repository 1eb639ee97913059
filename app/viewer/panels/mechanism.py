"""The panel of refinement: refiner, options, comparison, colours, overlays, frame times."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from imgui_bundle import imgui

from risorius import refine, render

from ...anatomy import SIDE_SIGNS, SKIN_OPACITY, STRUCTURES
from ...control_names import readable
from ...errors import UserError
from ...refining.presets import (
    PRESETS,
    STATIC_LABEL,
    STATIC_REFINER,
    THRESHOLD_OPTIONS,
    words_of_presets,
)
from ...refining.refiners import DETAIL_SCHEME, OPTION_MARK, can_detail, options_of
from ...text import counted
from ..context import ApplicationContext
from ..interface.widgets import button, heading, muted
from ..session.physics import PHASE_NAMES
from ..settings import COMPARISON_NAMES, SKIN_CHOICES, Display
from .display_rows import DisplayRows

# Hints that appear while the mouse is on a label or its item.
MECHANISM_HINTS = {
    "Refine": "draw the refined mesh, or the simulated one as it is ([Refine])",
    "Look": "smooth: the best picture; paper: the paper's own rule ([Paper's look]). A look sets "
    "the refiner and all of its options",
    "Refiner": "kahler: the paper's; a look as it is goes to a graphics card (kahler-gl) by "
    "itself where the mesh is large",
    "Compare": "the simulated mesh or a look at the left, refined at the right, under one camera: "
    "wipe ([Compare: wipe]) or side by side ([Compare: side by side])",
    "Beside": "at the left of a comparison: static, the simulated mesh as it is, or a look",
    "Colour by splits": "of the edges of the simulated mesh's triangles ([Colour by splits])",
    "Wires of splits": "outlines of simulated triangles that are split more than at rest",
    "Wrinkles": "their depth where the simulated skin is compressed; only pixel shading has them",
    "Wireframe": "the edges of all triangles that are drawn ([Wireframe])",
    "Skin maps": "fine shape (with pixel shading), and less light in folds (with texture)",
    "Muscles": "under translucent skin; they bulge and redden as they contract ([Muscles])",
    "Skull": "under translucent skin, fitted to the head; the mandible moves with the jaw",
    "Skin opacity": "over muscles and skull; 0: no skin",
    "Dissect": "the side of the face whose skin is translucent",
}
EQUAL_SIDES_TEXT = "Both sides show the same look."
NUMBER_KINDS = ("integer", "number")  # kinds of options that are numbers
# Chosen: a second for each frame on software OpenGL, so that the number can be lowered again.
MOST_SHOWN_TRIANGLES = 600_000


class MechanismPanel:
    """The panel with the settings for the steps from mesh to picture."""

    def __init__(self, app: ApplicationContext) -> None:
        self._gui = app.gui
        self._settings = app.settings
        self._stage = app.stage
        self._view = app.view
        self._messages = app.messages
        self._times = app.times
        self._rows = DisplayRows(app, MECHANISM_HINTS)
        self._before_reset: Display | None = None

    @property
    def _display(self) -> Display:
        return self._settings.display

    def draw(self) -> None:
        """Draw the panel's content inside its window."""
        imgui.begin_child("mechanism")
        self._draw_reset()
        for title, draw in (
            ("Refinement", self._draw_refinement),
            ("Advanced", self._draw_advanced),
            ("Style", self._draw_style),
            ("Anatomy", self._draw_anatomy),
            ("Milliseconds", self._draw_times),
        ):
            if title == "Anatomy" and self._stage.scene.face is None:
                continue
            if heading(self._gui, self._settings.folds, title):
                draw()
        display = self._display
        display.options = {name: chosen for name, chosen in display.options.items() if chosen}
        imgui.end_child()

    def _draw_reset(self) -> None:
        """Draw a button that resets all; directly after a reset, the button undoes it."""
        at_first = self._display.as_at_first()
        is_first = self._display == at_first
        if not is_first:
            self._before_reset = None
        elif self._before_reset is not None:
            if button(self._gui, "Undo reset", meaning="all these settings as they were before"):
                self._settings.display = self._before_reset
            return
        imgui.begin_disabled(is_first)
        if button(self._gui, "Reset all", meaning="the defaults of all these settings"):
            self._before_reset = self._display
            self._settings.display = at_first
        imgui.end_disabled()

    def _draw_refinement(self) -> None:
        display = self._display
        stage = self._stage
        self._rows.switch("Refine")
        look = display.preset_as_changed(stage.scene)
        self._rows.choice_row("Look", look, tuple(PRESETS), display.choose_preset)
        has_thresholds = display.refinement_on(stage.scene).has_thresholds(stage.scene.name)
        for name, option in self._options().items():
            if option.kind in NUMBER_KINDS and (name not in THRESHOLD_OPTIONS or has_thresholds):
                self._draw_option(name, option)
        self._rows.pick("Compare", COMPARISON_NAMES)
        if display.compare != "off":
            looks = {STATIC_LABEL: STATIC_REFINER} | {look: look for look in PRESETS}
            beside = STATIC_LABEL if display.beside == STATIC_REFINER else display.beside
            put = lambda label: setattr(display, "beside", looks[label])  # noqa: E731
            self._rows.choice_row("Beside", beside, tuple(looks), put)
            if display.has_equal_sides(stage.scene):
                muted(self._gui, EQUAL_SIDES_TEXT)
                self._gui.remember(EQUAL_SIDES_TEXT)
        base = len(stage.scene.faces)
        for drawn, *_ in stage.viewports(display, self._view.viewport):
            count = drawn.triangle_count
            imgui.text(f"{drawn.label}: {count} triangles")
            imgui.same_line()
            muted(self._gui, f"({count / base:.2f} x)")

    def _draw_advanced(self) -> None:
        """Draw rows for the refiner and its options that are not numbers; looks set these well."""
        scene = self._stage.scene
        names = [name for name in refine.refiners.available() if name != STATIC_REFINER]
        put = partial(self._display.choose_refiner, scene)
        self._rows.choice_row("Refiner", self._display.refiner_on(scene), names, put)
        for name, option in self._options().items():
            if option.kind not in NUMBER_KINDS:
                self._draw_option(name, option)
        skin = scene.skin
        if skin.fine_shape is not None or skin.ambient_occlusion is not None:
            self._rows.switch("Skin maps")

    def _options(self) -> dict[str, refine.Option]:
        """Return the options of the refiner and its criterion; none if they cannot be loaded."""
        scene = self._stage.scene
        display = self._display
        criterion = display.refinement_on(scene).criterion_on(scene.name)
        try:
            return options_of(display.refiner_on(scene), criterion)
        except (ValueError, TypeError):  # already reported
            return {}

    def _draw_option(self, name: str, option: refine.Option) -> None:
        """Draw a slider, a checkbox or a list for an option, by its kind."""
        scene = self._stage.scene
        refiner = self._display.refiner_on(self._stage.scene)
        stored = self._display.options.setdefault(refiner, {})
        of_look = PRESETS[self._display.look][scene.name].options_for(refiner)
        default = of_look.get(name, option.default)
        value = stored.get(name, default)
        label = name.replace("_", " ").replace(OPTION_MARK, " ")
        if option.help:
            self._rows.hints.setdefault(label, option.help)
        put = partial(stored.__setitem__, name)
        if option.kind == "switch":
            self._rows.check(label, bool(value), partial(put, not value))
        elif option.kind == "integer":
            self._rows.begin(label)
            is_changed, chosen = imgui.input_int(f"##{label}", int(value))
            self._gui.remember(label)
            if is_changed:
                check = partial(_check_count, name, option, chosen, len(scene.faces))
                self._messages.carry_out(partial(_set_checked, check, put, chosen))
        elif option.kind == "number":
            limits = option.least or 0.0, 2.0 * float(default) or 1.0  # the look's is the middle
            digits = max(3, 1 - math.floor(math.log10(limits[1])))
            slid = self._rows.slider_row(label, name, float(value), limits, default, digits=digits)
            if slid != value:
                put(slid)
                _keep_in_order(stored, name, slid, {**self._defaults(), **of_look})
        elif option.kind == "word":
            has_finer = can_detail(scene)
            allowed = [word for word in choices_of(name) if word != DETAIL_SCHEME or has_finer]
            if allowed:
                self._rows.choice_row(label, str(value), allowed, put)
        else:
            choices = option.choices
            present = next(word for word, each in choices.items() if each == value)
            self._rows.choice_row(label, present, list(choices), lambda word: put(choices[word]))

    def _defaults(self) -> dict[str, Any]:
        return {name: option.default for name, option in self._options().items()}

    def _draw_style(self) -> None:
        display = self._display
        self._rows.pick("Shading", [shading.value for shading in render.Shading])
        skin = self._stage.scene.skin
        is_textured = skin.albedo is not None
        possible = [
            name for name, (is_picture, _) in SKIN_CHOICES.items() if is_textured >= is_picture
        ]
        present = display.skin if display.skin in possible else possible[0]
        self._rows.choice_row("Skin", present, possible, partial(setattr, display, "skin"))
        if self._stage.scene.skin.wrinkles is not None:
            now = display.wrinkles
            display.wrinkles = self._rows.slider_row("Wrinkles", "wrinkles", now, (0.0, 1.0), 1.0)
        self._rows.switch("Wireframe")
        self._rows.switch("Colour by splits")
        imgui.same_line(self._rows.second_column)
        self._rows.switch("Wires of splits")

    def _draw_anatomy(self) -> None:
        display = self._display
        for index, name in enumerate(STRUCTURES):
            if index:
                imgui.same_line(self._rows.second_column)
            is_on = name in display.overlays
            self._rows.check(name.capitalize(), is_on, partial(display.toggle_overlay, name))
        if display.anatomy.structures:
            now = display.skin_opacity
            label = "Skin opacity"
            name = "skin_opacity"
            display.skin_opacity = self._rows.slider_row(label, name, now, (0.0, 1.0), SKIN_OPACITY)
            self._rows.pick("Dissect", tuple(SIDE_SIGNS))

    def _draw_times(self) -> None:
        """Draw the median times of each phase of the paper's Figure 1, and of whole frames."""
        times = self._times
        steps = [each for each in times.steps if each]
        phases = {readable(name): times.median(name) for name in PHASE_NAMES}
        rest = max(times.frame - sum(phases.values()), 0.0)
        rows = {**phases, "Panels and pauses": rest, "Frame": times.frame}
        for label, milliseconds in rows.items():
            imgui.text(label)
            imgui.same_line(self._rows.second_column)
            imgui.text(f"{milliseconds:.2f}")
            if label == readable("simulation") and steps:
                imgui.same_line()
                muted(self._gui, f"({counted(round(np.median(steps)), 'step')})")
            if label == "Frame" and milliseconds:
                imgui.same_line()
                muted(self._gui, f"({1e3 / milliseconds:.0f} a second)")


def _check_count(name: str, option: refine.Option, count: int, face_count: int) -> None:
    """Raise UserError for a forbidden number, or for more triangles than a window can draw.

    face_count: number of triangles of the simulated mesh.
    """
    try:
        option.check(count)
    except ValueError as error:
        raise UserError(str(error)) from None
    triangle_count = face_count * 4**count
    if name == "levels" and triangle_count > MOST_SHOWN_TRIANGLES:  # those of all edges
        raise UserError(
            f"{count} levels would make {triangle_count} triangles of {face_count}; the window "
            f"draws {MOST_SHOWN_TRIANGLES} at most"
        )


def _set_checked(check: Callable[[], None], put: Callable[[int], None], count: int) -> None:
    check()
    put(count)


def choices_of(option: str) -> tuple[str, ...]:
    """Return the allowed words of a refiner's option, including words of looks and plug-ins."""
    registered = {"scheme": refine.schemes.available, "criterion": refine.criteria.available}
    if option not in registered:
        return ()
    return tuple(dict.fromkeys((*registered[option](), *words_of_presets(option))))


def _keep_in_order(
    stored: dict[str, Any], name: str, value: float, defaults: Mapping[str, Any]
) -> None:
    """Keep the second split's threshold at or above the first's, by moving the unset one."""
    start = name.removesuffix("once").removesuffix("twice")
    first = f"{start}once"
    second = f"{start}twice"
    if name == first and second in defaults:
        stored[second] = max(value, stored.get(second, defaults[second]))
    elif name == second and first in defaults:
        stored[first] = min(value, stored.get(first, defaults[first]))
