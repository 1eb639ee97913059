"""The times of the window's frames, and its waits for events between them."""

from __future__ import annotations

import time
from collections.abc import Callable

from imgui_bundle import imgui

from ..context import ApplicationContext
from ..documents.file_drop import FileDrop
from ..session.live_commands import PACKET_WAIT
from .mode import Mode


class Schedule:
    """Measures the times of frames, and lets an idle window sleep until an event."""

    FRAMES_AFTER_EVENT = 3  # the GUI responds to an event within this many frames

    def __init__(
        self,
        context: ApplicationContext,
        file_drop: FileDrop,
        mode: Callable[[], Mode],
        due_in: Callable[[], float],
    ) -> None:
        """mode: returns the current mode. due_in: returns the time to the next saving [s]."""
        self._context = context
        self._file_drop = file_drop
        self._mode = mode
        self._due_in = due_in
        self._begun = time.perf_counter()  # start time of the current frame [s]
        self._awake = self.FRAMES_AFTER_EVENT  # number of frames to draw because of an event

    def restart(self) -> None:
        """Forget the time that has passed since the last frame."""
        self._begun = time.perf_counter()

    def wake(self, frames: int = FRAMES_AFTER_EVENT) -> None:
        """Draw at least this many frames."""
        self._awake = max(self._awake, frames)

    def begin_frame(self) -> float:
        """Begin a frame; return the seconds since the last one began."""
        last = self._begun
        self._begun = time.perf_counter()
        return self._begun - last

    def end_frame(self) -> None:
        """Note that a frame is drawn, and count down the frames still to draw."""
        self._awake = max(self._awake - 1, 0)

    @property
    def spent(self) -> float:
        """Time of the current frame so far [s]."""
        return time.perf_counter() - self._begun

    @property
    def is_awake(self) -> bool:
        """Whether a recent event requires more frames."""
        return self._awake > 0

    @property
    def is_idle(self) -> bool:
        """Whether everything is at rest, and stays at rest without an event."""
        mode = self._mode()
        return (
            not self.is_awake
            and mode.painter.is_complete
            and not self._context.messages.is_fading
            and mode.is_at_rest
        )

    @property
    def is_idling(self) -> bool:
        """Whether the face only has idle life, and nothing else happens."""
        return (
            self._mode().is_idling
            and not self.is_awake
            and not self._context.messages.is_fading
            and not self._context.files.is_waiting
        )

    def pause(self) -> None:
        """Sleep while nothing happens, and between frames of idle life.

        During idle life the window sleeps at least half of the time. During a live face, a frame
        waits for the next packet, which it then shows at once.
        """
        gui = self._context.gui
        live = self._context.live
        life_wait = 1.0 / 15.0  # [s] from one frame of idle life to the next
        if self.is_idle:
            self.sleep()
        elif self.is_idling:
            spent = self.spent
            gui.read_events(max(life_wait - spent, spent))
        elif live.is_receiving and not live.has_frame:
            gui.read_events(PACKET_WAIT)

    def sleep(self) -> None:
        """Sleep until an event comes, or for a short time; this time does not count as elapsed."""
        context = self._context
        is_watching = (
            context.files.is_waiting
            or imgui.get_io().want_text_input  # for the blinking cursor
            or self._file_drop.is_making
            or context.exporter.job is not None
        )
        idle_wait = 2.0  # [s] between two frames while nothing happens
        watchful_wait = 0.1  # [s] the same during a dialog, typing or background work
        patience = watchful_wait if is_watching else idle_wait
        due_in = min(self._due_in(), context.live.due_in())
        patience = min(patience, max(due_in, 0.0))
        self._mode().rest()
        self.restart()
        context.gui.read_events(patience)
        is_woken = self.spent < patience
        self.restart()
        if is_woken and not context.live.has_frame:
            self.wake()
