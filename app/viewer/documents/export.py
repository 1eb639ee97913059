"""Screenshots, and exports of the files that `risorius capture` and `risorius export` write.

An export runs in its own process, so that the window stays responsive. It uses the script and the
view from its start.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar

from imgui_bundle import imgui

from risorius.assets.fitting import FittedHead

from ...capture import CaptureOptions, capture
from ...errors import UserError
from ...export.formats import ExportRequest, check_request, export, format_for
from ...files import check_apart, check_file
from ...pictures import save_png
from ...recordings.names import ARKIT_SHAPES
from ...refining.presets import STATIC_REFINER, Refinement
from ...rig.avatar import RigRequest
from ...rig.writing import make_avatar
from ...text import as_text
from ...workers import BackgroundWork
from ..interface.gui import NOTE_FLAGS, Gui, em, wake_up
from ..interface.widgets import LabelledRows, button, dialog, muted, shortened
from ..messages import Message
from ..picture.stage import SceneView, Stage, style_of
from ..session.session import Session
from ..settings import EXPORT_KINDS, FRAMES_KIND, TONE_ANGLES, ExportChoices, ExportKind, Settings
from .file_dialogs import FileDialogs


@dataclass
class ExportJob:
    """A running export."""

    target: Path
    task: BackgroundWork
    shown_fraction: float = 0.0  # share of the finished work that the window displayed last


class Exporter:
    """Writes screenshots of a stage, and exports of a session, one at a time."""

    def __init__(self, session: Session, settings: Settings, stage: Stage, view: SceneView) -> None:
        self.session = session
        self._settings = settings
        self._stage = stage
        self._view = view
        self.job: ExportJob | None = None
        self.is_asking = False  # the dialog is open

    @property
    def choices(self) -> ExportChoices:
        """The chosen kind, size and rate."""
        return self._settings.export

    @property
    def kind(self) -> ExportKind:
        """The chosen kind of file."""
        return EXPORT_KINDS[self.choices.kind]

    def screenshot(self) -> Message:
        """Write the picture without panels, in full detail."""
        stem = Path.cwd() / time.strftime("risorius-%Y%m%d-%H%M%S")
        target = Path(f"{stem}.png")
        number = 1
        while target.exists():
            number += 1
            target = Path(f"{stem}-{number}.png")
        save_png(target, self._stage.draw_image(self._view))
        return f"Written to {target}"

    def open_dialog(self) -> Message:
        """Open the dialog, with the last choices."""
        self.is_asking = True
        if not self.session.differing:
            return None
        return "The script is exported; [Set key] puts the face as it is into it"

    @property
    def head(self) -> FittedHead | None:
        """The user's head, or the head of a person, in the session; else None."""
        face = self.session.scene.face
        return face.head if face is not None and isinstance(face.head, FittedHead) else None

    def ask_avatar(self, files: FileDialogs) -> None:
        """Ask for a file, and begin to make an avatar."""
        head = self.head
        name = "head"
        if head is not None:
            name = head.files[0].stem if head.files else head.called or name
        ask = partial(files.open, "Export avatar", self.start_avatar, saving=True)
        ask(suffixes=(".glb",), proposed=f"{as_text(name)}-avatar.glb")

    def start_avatar(self, target: Path) -> Message:
        """Begin to write an avatar: the head with named shapes, and with parts that its file lacks.

        UserError if the file cannot be written.
        """
        head = self.head
        if target.suffix.lower() != ".glb":
            raise UserError(f"{target.name}: avatars are written as .glb; choose such a name")
        check_apart((target,), head.files if head is not None else ())
        check_file(target)
        request = RigRequest(adds_parts=True, progress=False)
        work = partial(make_avatar, head, target, request, _discard_line)
        written = 8  # comparing and writing take as long as this number of shapes
        self.job = ExportJob(target, BackgroundWork(work, len(ARKIT_SHAPES) + written, wake_up))
        return None

    def _options(self, head: FittedHead | None) -> CaptureOptions:
        """Return options of `capture` for the window's picture; draw a comparison side by side."""
        choices = self.choices
        view = self._view
        display = self._view.display
        is_clear = choices.is_transparent and self.kind.can_be_transparent
        is_compared = display.compare != "off"
        static = Refinement(refiner=STATIC_REFINER)
        is_refined = display.is_refined or is_compared
        return CaptureOptions(
            choices.size,
            choices.rate,
            display.refinement_on(self.session.scene) if is_refined else static,
            (display.refinement_beside,) if is_compared else (),
            camera=view.camera.copy(),
            style=style_of(display, None if is_clear else view.background),
            tone=TONE_ANGLES[display.tone],
            anatomy=display.anatomy,
            head=head,
            is_alive=self._settings.is_alive,
        )

    def start(self, target: Path) -> Message:
        """Check the target, and begin to write a file, or a folder of frames.

        UserError if the target cannot be written.
        """
        choices = self.choices
        script = self.session.script
        head = self.head
        work: Callable[[], object]
        if self.kind.is_drawn:
            check_file(target / "frame.png" if choices.kind == FRAMES_KIND else target)
            draw = partial(capture, script, self._options(head), overwrite=True)
            work = partial(draw, progress=False, output=target)
        else:
            chosen = format_for(target, choices.kind)
            request = ExportRequest(overwrite=target.exists(), progress=False)
            check_request(target, chosen, request)
            write = partial(export, head=head, frames_per_second=choices.rate)
            work = partial(write, script, target, chosen, request)
        task = BackgroundWork(work, round(script.duration * choices.rate) + 1, wake_up)
        self.job = ExportJob(target, task)
        return None

    @property
    def has_news(self) -> bool:
        """Whether the export has advanced since the last call."""
        job = self.job
        if job is None or (job.shown_fraction == job.task.share and not job.task.is_done):
            return False
        job.shown_fraction = job.task.share
        return True

    def poll(self) -> Message:
        """Return a message if the export is done; raises UserError if it failed."""
        job = self.job
        if job is None or not job.task.is_done:
            return None
        self.job = None
        is_cancelled = job.task.is_stopped
        job.task.stop(waits=False)
        if is_cancelled:
            return f"Cancelled: {job.target.name}"
        job.task.check()
        return f"Written to {job.target}"

    def close(self) -> None:
        """End the export at once; a half-written file is removed."""
        job, self.job = self.job, None
        if job is not None:
            job.task.stop(waits=True)


