"""Keep unsaved work if a signal, a crash or a closed terminal ends the window.

A script beside the settings stores the work, with a pose by hand as a key. It is written some
seconds after a change, and when a signal stops the process. It is removed when the work is saved or
discarded. If the next window finds such a file, it adds the time of writing to the file's name, and
the user can open the file like any script. The first of several windows with the same scene locks
the file; the system releases the lock when the process ends.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

from ...errors import UserError
from ...script import Script, keyframes
from ...script.script_file import save_script
from ...staging import locked
from ...stopping import cleaned_up_if_stopped
from .session import Session

WRITING_INTERVAL = 2.0  # [s] from a change to its writing, to include further changes


class Recovery:
    """Stores a session's unsaved work in a folder; does nothing without a folder."""

    found: Path | None = None  # the script that an earlier window left behind

    def __init__(
        self, folder: Path | None, session: Session, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._clock = clock
        self._session = session
        self._path = folder and folder / f"unsaved-{session.scene.name}.toml"
        self._lock: IO[Any] | None = None
        self._safe: object = None  # the state in the file
        self._due = math.inf  # due time of the file
        self._writing_took = 0.0  # [s]
        self._is_failing = False
        if self._path is not None:
            with contextlib.suppress(OSError):
                self._path.parent.mkdir(parents=True, exist_ok=True)
                self._lock = locked(self._path.with_suffix(".lock"))
                if self._lock is None:  # another window has the lock
                    self._path = None
                elif self._path.exists():
                    when = time.localtime(self._path.stat().st_mtime)
                    kept = f"{self._path.stem}-{time.strftime('%Y%m%d-%H%M%S', when)}"
                    self.found = self._path.replace(self._path.with_stem(kept))

    def watch(self) -> None:
        """Note changes, and write the file when it is due; each turn of the loop calls this.

        Raises UserError, once, if the file cannot be written.
        """
        if self._path is None:
            return
        pause_factor = 30.0  # least pause, in times of writing, for long recordings
        if not self._session.work.unsaved:
            if self._safe is not None:
                self.discard()
            self._safe = None
            self._due = math.inf
        elif self._due < math.inf:
            if self.due_in() <= 0.0:
                self.save()
        elif _state(self._session) != self._safe:
            self._due = self._clock() + max(WRITING_INTERVAL, pause_factor * self._writing_took)

    def due_in(self) -> float:
        """Time until the file must be written [s]; infinite without a change."""
        return self._due - self._clock()

    def save(self) -> None:
        """Write unsaved work; if the file cannot be written, the first call raises UserError."""
        state = _state(self._session)
        if self._path is None or state == self._safe or not self._session.work.unsaved:
            return
        begin = time.perf_counter()
        try:
            save_script(self._path, unsaved_script(self._session))
            self._is_failing = False
        except UserError as error:
            is_reported = self._is_failing
            self._is_failing = True
            if not is_reported:
                raise UserError(f"unsaved work is not kept safe: {error}") from None
        finally:  # a failed write is repeated after the next change
            self._safe = state
            self._due = math.inf
            self._writing_took = time.perf_counter() - begin

    def discard(self) -> None:
        """Remove the file: all work is saved, or deliberately discarded."""
        if self._path is not None:
            with contextlib.suppress(OSError):
                self._path.unlink(missing_ok=True)

    @contextlib.contextmanager
    def guarding(self) -> Iterator[None]:
        """Write unsaved work if the block is stopped or fails; else remove the file at its end."""
        try:
            with cleaned_up_if_stopped(self.save):
                yield
        except BaseException:
            with contextlib.suppress(UserError):
                self.save()
            raise
        self.discard()

    def close(self) -> None:
        """Release the lock, and leave an existing file to the next window."""
        if self._lock is not None:
            self._lock.close()


def unsaved_script(session: Session) -> Script:
    """Return the script with the recording; a pose by hand becomes a key at the current time."""
    recorder = session.recorder
    script = (recorder.script() if recorder is not None else None) or session.script
    if _has_pose(session):
        time = keyframes.key_time(script, session.time)
        script = keyframes.keyed(script, time, session.values)
    return script


def _has_pose(session: Session) -> bool:
    """Whether a pose by hand is unsaved, or controls were moved in a paused recording."""
    missed = session.recorder.missed if session.recorder is not None else {}
    return session.work.has_unsaved_pose or (bool(missed) and not session.is_playing)


def _state(session: Session) -> object:
    """Return a value that differs if the unsaved work differs, and that is compared fast."""
    return (
        session.script if session.work.script_is_unsaved else None,
        session.values if _has_pose(session) else None,
        session.recorded_seconds,
    )
