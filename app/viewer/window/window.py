"""The window: joins the two modes, runs the loop, and closes.

Physics has its own steps, independent of frames (physics.py). The scene is drawn only when it has
changed; on a slow machine, a moving scene has less detail (stage.py), and its panels are drawn less
often. An idle window waits (schedule.py).
"""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from imgui_bundle import imgui

from risorius.assets.fitting import FittedHead

from ...errors import UserError
from ...scenes import Scene
from ...script import Script
from ...stopping import cleaned_up_if_stopped
from ..documents.export import ExportDialog
from ..documents.file_drop import FileDrop
from ..documents.scripts import draw_question
from ..interface.commands import run_pressed
from ..interface.gui import on_drop
from ..marking import Marking, MarkingMode
from ..messages import Message, Task
from ..panels.layout import draw_message
from ..session.recovery import Recovery
from ..settings import Display, save_settings
from .face_mode import FaceMode
from .mode import Mode
from .opening import open_window, without_refused_options
from .schedule import Schedule
from .splash_screen import SplashScreen


class Viewer:
    """The running window with everything in it; a context manager.

    face: the mode of the moving face. marking_mode: the mode of marking, None while the face is
    shown.
    """

    refresh = 0.1  # [s]: largest age of the panels' picture while the face moves

    def __init__(
        self,
        script: Script,
        size: tuple[int, int] | None = None,
        display: Display | None = None,
        *,
        head: FittedHead | None = None,
        settings_path: Path | None = None,
        splash: SplashScreen | None = None,
    ) -> None:
        """Open the window; nothing moves yet.

        head: the user's head, None for the built-in head. size, display: None for the remembered
            values.
        splash: the window, if it is already open.
        settings_path: file of the settings, with unsaved work beside it; None for no files.
        Raises UserError for a script with controls that the scene lacks.
        """
        splash = splash or SplashScreen(size, settings_path)
        context, resources, complaint = open_window(splash, script, head, display)
        self._resources = resources
        self._settings_path = settings_path
        self.context = context
        self.session = context.session
        self.settings = context.settings
        self.surface = context.surface
        self.gui = context.gui
        self.messages = context.messages
        self.files = context.files
        self.exporter = context.exporter
        self.recovery = Recovery(settings_path and settings_path.parent, self.session)
        self.file_drop = FileDrop(
            self.files, context.scripts, self.settings, self.show_scene, self.read
        )
        self.face = FaceMode(context, self.file_drop, self.ask_to_close)
        self.marking_mode: MarkingMode | None = None
        self.gui.keys = {each.label: each.displayed_keys for each in self.face.commands}
        self.export_dialog = ExportDialog(self.gui, self.exporter, self.files, context.view)
        self.schedule = Schedule(context, self.file_drop, lambda: self.mode, self.recovery.due_in)
        self.is_leaving = False
        # Age of the last picture of the panels [s], and the window's size then [pixels].
        self._panels_age = math.inf
        self._panels_size = (0, 0)
        self._is_scene_covered = True  # whether panels lie over the scene
        self._greet(complaint, script)

    def _greet(self, complaint: str, script: Script) -> None:
        """Show the first message, and remember the open files."""
        settings = self.settings
        if script.is_converted or self.session.file.path is not None:
            settings.note_recent(Path(script.source))
        if (kept := self.recovery.found) is not None:
            settings.note_recent(kept)
            complaint = complaint or f"unsaved work is in File > Recent: {kept.name}"
        if complaint:
            self.messages.show(complaint, error=True)
        elif self._settings_path is not None and not self._settings_path.exists():
            self.messages.show(
                "Drag the skin, or open one of File > Examples; menus show every key"
            )

    def __enter__(self) -> Viewer:
        self.schedule.restart()
        on_drop(self.surface.handle, self.drop)
        for _ in range(2):  # panels and tabs get their places before the first picture
            self._draw_gui(is_visible=False)
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def run(self, *, playing: bool = False, once: bool = False) -> None:
        """Show the window until it is closed (with `once`: until the script has ended)."""
        if playing:
            self.session.toggle_playing()
        self.schedule.restart()
        stopping = cleaned_up_if_stopped(self.exporter.close)  # runs after the work is safe
        with stopping, self.recovery.guarding(), cleaned_up_if_stopped(self.remember):
            while True:
                if self.gui.is_minimised:  # time stops, and nothing is drawn
                    self.schedule.sleep()
                else:
                    self.frame()
                self.messages.attempt(self.recovery.watch)
                if self.surface.should_close:
                    self.surface.should_close = False
                    self.ask_to_close()
                    if self.surface.should_close:
                        break
                    self.gui.restore()  # so that the user sees the question
                is_over = playing and not self.session.is_playing
                if once and is_over and not self.session.work.unsaved:
                    break
                self.schedule.pause()

    # One turn of the loop

    @property
    def mode(self) -> Mode:
        """The mode that the window shows."""
        return self.marking_mode or self.face

    def frame(self) -> None:
        """Run one turn of the loop: input, time, picture, panels."""
        schedule = self.schedule
        if self.gui.read_events():
            schedule.wake()
            self.face.life.note_input()
        for _ in self.gui.turns():
            self._draw_gui(is_visible=False)
        if self.surface.frame_size != self._panels_size:  # no event reports this
            schedule.wake()
            self._draw_gui(is_visible=False)  # so that the picture knows its place
        self._take_results()
        elapsed = schedule.begin_frame()
        mode = self.mode
        self.gui.set_title(f"Risorius: {mode.name}{' *' if mode.unsaved else ''}")
        is_moving = mode.paint(elapsed)
        if mode.has_news:
            schedule.wake()
        if schedule.is_idling and not (is_moving or imgui.get_io().want_text_input):
            return  # the picture stays; the cursor blinks in a line of text
        self._show_panels(elapsed, is_moving=is_moving)
        self.surface.end()
        if is_moving:
            self.mode.painter.level_of_detail.note(schedule.spent)
        schedule.end_frame()

    def _take_results(self) -> None:
        """Take the results of threads and processes: an export, a new head, portraits."""
        portraits = self.context.portraits
        if portraits.has_news:
            portraits.take_in()
            self.schedule.wake(1)
        if self.exporter.has_news:
            self.schedule.wake(1)
        self.messages.attempt(self.exporter.poll, stays=True)
        if self.file_drop.has_news:
            self.schedule.wake(2)  # the message's box grows a frame late
            self.messages.text = ""
            self.messages.attempt(self.file_drop.poll, stays=True)

    def _show_panels(self, elapsed: float, *, is_moving: bool) -> None:
        """Draw the panels around the scene, unless their last picture suffices.

        On software OpenGL, panels take a quarter of the time that the face takes, and only their
        sliders move while a script plays. Every action of the user has a response in the same
        frame.
        """
        mode = self.mode
        size = self.surface.size
        is_answering = self.schedule.is_awake or imgui.is_any_item_active()
        if not self.schedule.is_idling:  # idle life moves no slider
            self._panels_age += elapsed
        has_input = mode.draws_over_picture or (is_answering and not mode.mouse.is_dragging)
        fluent = 1.0 / 30.0  # [s] for a frame; slower ones draw the panels in every third frame
        most_delay = 2.5  # a playhead that is refreshed less often would seem to jump
        age = self.refresh * min(max(elapsed / fluent, 1.0), most_delay)
        is_stale = self._panels_age >= age or size != self._panels_size
        if is_moving and not (has_input or is_stale or self._is_scene_covered):
            return
        self.surface.resolve()
        left, bottom, width, _ = mode.view.viewport
        self.surface.fill((0, 0, left, size[1]), self.gui.theme.panel)
        self.surface.fill((left, 0, width, bottom), self.gui.theme.panel)
        self._draw_gui(is_visible=True)
        self._panels_age = 0.0
        self._panels_size = size
        self._is_scene_covered = self.gui.covers(mode.view.area)

    def _draw_gui(self, *, is_visible: bool) -> None:
        """Draw panels, and respond to the user in panels and face; is_visible: see Gui.frame."""
        messages = self.messages
        gui = self.gui
        files = self.files
        question = self.context.question
        mode = self.mode
        with gui.frame(is_visible=is_visible):
            gui.set_theme(self.settings.theme, self.settings.zoom)
            mode.draw_panels()
            messages.age(imgui.get_io().delta_time)
            draw_message(gui, messages, mode.view)
            self.context.manual.draw(mode.view.area)
            if imgui.is_any_mouse_down():
                mode.view.pointed = {}
            if not question.is_open:  # dialogs wait until it is answered
                messages.attempt(partial(files.draw, gui))
                messages.attempt(self.export_dialog.draw)
            scripts = self.context.scripts
            messages.attempt(partial(draw_question, gui, question, self.session, scripts))
            if not (files.is_waiting or question.is_open or self.exporter.is_asking):
                run_pressed(mode.commands, messages, gui)
                mode.mouse.follow()

    def drop(self, paths: Sequence[str]) -> None:
        """Open files that were dropped onto the window."""
        self.schedule.wake()
        self.messages.carry_out(partial(self.mode.drop, paths))

    # Changes of the window as a whole

    def show_scene(self, scene: Scene) -> None:
        """Replace the scene by another scene with the same controls."""
        if self.marking_mode is not None and self.marking_mode.unsaved:
            raise UserError("landmarks were moved meanwhile; press [Use this head] again")
        self.session.move_to(scene)
        self.leave_marking()
        display = self.settings.display
        display.remove_missing_overlays(scene)
        refused = without_refused_options(display, scene)
        self.context.stage.set_scene(scene, display)
        self.face.begin_anew()
        if refused:
            self.messages.show(refused)

    def read(self, mesh: Path, landmarks: Path | None = None) -> Task:
        """Read a mesh, in any thread; return a task that opens the marking of its landmarks.

        The marking begins with the landmarks of a file, if there is one. The face waits meanwhile.
        Raises UserError for an unusable mesh or file.
        """
        marking = Marking(mesh, self.files)
        line = None if landmarks is None else marking.open(landmarks)

        def mark() -> Message:
            """Open the marking; runs in the window's thread."""
            self.face.set_aside()
            self.marking_mode = MarkingMode(
                marking, self.context, self.face.commands, self.file_drop.open, self.leave_marking
            )
            return line

        return mark

    def leave_marking(self) -> None:
        """Return to the face."""
        if self.marking_mode is not None:
            self.marking_mode = None
            self.face.resume()

    def ask_to_close(self) -> str | None:
        """Close the window; if work would be lost, ask first."""
        job = self.exporter.job
        if job is not None and not job.task.is_stopped:
            name = job.target.name
            self.messages.show(f"{name} is being written; wait, or cancel it first", error=True)
            return None
        if self.is_leaving:
            return self._close()
        ask = partial(self.context.question.before, "Close", self._close)
        return self.mode.leave(ask)

    def _close(self) -> str | None:
        self.is_leaving = True
        self.surface.should_close = True
        return None

    def remember(self) -> None:
        """Write the current settings; raises UserError if this fails."""
        if self._settings_path is not None:
            self.settings.size = self.gui.window_size
            save_settings(self._settings_path, self.settings)

    def close(self) -> None:
        """Save the settings, and release everything."""
        try:
            self.remember()
        except UserError as error:  # a full disk must not keep the window open
            log = logging.getLogger("risorius.viewer")  # reports after the window has closed
            log.warning("risorius: %s; the next window opens without these settings", error)
        self.context.live.stop()
        self.exporter.close()
        self.leave_marking()
        self.face.soundtrack.close()
        self.recovery.close()
        self._resources.close()
