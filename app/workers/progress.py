"""One task in a process of its own, which tells meanwhile how far it is."""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from ..motion import tally
from .pool import Outcome, WorkerPool

PAUSE = 0.2  # [s] between two numbers


class Task:
    """Something that plays frames, done by another process; the one that waits stays free."""

    def __init__(self, work: Callable[[], object], frame_count: int, wake: Callable[[], None]):
        """Begin; wake: called when it has ended, from a thread."""
        self._frame_count, self._pool = frame_count, WorkerPool(1)
        handle, log = tempfile.mkstemp(prefix="risorius-", suffix=".log")
        os.close(handle)
        self._log = Path(log)
        thread = ThreadPoolExecutor(1)
        self._end = thread.submit(self._pool.do, count_frames, 0, work, self._log, retries=0)
        self._end.add_done_callback(lambda _: wake())
        thread.shutdown(wait=False)
        self._stopping: threading.Thread | None = None

    @property
    def share(self) -> float:
        """How much of it is done, 0..1; 0 where it is stopped."""
        words = "" if self.is_stopped else self._log.read_text(errors="replace")
        frames = next((int(word) for word in reversed(words.split()) if word.isdecimal()), 0)
        return min(frames / self._frame_count, 1.0)

    @property
    def outcome(self) -> Outcome | None:
        """What became of it; None while it goes on."""
        return self._end.result() if self._end.done() else None

    @property
    def is_stopped(self) -> bool:
        """Whether it was told to end."""
        return self._stopping is not None

    def stop(self, *, waits: bool) -> None:
        """End it, wherever it is; it removes what it has half written, which takes a while."""
        if self._stopping is None:
            self._stopping = threading.Thread(target=self._stop)
            self._stopping.start()
        if waits:
            self._stopping.join()

    def _stop(self) -> None:
        self._pool.stop()
        self._log.unlink(missing_ok=True)


def count_frames(work: Callable[[], object]) -> None:
    """In that process: do it, and print again and again how many frames were played."""
    before, is_done = tally.frames, threading.Event()
    if hasattr(os, "nice"):
        os.nice(5)  # whoever waits goes first

    def report() -> None:
        while not is_done.wait(PAUSE):
            print(tally.frames - before, flush=True)

    threading.Thread(target=report, daemon=True).start()
    try:
        work()
    finally:
        is_done.set()
