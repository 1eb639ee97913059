"""Unsaved work survives what ends the window: a signal, a crash, a closed terminal.

It is written to files of its own (unsaved.py) after a pause in the work, at intervals where there
is none, and when the process is told to stop. The files go when the work is saved or given up;
what another window left behind is offered.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from ...errors import UserError
from ...script import pose_script, prepare_text
from ...stopping import cleaned_up_if_stopped
from .session import Session
from .unsaved import Work, WorkFiles, left_behind

QUIET = 1.0  # [s] without a change after which it is written
LONGEST = 3.0  # [s] for which changes without a pause are not written
LEAST_SHARE = 30.0  # ... or so many times what writing took, lest a long recording stutters
POSE_TITLE = "Unsaved pose"


class Recovery:
    """Keeps a session's unsaved work safe in a folder; without one it does nothing."""

    def __init__(self, folder: Path | None, clock: Callable[[], float] = time.monotonic) -> None:
        self._folder, self._clock = folder, clock
        self._own: WorkFiles | None = None
        self._found: WorkFiles | None = None
        self._seen: object = None  # the state of the session, and when it became so
        self._changed_at = 0.0
        self._safe: object = None  # the state that the files have, and since when they may lag
        self._lags_since = 0.0
        self._writing_took = 0.0
        self._is_failing = False

    def find(self, session: Session) -> None:
        """Find what was left behind and fits the session's scene."""
        self._leave_found()
        if self._folder is None:
            return
        for files in left_behind(self._folder):
            if files.work.fits(session.script.scene, session.controls.limits):
                self._found = files
                return
            files.leave()

    @property
    def found(self) -> Work | None:
        """What a window left behind that ended, to be offered; None where there is nothing."""
        return self._found.work if self._found is not None else None

    @property
    def found_at(self) -> float:
        """When what was found was written [s since 1970]."""
        return self._found.time if self._found is not None else 0.0

    def accept_found(self, session: Session) -> None:
        """What was found is the session's work now, in place of what it had."""
        if self._found is None:
            return
        session.recover(self._found.work, self.found_at)
        self.discard()
        self._own, self._found = self._found, None
        self._seen = self._safe = _state(session)

    def discard_found(self, session: Session) -> None:
        """What was found is given up; there may be more."""
        if self._found is not None:
            self._found.remove()
            self._found = None
        self.find(session)

    def watch(self, session: Session) -> None:
        """To be called all the time; UserError, once, where nothing can be written."""
        if self._folder is None:
            return
        now, state = self._clock(), _state(session)
        if state != self._seen:
            if self._seen == self._safe:
                self._lags_since = now
            self._seen, self._changed_at = state, now
        if not session.unsaved:
            self.discard()
            self._safe = state
        elif self.due_in() <= 0.0:
            # A long script is made into text in many calls, lest the window stands still; where
            # it changes all the time, at once.
            is_urgent = self.due_in() < -LONGEST
            if is_urgent or not (session.script_is_unsaved and prepare_text(session.script)):
                self.save(session)

    def due_in(self) -> float:
        """How long until something is to be written [s]; infinite if nothing is."""
        if self._seen == self._safe:
            return float("inf")
        longest = max(LONGEST, LEAST_SHARE * self._writing_took)
        due = min(self._changed_at + QUIET, self._lags_since + longest)
        return due - self._clock()

    def save(self, session: Session) -> None:
        """Write what is unsaved; UserError, once, where that cannot be."""
        state = _state(session)
        if self._folder is None or state == self._safe:
            return
        begin = time.perf_counter()
        try:
            if self._own is None:
                self._own = WorkFiles.new(self._folder)
            self._own.write(work_of(session))
            self._is_failing = False
        except UserError as error:
            is_told, self._is_failing = self._is_failing, True
            if not is_told:
                raise UserError(f"unsaved work is not kept safe: {error}") from None
        finally:  # if it failed, it is tried again after the next change
            self._seen = self._safe = state
            self._writing_took = time.perf_counter() - begin

    def discard(self) -> None:
        """All is saved, or knowingly thrown away."""
        if self._own is not None:
            self._own.remove()
        self._own = None

    @contextlib.contextmanager
    def guarding(self, session: Session) -> Iterator[None]:
        """Keep what is unsaved if the block is stopped or fails; where it just ends, discard it."""
        try:
            with cleaned_up_if_stopped(lambda: self.save(session)):
                yield
        except BaseException:
            with contextlib.suppress(UserError):
                self.save(session)
            raise
        self.discard()

    def close(self) -> None:
        """Leave what is still there to the next window."""
        self._leave_found()
        if self._own is not None:
            self._own.leave()

    def _leave_found(self) -> None:
        if self._found is not None:
            self._found.leave()
        self._found = None


def work_of(session: Session) -> Work:
    """What a session has that no file has."""
    is_unsaved = session.script_is_unsaved
    pose = pose_script(session.values, title=POSE_TITLE, scene=session.script.scene)
    return Work(
        script=session.script if is_unsaved else None,
        path=session.file.path if is_unsaved else None,
        recording=session.recorder.script() if session.recorder is not None else None,
        pose=pose if _has_pose(session) else None,
    )


def _has_pose(session: Session) -> bool:
    """Whether there is one; what is moved while a recording is paused, that has not."""
    missed = session.recorder.missed if session.recorder is not None else {}
    return session.has_unsaved_pose or (bool(missed) and not session.is_playing)


def _state(session: Session) -> object:
    """What tells whether `work_of` would give something else; quickly made and compared."""
    return (
        session.script if session.script_is_unsaved else None,
        dict(session.values) if _has_pose(session) else None,
        session.recorded_seconds,
    )
