"""The dialog of an export, and the note that tells how far one is."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path

from imgui_bundle import imgui

from ..export import Exporter
from ..export_kinds import KINDS, LEAST, MOST, SHEET, SOURCES
from ..files import Files
from ..gui import NOTE_FLAGS, Gui, colour, em
from ..messages import Message
from ..settings import ExportChoices
from ..view import View
from .widgets import button, muted, shortened

TITLE = "Export"
LABELS, WIDTH = 7.5, 30.0  # [em] of the words at the left, and of the dialog
SIZES = ((1280, 720), (1920, 1080), (3840, 2160), (1080, 1080), (1080, 1920))
RATES = (12, 15, 24, 25, 30, 48, 50, 60, 120)
LONGEST_POSE = 600.0  # [s]
SWITCHES = {  # fields of the choices, and what they mean
    "is_transparent": ("Transparent background", "no background, for laying over other pictures"),
    "has_captions": ("Captions", "names and numbers of triangles below the two meshes"),
    "is_turntable": ("Turntable", "the camera goes round once, from where it is"),
}


class ExportDialog:
    """Draws both, and carries out what is done with them."""

    def __init__(self, gui: Gui, exporter: Exporter, files: Files, view: View) -> None:
        self._gui, self._exporter, self._files, self._view = gui, exporter, files, view

    def draw(self) -> Message:
        """Draw what there is to be seen."""
        exporter = self._exporter
        self._draw_progress()
        line = exporter.poll()
        if not exporter.is_asking or self._files.is_waiting:
            return line
        if not imgui.is_popup_open(TITLE):
            imgui.open_popup(TITLE)
        display = imgui.get_io().display_size
        imgui.set_next_window_pos((0.5 * display.x, 0.5 * display.y), 0, (0.5, 0.5))
        imgui.set_next_window_size((min(em(WIDTH), display.x), 0.0))
        if imgui.begin_popup_modal(TITLE, None, imgui.WindowFlags_.no_resize)[0]:
            try:
                self._draw_choices(exporter.choices)
                line = self._draw_end() or line
            finally:
                if not exporter.is_asking:
                    imgui.close_current_popup()
                imgui.end_popup()
        return line

    def _row(self, label: str, width: float = -1.0) -> str:
        """Words at the left, and room for what follows, whose own name is returned."""
        imgui.align_text_to_frame_padding()
        muted(self._gui, label)
        imgui.same_line(em(LABELS))
        imgui.set_next_item_width(width)
        return f"##{label}"

    def _pick(self, label: str, now: str, choices: Mapping[str, object]) -> object:
        """A list to choose from, by what it reads; the value of what was chosen, or None."""
        picked = None
        if imgui.begin_combo(self._row(label), now, imgui.ComboFlags_.height_largest):
            for text, value in choices.items():
                if imgui.selectable(text, text == now)[0]:
                    picked = value
                self._gui.remember(f"export: {text}")
            imgui.end_combo()
        else:
            self._gui.remember(f"export: {label}")
        return picked

    def _draw_choices(self, choices: ExportChoices) -> None:
        exporter = self._exporter
        kind = self._pick("Write", exporter.kind.title, {k.title: n for n, k in KINDS.items()})
        if isinstance(kind, str):
            choices.kind = kind
            exporter.propose()
        drawn, is_sheet = exporter.kind.is_drawn, choices.kind == SHEET
        if not is_sheet:
            source = self._pick("What", SOURCES[choices.source], {t: n for n, t in SOURCES.items()})
            choices.source = source if isinstance(source, str) else choices.source
            self._draw_time(choices)
        if drawn:
            self._draw_size(choices)
        rates = [rate for rate in RATES if rate <= exporter.kind.fastest]
        choices.rate = min(choices.rate, exporter.kind.fastest)
        rate = self._pick("Frames a second", f"{choices.rate:g}", {f"{r}": r for r in rates})
        choices.rate = float(rate) if isinstance(rate, int) else choices.rate
        can = {
            "is_transparent": exporter.kind.can_be_transparent,
            "has_captions": drawn and self._view.display.compare != "off",
            "is_turntable": drawn and not is_sheet,
        }
        for field, (label, meaning) in SWITCHES.items():
            if can[field]:
                self._row("")
                _, now = imgui.checkbox(label, getattr(choices, field))
                setattr(choices, field, now)
                self._gui.remember(f"export: {label}")
                imgui.set_item_tooltip(meaning)
        exporter.name = imgui.input_text(self._row("Name"), exporter.name)[1].replace("/", "")
        self._gui.remember("export: Name")
        room = -em(6.0)
        _, choices.folder = imgui.input_text(self._row("Folder", room), str(exporter.folder))
        self._gui.remember("export: Folder")
        imgui.same_line()
        if button(self._gui, "Browse ...", name="export: Browse", width=-1.0):
            suffix = exporter.kind.suffix
            self._files.ask(
                TITLE, self._take, saving=True, proposed=exporter.target.name,
                kind=exporter.kind.title, suffixes=(suffix,),
            )  # fmt: skip

    def _draw_time(self, choices: ExportChoices) -> None:
        """From when to when, or how long."""
        exporter = self._exporter
        if choices.source == "pose":
            _, seconds = imgui.drag_float(
                self._row("Seconds"), choices.seconds, 0.05, 0.1, LONGEST_POSE, "%.2f s"
            )
            choices.seconds = min(max(seconds, 0.1), LONGEST_POSE)
        if choices.source == "part":
            end, name = exporter.script.duration, self._row("From, to")
            _, span = imgui.drag_float2(name, [*exporter.span], 0.02, 0.0, end, "%.2f s")
            self._gui.remember("export: From, to")
            first = min(max(span[0], 0.0), end - 1e-3)
            exporter.span = first, min(max(span[1], first + 1e-3), end)

    def _draw_size(self, choices: ExportChoices) -> None:
        """Width and height, which may be typed."""
        name = self._row("Size", -imgui.get_frame_height() - imgui.get_style().item_spacing.x)
        _, sides = imgui.input_int2(name, [*choices.size])
        self._gui.remember("export: Size")
        imgui.same_line()
        if imgui.begin_combo("##sizes", "", imgui.ComboFlags_.no_preview):
            for size in (*SIZES, self._view.viewport[2:]):
                if imgui.selectable(f"{size[0]} x {size[1]}", size == choices.size)[0]:
                    sides = [*size]
            imgui.end_combo()
        width, height = (min(max(side, LEAST), MOST) for side in sides)
        choices.size = width, height

    def _draw_end(self) -> Message:
        """What will be written, and the buttons."""
        exporter, choices = self._exporter, self._exporter.choices
        begin, end = exporter.seconds
        text = f"{end - begin:.2f} s, {round((end - begin) * choices.rate) + 1} frames"
        is_there = exporter.target.exists()
        if is_there:
            text = f"{exporter.target.name} is there already"
        imgui.separator()
        imgui.align_text_to_frame_padding()
        ink = self._gui.theme.error if is_there else self._gui.theme.muted
        buttons = em(15.0)
        imgui.text_colored(colour(ink), shortened(text, em(WIDTH) - buttons - em(1.5)))
        imgui.same_line(imgui.get_content_region_avail().x - buttons + em(0.5))
        label = "Replace" if is_there else "Export"
        is_begun = button(self._gui, label, name="export: begin", width=em(7.0))
        is_begun = is_begun or imgui.is_key_pressed(imgui.Key.enter)
        imgui.same_line()
        is_over = button(self._gui, "Cancel", name="export: Cancel", width=em(7.0))
        if is_over or imgui.is_key_pressed(imgui.Key.escape):
            exporter.is_asking = False
        elif is_begun and exporter.name:
            return exporter.start()
        return None

    def _take(self, path: Path) -> Message:
        """The folder and the name that were chosen."""
        exporter = self._exporter
        exporter.choices.folder = str(path.parent)
        exporter.name = path.name.removesuffix(exporter.kind.suffix)
        return None

    def _draw_progress(self) -> None:
        """How far it is, and how long it takes yet."""
        job = self._exporter.job
        if job is None:
            return
        left, top, width, height = self._view.area
        share, passed = job.share, time.monotonic() - job.began
        words = "starting ..." if not share else "finishing ..."
        if 0.0 < share < 1.0:
            words = f"{share:.0%}, {passed / share - passed:.0f} s left"
        imgui.set_next_window_pos((left + width - em(0.8), top + height - em(0.8)), 0, (1.0, 1.0))
        imgui.begin("##export", None, NOTE_FLAGS)
        imgui.text_unformatted(shortened(job.target.name, em(18)))
        imgui.progress_bar(share, (em(12.0), 0.0), words)
        imgui.same_line()
        if button(self._gui, "Cancel", name="export: stop", width=em(6.0)):
            self._exporter.cancel()
        imgui.end()
