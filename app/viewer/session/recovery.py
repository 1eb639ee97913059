"""Unsaved work survives what ends the window: a signal, a crash, a closed terminal.

It is kept in one file beside the settings, written some seconds after a change, and when the
process is told to stop. The file goes when the work is saved or given up; what is there at the next
start is offered. Of several windows with the same scene the first has the file, by a lock that the
system lets go of however a process ends.
"""

from __future__ import annotations

import contextlib
import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import IO, Any

from risorius.assets.staging import locked
from risorius.schema import Number, Record, parsed_json, read

from ...errors import UserError
from ...files import read_text, save_text
from ...script import LONGEST_FILE, Script, parse_script, script_text
from ...stopping import cleaned_up_if_stopped
from .session import Session

INTERVAL = 2.0  # [s] after a change, in which further ones may come
LEAST_SHARE = 30.0  # ... or so many times what writing took, lest a long recording stutters


@dataclass(frozen=True)
class Work(Record):
    """What is not saved."""

    when: float  # [s since 1970]
    script: str = ""  # the text of it, with what is being recorded; "" where its file has it
    file: str = ""  # that the script was opened from or saved to; "" for none
    pose: dict[str, Number] = field(default_factory=dict)  # by hand, and no key

    @classmethod
    def of(cls, session: Session) -> Work:
        """What a session has that no file has."""
        script = session.script if session.script_is_unsaved else None
        if session.recorder is not None:
            script = session.recorder.script() or script
        file = str(session.file.path.absolute()) if session.file.path else ""
        pose = {name: value for name, value in session.values.items() if value}
        text = "" if script is None else script_text(script)
        return cls(time.time(), text, file, pose if _has_pose(session) else {})

    def parsed(self) -> Script | None:
        """The script, None where there is none; UserError where it is damaged."""
        return parse_script(self.script, source=self.file or "Untitled") if self.script else None

    @property
    def summary(self) -> str:
        """What there is of it."""
        parts = [f"the script {Path(self.file).name}".rstrip()] if self.script else []
        return " and ".join(parts + ["a pose"] * bool(self.pose))


class Recovery:
    """Keeps a session's unsaved work safe in a folder; without one it does nothing."""

    found: Work | None = None  # what a window left behind that ended, to be offered

    def __init__(
        self,
        folder: Path | None,
        session: Session,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._clock, self._session = clock, session
        self._path = folder and folder / f"unsaved-{session.scene.name}.json"
        self._lock: IO[Any] | None = None
        self._safe: object = None  # the state that the file has
        self._due = math.inf  # when it is to be written
        self._writing_took = 0.0  # [s]
        self._is_failing = False
        if self._path is not None:
            with contextlib.suppress(OSError):
                self._path.parent.mkdir(parents=True, exist_ok=True)
                self._lock = locked(self._path.with_suffix(".lock"))
                if self._lock is None:  # another window has it
                    self._path = None
        if self._path is not None:
            self.found = _read(self._path, session)

    def accept_found(self) -> None:
        """What was found is the session's work now, in place of what it had."""
        found, self.found = self.found, None
        if found is not None:
            path = Path(found.file) if found.file else None
            self._session.recover(found.parsed(), path, found.pose, found.when)

    def watch(self) -> None:
        """To be called all the time; UserError, once, where nothing can be written."""
        if self._path is None:
            return
        if not self._session.unsaved:
            if self.found is None and self._safe is not None:
                self.discard()
            self._safe, self._due = None, math.inf
        elif self._due < math.inf:
            if self.due_in() <= 0.0:
                self.save()
        elif _state(self._session) != self._safe:
            self._due = self._clock() + max(INTERVAL, LEAST_SHARE * self._writing_took)

    def due_in(self) -> float:
        """How long until something is to be written [s]; infinite if nothing is."""
        return self._due - self._clock()

    def save(self) -> None:
        """Write what is unsaved; UserError, once, where that cannot be."""
        state = _state(self._session)
        if self._path is None or state == self._safe or not self._session.unsaved:
            return
        begin = time.perf_counter()
        try:
            save_text(self._path, json.dumps(asdict(Work.of(self._session)), indent=1))
            self._is_failing = False
        except UserError as error:
            is_told, self._is_failing = self._is_failing, True
            if not is_told:
                raise UserError(f"unsaved work is not kept safe: {error}") from None
        finally:  # if it failed, it is tried again after the next change
            self._safe, self._due = state, math.inf
            self._writing_took = time.perf_counter() - begin

    def discard(self) -> None:
        """All is saved, or knowingly thrown away."""
        self.found = None
        if self._path is not None:
            with contextlib.suppress(OSError):
                self._path.unlink(missing_ok=True)

    @contextlib.contextmanager
    def guarding(self) -> Iterator[None]:
        """Keep what is unsaved if the block is stopped or fails; where it just ends, discard it."""
        try:
            with cleaned_up_if_stopped(self.save):
                yield
        except BaseException:
            with contextlib.suppress(UserError):
                self.save()
            raise
        found = self.found
        self.discard()
        if found is not None and self._path is not None:  # nobody has answered yet
            save_text(self._path, json.dumps(asdict(found), indent=1))

    def close(self) -> None:
        """Leave what is still there to the next window."""
        if self._lock is not None:
            self._lock.close()


def _read(path: Path, session: Session) -> Work | None:
    """The work in a file; None where there is none, or none for this scene."""
    with contextlib.suppress(UserError, ValueError):
        text = read_text(path, what="file of unsaved work", longest=LONGEST_FILE)
        work = read(Work, parsed_json(text), str(path))
        script, limits = work.parsed(), session.controls.limits
        if script is not None:
            script.check(limits)
        if work.pose.keys() <= limits.keys() and work.summary:
            return work
    return None


def _has_pose(session: Session) -> bool:
    """Whether there is one; what is moved while a recording is paused, that has not."""
    missed = session.recorder.missed if session.recorder is not None else {}
    return session.has_unsaved_pose or (bool(missed) and not session.is_playing)


def _state(session: Session) -> object:
    """What tells whether there is other work to be kept; quickly made and compared."""
    return (
        session.script if session.script_is_unsaved else None,
        dict(session.values) if _has_pose(session) else None,
        session.recorded_seconds,
    )