def _discard_line(_: str) -> None:
    """Discard lines about the head that the command line would print."""


Value = TypeVar("Value")


class ExportDialog:
    """Draws the dialog and the progress of an export, and carries out the user's actions."""

    TITLE = "Export"
    DIALOG_WIDTH = 31.0  # [em]
    BUTTON_WIDTH = 6.5  # [em]

    def __init__(self, gui: Gui, exporter: Exporter, files: FileDialogs, view: SceneView) -> None:
        self._gui = gui
        self._exporter = exporter
        self._files = files
        self._view = view
        label_width = 7.5  # [em], the column of labels
        self._rows = LabelledRows(gui, label_width / self.DIALOG_WIDTH, {})
        self._was_focused = False  # whether the dialog had the focus in the last frame

    def draw(self) -> Message:
        """Draw the dialog, or the progress of an export."""
        exporter = self._exporter
        self._draw_progress()
        if not exporter.is_asking or self._files.is_waiting:
            return None
        with dialog(self.TITLE, self.DIALOG_WIDTH) as is_open:
            if is_open:
                try:
                    self._draw_motion(exporter.choices)
                    self._draw_end(exporter.choices)
                finally:
                    if not exporter.is_asking:
                        imgui.close_current_popup()
        return None

    def _pick(self, label: str, now: Value, choices: Mapping[Value, str]) -> Value:
        """Draw a list to choose from; returns the choice."""
        values = {text: value for value, text in choices.items()}
        chosen = self._rows.choose(label, choices[now], values)
        return now if chosen is None else values[chosen]

    def _draw_motion(self, choices: ExportChoices) -> None:
        """Draw the choices of an export: kind, size and rate."""
        titles = {name: kind.title for name, kind in EXPORT_KINDS.items()}
        choices.kind = self._pick("Write", choices.kind, titles)
        kind = self._exporter.kind
        if kind.is_drawn:
            here = self._view.viewport[2:]
            picture_sizes = {
                (640, 480): "VGA",
                (1280, 720): "HD",
                (1920, 1080): "Full HD",
                (3840, 2160): "4K",
                (1080, 1080): "Square",
                (1080, 1920): "Upright",
            }
            sizes = {choices.size: "As last", here: "As in the window", **picture_sizes}
            words = {size: f"{name}: {size[0]} x {size[1]}" for size, name in sizes.items()}
            choices.size = self._pick("Size", choices.size, words)
        choices.rate = min(choices.rate, kind.fastest)
        frame_rates = (12, 15, 24, 25, 30, 48, 50, 60, 120)
        rates = [choices.rate, *(float(rate) for rate in frame_rates if rate <= kind.fastest)]
        shown = {rate: f"{rate:g}" for rate in sorted(rates)}
        choices.rate = self._pick("Frames a second", choices.rate, shown)
        if kind.can_be_transparent:
            self._rows.begin("")
            label = "Transparent background"
            _, choices.is_transparent = imgui.checkbox(label, choices.is_transparent)
            self._gui.remember(f"export: {label}")

    def _draw_end(self, choices: ExportChoices) -> None:
        """Draw the length of the output, and the buttons; the export button asks for a name."""
        exporter = self._exporter
        duration = self._exporter.session.script.duration
        imgui.separator()
        imgui.align_text_to_frame_padding()
        left = imgui.get_content_region_avail().x - em(2.0 * self.BUTTON_WIDTH)
        muted(self._gui, f"{duration:.2f} s, {round(duration * choices.rate) + 1} frames")
        imgui.same_line(left)
        is_begun = button(
            self._gui, "Export ...", name="export: begin", width=em(self.BUTTON_WIDTH)
        )
        imgui.same_line()
        is_over = button(self._gui, "Cancel", name="export: Cancel", width=em(self.BUTTON_WIDTH))
        was_focused, self._was_focused = self._was_focused, imgui.is_window_focused()
        # After Tab, Enter presses the focused widget; otherwise it begins the export.
        io = imgui.get_io()
        is_enter = imgui.is_key_pressed(imgui.Key.enter)
        is_enter = is_enter and (io.want_text_input or not io.nav_visible)
        if is_over or (was_focused and imgui.is_key_pressed(imgui.Key.escape)):
            exporter.is_asking = False
        elif is_begun or (was_focused and is_enter):
            exporter.is_asking = False
            suffix = exporter.kind.suffix
            ask = partial(
                self._files.open, self.TITLE, exporter.start, saving=True, suffixes=(suffix,)
            )
            ask(proposed=f"{Path(exporter.session.work.name).stem}{suffix}")

    def _draw_progress(self) -> None:
        """Draw the progress of an export."""
        job = self._exporter.job
        if job is None:
            return
        left, top, width, height = self._view.area
        share = job.task.share
        imgui.set_next_window_pos((left + width - em(0.8), top + height - em(0.8)), 0, (1.0, 1.0))
        imgui.begin("##export", None, NOTE_FLAGS)
        imgui.text_unformatted(shortened(job.target.name, em(18)))
        imgui.progress_bar(share, (em(12.0), 0.0), f"{share:.0%}" if share else "One moment ...")
        imgui.same_line()
        imgui.begin_disabled(job.task.is_stopped)
        if button(self._gui, "Cancel", name="export: stop", width=em(self.BUTTON_WIDTH)):
            job.task.stop(waits=False)
        imgui.end_disabled()
        imgui.end()
