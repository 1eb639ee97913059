"""The processes of one run, and what becomes of an item that one of them works on."""

from __future__ import annotations

import contextlib
import os
import pickle
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import serving
from .child import Child, DiedError

LIBRARIES = ("LP_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Who takes as many threads as there are cores, in each process: software OpenGL, and BLAS."""
RETRIES = 2  # of an item whose process died


@dataclass(frozen=True)
class Outcome:
    """What became of an item.

    index: its place among the items. result: what the work returned. error: why there is none, in
    one line, or None. attempts: how many were begun here. seconds: of the last one.
    """

    index: int
    item: Any
    result: Any
    error: str | None
    attempts: int
    seconds: float


class WorkerPool:
    """The processes of one run: one for each thread of this process that asks for work."""

    def __init__(self, threads: int) -> None:
        """threads: of the libraries in each process."""
        self._environment = {**dict.fromkeys(LIBRARIES, str(threads)), **os.environ}
        self._all: list[Child] = []
        self._own = threading.local()
        self._is_over = False

    def do(
        self,
        work: Callable[[Any], Any],
        index: int,
        item: Any,
        log: Path | None,
        retries: int = RETRIES,
    ) -> Outcome:
        """Work on an item in a process, again where it dies, and say what became of it."""
        request = pickle.dumps((work, item))
        why, start = "", time.monotonic()
        for attempt in range(1, retries + 2):
            if self._is_over:
                return Outcome(index, item, None, "stopped", attempt - 1, 0.0)
            start = time.monotonic()
            child = self._child()
            try:
                child.send((log, request))
                result, error = child.receive()
            except DiedError as end:
                why = str(end)
                _note(log, f"risorius: the process of attempt {attempt} died of {why}")
                continue
            return Outcome(index, item, result, error, attempt, time.monotonic() - start)
        error = f"the process that worked on it died {retries + 1} times, at last of {why}"
        return Outcome(index, item, None, error, retries + 1, time.monotonic() - start)

    def _child(self) -> Child:
        """The process of this thread; a new one where it has none, or that has ended."""
        child: Child | None = getattr(self._own, "child", None)
        if child is None or child.process.poll() is not None:
            child = self._own.child = Child(serving.__name__, self._environment)
            self._all.append(child)
            if self._is_over:  # told so while it was started
                child.process.terminate()
        return child

    def stop(self) -> None:
        """End all processes at once; they remove what they have half written."""
        self._is_over = True
        for child in self._all:
            child.process.terminate()
        for child in self._all:
            child.close()


def _note(log: Path | None, line: str) -> None:
    """Add a line to a log; where that cannot be written, the outcome tells enough."""
    if log is not None:
        with contextlib.suppress(OSError), log.open("a", encoding="utf-8") as file:
            file.write(f"{line}\n")
