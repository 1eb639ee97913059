"""The window as it runs: one turn of its loop, and when that rests. Its parts: application.py.

Physics goes in steps of its own, apart from frames (physics.py). The scene is drawn only when
something in it has changed, with less detail while it moves if the machine is slow (stage.py);
panels are drawn around it less often then. A window in which nothing happens waits for events.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from imgui_bundle import imgui

from ...stopping import cleaned_up_if_stopped
from ..documents.file_drop import LANDMARKS_SUFFIX
from ..documents.scripts import draw_question
from ..interface.commands import run_pressed
from ..interface.gui import on_drop
from ..panels.layout import draw_message
from ..picture.stage import Painter
from ..session.live_commands import PACKET_WAIT
from .application import Application


class Viewer(Application):
    """The window with everything in it, as it runs; a context manager."""

    FRAMES_AFTER_EVENT = 3  # the GUI answers an event within so many frames

    _last: float  # when the last frame began [s]
    _awake: int  # frames that are drawn in any case
    refresh = 0.1  # [s] that a picture of the panels may be old while the face moves
    # Of the panels as they were drawn last: age [s], size of the window [pixels], over the scene?
    _panels_age = math.inf
    _panels_size = (0, 0)
    _is_scene_covered = True

    def __enter__(self) -> Viewer:
        self._last = time.perf_counter()
        self._awake = self.FRAMES_AFTER_EVENT
        on_drop(self.surface.handle, self.drop)
        for _ in range(2):  # panels and tabs find their places before the first picture
            self._draw_gui(is_visible=False)
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def run(self, *, playing: bool = False, once: bool = False) -> None:
        """Show the window until it is closed (with `once`: until the script has ended)."""
        if playing:
            self.session.toggle_playing()
        self._last = time.perf_counter()
        stopping = cleaned_up_if_stopped(self.exporter.close)  # when the work is safe
        with stopping, self.recovery.guarding(), cleaned_up_if_stopped(self.remember):
            while True:
                if self.gui.is_minimised:  # time stands still, and nothing is drawn
                    self._wait()
                else:
                    self.frame()
                self.messages.attempt(self.recovery.watch)
                if self.surface.should_close:
                    self.surface.should_close = False
                    self.ask_to_close()
                    if self.surface.should_close:
                        break
                    self.gui.restore()  # to be asked
                is_over = playing and not self.session.is_playing
                if once and is_over and not self.session.work.unsaved:
                    break
                self.pause()

    # One turn of the loop

    def frame(self) -> None:
        """Input, time, picture, panels."""
        if self.gui.look():
            self._awake = self.FRAMES_AFTER_EVENT
            self.life.note_input()
        for _ in self.gui.turns():
            self._draw_gui(is_visible=False)
        if self.exporter.has_news:
            self._awake = max(self._awake, 1)
        self.messages.attempt(self.exporter.poll, stays=True)
        if self.file_drop.has_news:
            self._awake = max(self._awake, 2)  # the box of the message grows a frame late
            self.messages.text = ""
            self.messages.attempt(self.file_drop.poll, stays=True)
        now = time.perf_counter()
        elapsed = now - self._last
        self._last = now
        mode = self.marking_mode
        name = self.session.work.name if mode is None else mode.marking.path.name
        is_unsaved = self.session.work.unsaved if mode is None else mode.marking.unsaved
        self.gui.set_title(f"Risorius: {name}{' *' if is_unsaved else ''}")
        is_moving = self._move_face(elapsed) if mode is None else mode.paint(elapsed)
        is_calm = self.physics.is_at_rest or self.physics.is_left_alone
        self.times.note_frame(elapsed if is_moving or not is_calm else 0.0)
        if self.is_left_alone and not (is_moving or imgui.get_io().want_text_input):
            return  # the picture stays as it is; in a line of text the cursor blinks
        self._show_panels(elapsed, is_moving=is_moving)
        self.surface.end()
        if is_moving and not self.is_left_alone:
            self.shown_painter.level_of_detail.note(time.perf_counter() - now)
        self._awake = max(self._awake - 1, 0)

    def _move_face(self, elapsed: float) -> bool:
        """Let time pass for the face, and draw it; whether the picture has changed."""
        self.messages.attempt(self.soundtrack.refresh)
        seconds = self.soundtrack.elapsed(elapsed)
        is_skin_dragged = self.mouse.is_dragging_skin
        self.messages.attempt(partial(self.live.advance, elapsed))
        if self.live.has_changed:
            self._awake = self.FRAMES_AFTER_EVENT
        is_held = is_skin_dragged or imgui.is_any_item_active()
        life = partial(self.life.after, is_held=is_held) if self.life.is_on else None
        advance = partial(self.physics.advance, seconds, is_skin_dragged=is_skin_dragged)
        self.messages.attempt(partial(advance, is_urgent=self.live.is_urgent, life=life))
        return self.painter.paint(
            elapsed, has_moved=self.physics.has_moved, is_alive=self.physics.is_left_alone
        )

    @property
    def shown_painter(self) -> Painter:
        """The painter of the present picture: of the face, or of a mesh that is marked."""
        return self.painter if self.marking_mode is None else self.marking_mode.painter

    @property
    def is_idle(self) -> bool:
        """Whether nothing moves, and nothing is about to."""
        is_settled = (
            self._awake == 0 and self.shown_painter.is_complete and not self.messages.is_fading
        )
        if self.marking_mode is not None:
            return is_settled
        return (
            is_settled
            and self.physics.is_at_rest
            and not self.life.is_on
            and not self.session.is_recording
            and not self.live.is_busy
            and not self.soundtrack.is_heard
        )

    @property
    def is_left_alone(self) -> bool:
        """Whether the face does no more than live, and nothing else happens."""
        return (
            self.marking_mode is None
            and self.physics.is_left_alone
            and self._awake == 0
            and not self.messages.is_fading
            and not self.files.is_waiting
        )

    def pause(self) -> None:
        """Sleep where nothing happens, and between frames where the face only lives.

        The latter half of the time at least, however long a frame takes. A live face that has just
        been shown is waited for: a frame that begins with its packet shows it at once.
        """
        # [s] from one frame to the next while the face does no more than live.
        life_wait = 1.0 / 30.0
        if self.is_idle:
            self._wait()
        elif self.is_left_alone:
            spent = time.perf_counter() - self._last
            self.gui.look(max(life_wait - spent, spent))
        elif self.live.is_receiving and not self.live.has_frame:
            self.gui.look(PACKET_WAIT)

    def _wait(self) -> None:
        """Sleep until an event comes, or for a while; the clock does not run on meanwhile."""
        is_watching = self.files.is_waiting or imgui.get_io().want_text_input  # a cursor blinks
        is_watching |= self.file_drop.making is not None or self.exporter.job is not None
        idle_wait = 2.0  # [s] between two frames while nothing happens
        watchful_wait = 0.1  # [s] the same while a file dialog is open, or words are typed
        patience = watchful_wait if is_watching else idle_wait
        due_in = min(self.recovery.due_in(), self.live.due_in())
        patience = min(patience, max(due_in, 0.0))
        self.soundtrack.rest()
        begin = time.perf_counter()
        self.gui.look(patience)
        self._last = time.perf_counter()
        if self._last - begin < patience and not self.live.has_frame:
            self._awake = self.FRAMES_AFTER_EVENT

    def _show_panels(self, elapsed: float, *, is_moving: bool) -> None:
        """Draw the panels around the scene, unless their last picture does.

        On software OpenGL they cost as much as a quarter of the face, and while a script plays only
        sliders creep in them. Every action of the user is answered in the same frame.
        """
        size = self.surface.size
        is_answering = self._awake > 0 or imgui.is_any_item_active()
        if not self.is_left_alone:  # the face's own life moves no slider
            self._panels_age += elapsed
        # A drag in the scene moves no slider.
        has_input = self.marking_mode is not None or (is_answering and not self.mouse.is_dragging)
        is_stale = self._panels_age >= self.refresh or size != self._panels_size
        if is_moving and not (has_input or is_stale or self._is_scene_covered):
            return
        self.surface.resolve()
        view = self.view if self.marking_mode is None else self.marking_mode.view
        left, bottom, width, _ = view.viewport
        self.surface.fill((0, 0, left, size[1]), self.gui.theme.panel)
        self.surface.fill((left, 0, width, bottom), self.gui.theme.panel)
        self._draw_gui(is_visible=True)
        self._panels_age = 0.0
        self._panels_size = size
        self._is_scene_covered = self.gui.covers(view.area)

    def _draw_gui(self, *, is_visible: bool) -> None:
        """Draw panels, and answer the user in them and in the face; is_visible: see Gui.frame."""
        messages = self.messages
        gui = self.gui
        mode = self.marking_mode
        view = self.view
        commands = self.commands
        if mode is not None:
            view = mode.view
            commands = mode.commands
        with gui.frame(is_visible=is_visible):
            gui.set_theme(self.settings.theme, self.settings.zoom)
            if mode is None:
                self.layout.draw(view)
            else:
                mode.panel.draw(mode.view)
            messages.age(imgui.get_io().delta_time)
            draw_message(gui, messages, view)
            if imgui.is_any_mouse_down():
                view.pointed = {}
            dialogs = partial(self.files.draw, gui), self.export_dialog.draw
            for draw in (
                *(() if self.question.is_open else dialogs),  # which wait for the answer
                partial(draw_question, gui, self.question, self.session, self.scripts),
            ):
                messages.attempt(draw)
            if not (self.files.is_waiting or self.question.is_open or self.exporter.is_asking):
                run_pressed(commands, messages, gui)
                (self if mode is None else mode).mouse.follow()

    def drop(self, paths: Sequence[str]) -> None:
        """Open files that were dropped onto the window."""
        self._awake = self.FRAMES_AFTER_EVENT
        open_files = partial(self.file_drop.open, paths)
        if self.marking_mode is None:
            self.messages.carry_out(open_files)
        elif [Path(path).suffix for path in paths] == [LANDMARKS_SUFFIX]:
            self.messages.carry_out(partial(self.marking_mode.marking.open, Path(paths[0])))
        else:
            self.messages.carry_out(partial(self.marking_mode.leave, open_files))
