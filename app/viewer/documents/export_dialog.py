"""The dialog of an export, and the note that tells how far one is."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TypeVar

from imgui_bundle import imgui

from ..interface.gui import NOTE_FLAGS, Gui, colour, em
from ..interface.widgets import button, choose, muted, shortened
from ..messages import Message
from ..picture.view import View
from ..setting_rules import SIDES_EXPORTED
from ..settings import KINDS, SHEET, SOURCES, ExportChoices
from .export import Exporter, is_there
from .file_dialogs import FileDialogs

TITLE = "Export"
LABELS, WIDTH, BUTTON = 7.5, 31.0, 6.5  # [em] of words at the left, the dialog, a button
PICTURES = {
    **{(640, 480): "VGA", (1280, 720): "HD", (1920, 1080): "Full HD", (3840, 2160): "4K"},
    **{(1080, 1080): "Square", (1080, 1920): "Upright"},
}
RATES = (12, 15, 24, 25, 30, 48, 50, 60, 120)
SWITCHES = {  # fields of the choices
    "is_transparent": "Transparent background",
    "has_captions": "Captions",
    "is_turntable": "Turntable: the camera goes round once",
}
Value = TypeVar("Value")


class ExportDialog:
    """Draws both, and carries out what is done with them."""

    def __init__(self, gui: Gui, exporter: Exporter, files: FileDialogs, view: View) -> None:
        self._gui, self._exporter, self._files, self._view = gui, exporter, files, view
        self._was_focused = False  # in the frame before: no list was open over it

    def draw(self) -> Message:
        """Draw what there is to be seen."""
        exporter, display = self._exporter, imgui.get_io().display_size
        self._draw_progress()
        if not exporter.is_asking or self._files.is_waiting:
            return exporter.poll()
        if not imgui.is_popup_open(TITLE):
            imgui.open_popup(TITLE)
        imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
        imgui.set_next_window_size((min(em(WIDTH), display.x), 0.0))
        if imgui.begin_popup_modal(TITLE, None, imgui.WindowFlags_.no_resize)[0]:
            try:
                self._draw_motion(exporter.choices)
                self._draw_place(exporter.choices)
                self._draw_end(exporter.choices)
            finally:
                if not exporter.is_asking:
                    imgui.close_current_popup()
                imgui.end_popup()
        return None

    def _row(self, label: str, width: float = -1.0) -> str:
        """Words at the left, and room for what follows, whose own name is returned."""
        imgui.align_text_to_frame_padding()
        muted(self._gui, label)
        imgui.same_line(em(LABELS))
        imgui.set_next_item_width(width)
        return f"##{label}"

    def _pick(self, label: str, now: Value, choices: Mapping[Value, str]) -> Value:
        """A list to choose from; what is chosen."""
        self._row(label)
        values = {text: value for value, text in choices.items()}
        chosen = choose(self._gui, label, choices[now], values)
        return now if chosen is None else values[chosen]

    def _draw_motion(self, choices: ExportChoices) -> None:
        """What is exported, from when to when, how large and how often."""
        exporter, before = self._exporter, choices.kind
        choices.kind = self._pick("Write", before, {n: kind.title for n, kind in KINDS.items()})
        if choices.kind != before:
            exporter.propose()
        kind, is_sheet = exporter.kind, choices.kind == SHEET
        if not is_sheet:
            choices.source = self._pick("What", choices.source, SOURCES)
            self._draw_time(choices)
        if kind.is_drawn:
            sizes = {choices.size: "Typed", self._view.viewport[2:]: "As in the window", **PICTURES}
            words = {size: f"{name}: {size[0]} x {size[1]}" for size, name in sizes.items()}
            choices.size = self._pick("Size", choices.size, words)
            _, sides = imgui.input_int2(self._row("", em(11.0)), [*choices.size])
            self._gui.remember("export: sides")
            width, height = (min(max(side, SIDES_EXPORTED[0]), SIDES_EXPORTED[1]) for side in sides)
            choices.size = width, height
        choices.rate = min(choices.rate, kind.fastest)
        rates = [choices.rate, *(float(rate) for rate in RATES if rate <= kind.fastest)]
        shown = {rate: f"{rate:g}" for rate in sorted(rates)}
        choices.rate = self._pick("Frames a second", choices.rate, shown)
        can = (
            kind.can_be_transparent,
            kind.is_drawn and self._view.display.compare != "off",
            kind.is_drawn and not is_sheet,
        )
        for (field, label), is_possible in zip(SWITCHES.items(), can, strict=True):
            if is_possible:
                self._row("")
                setattr(choices, field, imgui.checkbox(label, getattr(choices, field))[1])
                self._gui.remember(f"export: {label}")

    def _draw_time(self, choices: ExportChoices) -> None:
        """How long the face is held, or from when to when the script is played."""
        exporter, always = self._exporter, imgui.SliderFlags_.always_clamp
        if choices.source == "pose":
            name, most = self._row("Length"), 600.0
            now = imgui.drag_float(name, choices.seconds, 0.05, 0.1, most, "%.2f s", always)
            choices.seconds = now[1]
        elif choices.source == "part":
            name, end = self._row("From, to"), exporter.played()[0].duration
            _, span = imgui.drag_float2(name, [*exporter.span], 0.02, 0.0, end, "%.2f s", always)
            self._gui.remember("export: From, to")
            first = min(span[0], end - 0.01)
            exporter.span = first, min(max(span[1], first + 0.01), end)  # imgui's are singles

    def _draw_place(self, choices: ExportChoices) -> None:
        """Name and folder."""
        exporter = self._exporter
        exporter.name = imgui.input_text(self._row("Name"), exporter.name)[1].replace("/", "")
        self._gui.remember("export: Name")
        _, choices.folder = imgui.input_text(self._row("Folder", -em(BUTTON)), choices.folder)
        self._gui.remember("export: Folder")
        imgui.same_line()
        if button(self._gui, "Browse ...", name="export: Browse", width=-1.0):
            ask, kind = partial(self._files.ask, TITLE, self._take, saving=True), exporter.kind
            ask(proposed=exporter.target.name, suffixes=(kind.suffix,))

    def _draw_end(self, choices: ExportChoices) -> None:
        """What will be written, or why not; and the buttons."""
        exporter, (_, (begin, end)) = self._exporter, self._exporter.played()
        text = f"{end - begin:.2f} s, {round((end - begin) * choices.rate) + 1} frames"
        is_replaced, theme = is_there(exporter.target), self._gui.theme
        text = f"{exporter.target.name} is there already" if is_replaced else text
        imgui.separator()
        imgui.align_text_to_frame_padding()
        left = imgui.get_content_region_avail().x - em(2.0 * BUTTON)
        ink = colour(theme.error if is_replaced else theme.muted)
        imgui.text_colored(ink, shortened(text, left - em()))
        imgui.same_line(left)
        label = "Replace" if is_replaced else "Export"
        is_begun = button(self._gui, label, name="export: begin", width=em(BUTTON))
        imgui.same_line()
        is_over = button(self._gui, "Cancel", name="export: Cancel", width=em(BUTTON))
        was_focused, self._was_focused = self._was_focused, imgui.is_window_focused()
        # Enter is for the widget that Tab has come to, unless that is a line of text.
        io, is_enter = imgui.get_io(), imgui.is_key_pressed(imgui.Key.enter)
        is_enter = is_enter and (io.want_text_input or not io.nav_visible)
        if is_over or (was_focused and imgui.is_key_pressed(imgui.Key.escape)):
            exporter.is_asking = False
        elif is_begun or (was_focused and is_enter):
            exporter.start()

    def _take(self, path: Path) -> Message:
        """The folder and the name that were chosen."""
        self._exporter.choices.folder = str(path.parent)
        self._exporter.name = path.name.removesuffix(self._exporter.kind.suffix)
        return None

    def _draw_progress(self) -> None:
        """How far it is, and how long it takes yet."""
        job = self._exporter.job
        if job is None:
            return
        left, top, width, height = self._view.area
        share, (began, first) = job.task.share, job.began
        rest = (1.0 - share) * (time.monotonic() - began) / max(share - first, 1e-9)
        words = f"{rest:.0f} s left" if first < share < 1.0 else "One moment ..."
        imgui.set_next_window_pos((left + width - em(0.8), top + height - em(0.8)), 0, (1.0, 1.0))
        imgui.begin("##export", None, NOTE_FLAGS)
        imgui.text_unformatted(shortened(job.target.name, em(18)))
        imgui.progress_bar(share, (em(12.0), 0.0), f"{share:.0%}, {words}" if share else words)
        imgui.same_line()
        imgui.begin_disabled(job.task.is_stopped)
        if button(self._gui, "Cancel", name="export: stop", width=em(BUTTON)):
            job.task.stop(waits=False)
        imgui.end_disabled()
        imgui.end()
