"""The processes of one run, and what becomes of an item that one of them works on."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from .serving import Reply, receive, send

GRACE = 5.0  # [s] for a process to clean up, until it is killed
LIBRARIES = ("LP_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Who takes as many threads as there are cores, in each process: software OpenGL, and BLAS."""


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


class DiedError(Exception):
    """The process died while it worked; the text says of what."""


class Worker:
    """One process that works, started when it is first asked."""

    def __init__(self, threads: int) -> None:
        self._threads = threads
        self._process: subprocess.Popen[bytes] | None = None
        self._is_over = False

    def ask(self, request: bytes, log: Path | None) -> Reply:
        """Have it work on a pickled request, and wait; raises DiedError where it dies."""
        if self._process is None or self._process.poll() is not None:
            self._process = self._start()
        process = self._process
        if self._is_over:  # told so while it was started
            process.terminate()
        try:
            send(_there(process.stdin), (log, request))
            reply: Reply = pickle.loads(receive(_there(process.stdout)))
            return reply
        except (EOFError, OSError):
            raise DiedError(self._death()) from None

    def _start(self) -> subprocess.Popen[bytes]:
        code = (
            f"import sys; sys.path[:] = {sys.path!r}; "
            f"from {__package__}.serving import serve; serve()"
        )
        # In a session of its own: Ctrl-C is for the process that started it.
        return subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**dict.fromkeys(LIBRARIES, str(self._threads)), **os.environ},
            start_new_session=True,
        )

    def _death(self) -> str:
        assert self._process is not None
        self.wait()
        code = self._process.returncode
        return f"signal {-code}" if code < 0 else f"exit code {code}"

    def stop(self) -> None:
        """Ask it to end at once; it removes what it has half written."""
        self._is_over = True
        if self._process is not None:
            self._process.terminate()

    def wait(self) -> None:
        """Wait for its end, and force it if need be."""
        if self._process is None:
            return
        try:
            self._process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


class Crew:
    """The processes of one run; as many as threads of this process ask for work at once."""

    def __init__(self, threads: int) -> None:
        """threads: of the libraries in each process."""
        self._threads = threads
        self._all: list[Worker] = []
        self._idle: list[Worker] = []
        self._is_over = False

    def do(
        self,
        work: Callable[[Any], Any],
        index: int,
        item: Any,
        *,
        retries: int,
        log: Path | None,
    ) -> Outcome:
        """Work on an item in a process, again where it dies, and say what became of it."""
        request = pickle.dumps((work, item))
        worker = self._idle.pop() if self._idle else self._another()
        why = ""
        start = time.monotonic()
        for attempt in range(1, retries + 2):
            if self._is_over:
                return Outcome(index, item, None, "stopped", attempt - 1, 0.0)
            start = time.monotonic()
            try:
                reply = worker.ask(request, log)
            except DiedError as end:
                why = str(end)
                continue
            self._idle.append(worker)
            return Outcome(index, item, reply.result, reply.error, attempt, reply.seconds)
        self._idle.append(worker)
        error = f"the process that worked on it died {retries + 1} times, at last of {why}"
        return Outcome(index, item, None, error, retries + 1, time.monotonic() - start)

    def _another(self) -> Worker:
        worker = Worker(self._threads)
        self._all.append(worker)
        return worker

    def stop(self) -> None:
        """End all processes at once."""
        self._is_over = True
        for worker in self._all:
            worker.stop()
        for worker in self._all:
            worker.wait()


def _there(stream: IO[bytes] | None) -> IO[bytes]:
    assert stream is not None
    return stream
