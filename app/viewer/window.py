"""The window: the one place where all parts of the viewer meet, and one turn of its loop.

Physics goes in steps of its own, apart from frames (physics.py). The scene is drawn only when
something in it has changed, with less detail while it moves if the machine is slow (painter.py);
panels are drawn around it less often then (panel_cache.py). A window in which nothing happens waits
for events.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from imgui_bundle import imgui

from risorius import render
from risorius.assets.fitting import FittedHead

from ..errors import UserError
from ..scenes import Scene, build_scene
from ..script import Script
from ..stopping import cleaned_up_if_stopped
from . import menus
from .command import Command, run_pressed
from .export import FRAMES_PER_SECOND, Exporter
from .file_drop import FileDrop
from .files import Files
from .frame_times import FrameTimes
from .gui import Gui, on_drop, poll_events, wait_for_event
from .idle_life import IdleLife
from .key_selection import KeySelection
from .messages import Messages
from .mouse import Mouse
from .painter import Painter
from .panel_cache import PanelCache
from .panel_state import PanelState
from .panels.chooser import FileChooser
from .panels.dope_sheet import DopeSheet
from .panels.face import FacePanel
from .panels.help import draw_help
from .panels.layout import Layout
from .panels.mechanism import MechanismPanel
from .panels.menu_bar import MenuBar
from .panels.message_line import draw_message
from .panels.question_box import draw_question
from .panels.recovery_banner import draw_recovery
from .panels.timeline import Timeline
from .panels.waveform import Waveform
from .physics import Physics
from .placement import Placement, first_size
from .question import Question
from .recovery import Recovery
from .script_commands import ScriptCommands
from .session import Session
from .settings import (
    Display,
    Settings,
    load_settings,
    remove_refused_options,
    rename_unusable,
    save_settings,
)
from .soundtrack import Soundtrack
from .stage import Stage
from .time_axis import TimeAxis
from .view import View

IDLE_WAIT = 2.0  # [s] between two frames while nothing happens
WATCHFUL_WAIT = 0.1  # [s] the same while a file dialog is open, or words are typed
LIFE_WAIT = 1.0 / 30.0  # [s] from one frame to the next while the face does no more than live
FRAMES_AFTER_EVENT = 3  # the GUI answers an event within so many frames


class Viewer:
    """The window with everything in it; a context manager."""

    def __init__(
        self,
        script: Script,
        size: tuple[int, int] | None = None,
        display: Display | None = None,
        *,
        head: FittedHead | None = None,
        settings_path: Path | None = None,
    ) -> None:
        """Open the window.

        head: a user's own, None for the built-in one. size, display: None takes what is remembered.
        settings_path: where that is kept, and beside it what is not saved; None for nowhere.
        Raises UserError for a script that names what the scene has not.
        """
        self._settings_path = settings_path
        self.settings, complaint = Settings(), ""
        if settings_path is not None:
            self.settings, complaint = load_settings(settings_path)
        scene = build_scene(script.scene, head)
        self.session = Session(scene, script)
        self.recovery = Recovery(settings_path and settings_path.parent / "unsaved")
        self.recovery.find(self.session)
        self.soundtrack = Soundtrack(self.session)
        if display is None:
            refused = remove_refused_options(self.settings.display, scene)
            if refused and settings_path is not None and not complaint:
                refused = f"{settings_path}: {refused}; {rename_unusable(settings_path)}"
            complaint = "; ".join(filter(None, (complaint, refused)))
        else:
            self.settings.display = display
        self.settings.display.remove_missing_overlays(scene)
        self.times = FrameTimes()
        with contextlib.ExitStack() as stack:  # whatever fails here closes the window again
            title = f"Risorius: {self.session.name}"
            self.surface = render.open_window(size or first_size(self.settings.size), title)
            stack.callback(self.surface.close)
            self.gui = Gui(self.surface.handle)
            stack.callback(self.gui.close)
            self.stage = Stage(self.surface, scene, self.settings.display, self.times)
            self._resources = stack.pop_all()
        self._join_commands()
        self._join_panels()
        self._last = time.perf_counter()
        self._awake = FRAMES_AFTER_EVENT
        self.is_leaving = False
        on_drop(self.surface.handle, self.drop)
        if complaint:
            self.messages.say(complaint, error=True)
        for _ in range(2):  # panels and tabs find their places before the first picture
            self._draw_gui(is_visible=False)

    def _join_commands(self) -> None:
        """What can be done, each with what it needs for that."""
        session, settings = self.session, self.settings
        self.view = View(session, settings, self.surface)
        self.placement = Placement(self.surface.handle)
        self.messages, self.files, self.question = Messages(), Files(), Question(session)
        self.panel_state, self.time_axis = PanelState(wanted_tab=settings.tab), TimeAxis()
        self.selection = KeySelection(session, self.panel_state)
        self.scripts = ScriptCommands(session, self.files, self.question)
        self.exporter = Exporter(self.stage, self.view)
        self.file_drop = FileDrop(self.files, self.scripts, self.show_scene)
        self.commands: tuple[Command, ...] = (
            *menus.file_menu(self.scripts, self.file_drop, self.exporter, self.ask_to_close),
            *menus.edit_menu(session),
            *menus.time_menu(session, self.scripts, self.time_axis),
            *menus.keys_menu(self.selection),
            *menus.view_menu(settings, self.view, self.placement, self.panel_state),
            *menus.expression_menu(session),
            *menus.help_menu(self.panel_state),
        )
        self.life = IdleLife(session, settings, self.view)
        self.physics = Physics(session, self.times)
        self.painter = Painter(self.stage, self.view, self.exporter, self.messages)
        self.panel_cache = PanelCache()

    def _join_panels(self) -> None:
        """What is around the picture, and the mouse in it."""
        gui, session, settings, messages = self.gui, self.session, self.settings, self.messages
        view, commands, axis = self.view, self.commands, self.time_axis
        bar = MenuBar(gui, session, messages, commands)
        waveform = Waveform(gui, self.soundtrack, axis)
        dope_sheet = DopeSheet(
            gui, session, settings, messages, self.selection, axis, bar, waveform
        )
        self.timeline = Timeline(gui, session, messages, commands, self.exporter, dope_sheet)
        self.face_panel = FacePanel(gui, session, settings, view)
        mechanism = MechanismPanel(gui, settings, self.stage, view, self.times)
        tabs = {"Face": self.face_panel.draw, "Mechanism": mechanism.draw}
        self._layout = Layout(gui, settings, self.panel_state, bar, tabs, self.timeline)
        self._chooser = FileChooser(gui, self.files)
        self.mouse = Mouse(self.view, self.stage, self.select_muscle)

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(UserError):  # a disk that is full must not keep the window open
            self._remember()
        self.exporter.close()
        self.soundtrack.close()
        self.recovery.close()
        self._resources.close()

    def _remember(self) -> None:
        """Write the settings as they are now; UserError where that cannot be."""
        if self._settings_path is not None:
            self.settings.cameras[self.session.scene.name] = self.view.camera_place
            self.settings.size = self.placement.size
            save_settings(self._settings_path, self.settings)

    def run(self, *, playing: bool = False, once: bool = False) -> None:
        """Show the window until it is closed (with `once`: until the script has ended)."""
        if playing:
            self.session.toggle_playing()
        self._last = time.perf_counter()
        with self.recovery.guarding(self.session), cleaned_up_if_stopped(self._remember):
            while True:
                if self.placement.is_minimised:  # time stands still, and nothing is drawn
                    self._wait()
                else:
                    self.frame()
                self.messages.attempt(partial(self.recovery.watch, self.session))
                if self.surface.should_close:
                    self.surface.should_close = False
                    self.ask_to_close()
                    if self.surface.should_close:
                        break
                    self.placement.restore()  # to be asked
                is_over = playing and not self.session.is_playing
                if once and is_over and not self.session.unsaved:
                    break
                self._rest()

    def wait_for_frame(self) -> None:
        """Wait until something happens, or it is time to look around; then show a frame."""
        self._rest()
        self.frame()

    # One turn of the loop

    def frame(self) -> None:
        """Input, time, picture, panels."""
        poll_events()
        if self.gui.has_events:
            self._awake = FRAMES_AFTER_EVENT
            self.life.note_input()
        now = time.perf_counter()
        elapsed, self._last = now - self._last, now
        self.times.note_frame(elapsed)
        mark = " *" if self.session.unsaved else ""
        self.placement.set_title(f"Risorius: {self.session.name}{mark}")
        is_filming = self.exporter.film is not None
        seconds = 1.0 / FRAMES_PER_SECOND if is_filming else elapsed
        self.messages.attempt(self.soundtrack.refresh)
        seconds = self.soundtrack.elapsed(seconds, is_silent=is_filming)
        is_skin_dragged = self.mouse.is_dragging_skin
        is_held = is_skin_dragged or imgui.is_any_item_active()
        life = partial(self.life.after, is_held=is_held) if self.life.is_on else None
        self.messages.attempt(
            lambda: self.physics.advance(seconds, is_skin_dragged=is_skin_dragged, life=life)
        )
        is_moving = self.painter.paint(
            elapsed, has_moved=self.physics.has_moved, is_alive=self.physics.is_left_alone
        )
        if self.is_left_alone and not (is_moving or imgui.get_io().want_text_input):
            return  # what is shown stays as it is; of a line of text the cursor blinks
        self._show_panels(elapsed, is_moving=is_moving)
        self.surface.end()
        if self.file_drop.has_announced:
            self.messages.text = ""
            self.messages.attempt(self.file_drop.open_announced)
            self._last = time.perf_counter()
        if is_moving and not self.is_left_alone:
            self.painter.level_of_detail.note(time.perf_counter() - now)
        if self.exporter.film is not None:  # on a fast machine a film is made in real time
            time.sleep(max(1.0 / FRAMES_PER_SECOND - (time.perf_counter() - now), 0.0))
        self._awake = max(self._awake - 1, 0)

    @property
    def is_idle(self) -> bool:
        """Whether nothing moves, and nothing is about to."""
        return (
            self.physics.is_at_rest
            and not self.life.is_on
            and self._awake == 0
            and self.painter.is_complete
            and not self.session.is_recording
            and not self.messages.is_fading
            and not self.soundtrack.is_heard
            and self.exporter.film is None
        )

    @property
    def is_left_alone(self) -> bool:
        """Whether the face does no more than live, and nothing else happens."""
        return (
            self.physics.is_left_alone
            and self._awake == 0
            and not self.messages.is_fading
            and not self.files.is_waiting
            and self.exporter.film is None
        )

    def _rest(self) -> None:
        """Sleep where nothing happens, and between frames where the face only lives.

        The latter half of the time at least, however long a frame takes.
        """
        if self.is_idle:
            self._wait()
        elif self.is_left_alone:
            spent = time.perf_counter() - self._last
            wait_for_event(max(LIFE_WAIT - spent, spent))

    def _wait(self) -> None:
        """Sleep until an event comes, or for a while; the clock does not run on meanwhile."""
        is_watching = self.files.is_waiting or imgui.get_io().want_text_input  # a cursor blinks
        patience = WATCHFUL_WAIT if is_watching else IDLE_WAIT
        patience = min(patience, max(self.recovery.due_in(), 0.0))
        self.soundtrack.rest()
        begin = time.perf_counter()
        wait_for_event(patience)
        self._last = time.perf_counter()
        if self._last - begin < patience:
            self._awake = FRAMES_AFTER_EVENT

    def _show_panels(self, elapsed: float, *, is_moving: bool) -> None:
        """Answer the user, and draw the panels around the scene where their image is not stored."""
        size, is_answering = self.surface.size, self._awake > 0 or imgui.is_any_item_active()
        if not self.is_left_alone:  # what the face does by itself moves no slider
            self.panel_cache.age(elapsed)
        # What is dragged in the scene moves no slider.
        has_input = is_answering and not self.mouse.is_dragging
        is_visible = self.panel_cache.are_due(size, is_moving=is_moving, has_input=has_input)
        if not (is_visible or is_answering):
            return
        if is_visible:
            self.surface.resolve()
            left, bottom, width, _ = self.view.viewport
            if not self.panel_state.are_hidden:
                self.surface.fill((0, 0, left, size[1]), self.gui.theme.panel)
                self.surface.fill((left, 0, width, bottom), self.gui.theme.panel)
        self._draw_gui(is_visible=is_visible)
        if is_visible:
            self.panel_cache.note_drawn(size, is_over_scene=self.gui.covers(self.view.area))

    def _draw_gui(self, *, is_visible: bool) -> None:
        """Panels, and what the user does to them and to the face; is_visible: see Gui.frame."""
        messages, gui, state = self.messages, self.gui, self.panel_state
        with gui.frame(is_visible=is_visible):
            gui.set_theme(self.settings.theme, self.settings.zoom)
            self._layout.draw(self.view)
            messages.age(imgui.get_io().delta_time)
            draw_message(gui, messages, self.view)
            for draw in (
                partial(draw_recovery, gui, self.recovery, self.session, self.question, self.view),
                self.files.poll,
                self._chooser.draw,
                partial(draw_question, gui, self.question, self.session, self.scripts),
            ):
                messages.attempt(draw)
            if state.is_help_open:
                state.is_help_open = draw_help(gui, self.commands)
            if not (self.files.is_waiting or self.question.is_open):
                run_pressed(self.commands, messages)
                self.mouse.follow()

    # What is done to the window as a whole

    def drop(self, paths: Sequence[str]) -> None:
        """Open files that were dropped onto the window."""
        self._awake = FRAMES_AFTER_EVENT
        self.messages.attempt(partial(self.file_drop.open, paths))

    def show_scene(self, scene: Scene) -> None:
        """Take another scene with the same controls in place of this one."""
        self.session.move_to(scene)
        display = self.settings.display
        display.remove_missing_overlays(scene)
        refused = remove_refused_options(display, scene)
        self.stage.set_scene(scene, display)
        self.view.fit_scene()
        self.mouse.forget()
        self.physics.begin_anew()
        self.painter.forget()
        if refused:
            self.messages.say(refused)

    def select_muscle(self, name: str) -> None:
        """Show a muscle's slider."""
        self.panel_state.wanted_tab = "Face"
        self.face_panel.select(name)
        self.messages.say(name.replace("_", " "))

    def ask_to_close(self) -> str | None:
        """Close the window, unless work would be lost: then ask first."""
        if self.is_leaving:
            return self._close()
        return self.question.before("Close", self._close)

    def _close(self) -> str | None:
        self.is_leaving = self.surface.should_close = True
        return None
