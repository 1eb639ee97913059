"""A process of ours, and the messages to it and back: pickles through its standard streams.

It is started anew and never forked: a process that was forked after OpenGL was opened hangs. It is
in a session of its own, so that Ctrl-C is for the process that started it.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from typing import IO, Any

GRACE = 5.0  # [s] for a process to clean up, until it is killed


class DiedError(Exception):
    """The process died; the text says of what."""


class Child:
    """A process that calls `serve` of a module, as the process that started it sees it."""

    def __init__(self, module: str, environment: dict[str, str]) -> None:
        code = f"import sys; sys.path[:] = {sys.path!r}; from {module} import serve; serve()"
        self.process = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
            start_new_session=True,
        )
        assert self.process.stdin is not None and self.process.stdout is not None
        self._messages, self._answers = self.process.stdin, self.process.stdout

    def send(self, message: object) -> None:
        """Hand a message over; DiedError where it died, and what cannot be pickled raises."""
        content = pickle.dumps(message)
        try:
            self._messages.write(content)
            self._messages.flush()
        except OSError:
            raise self._death() from None

    def receive(self) -> Any:
        """Wait for its next message; DiedError where it died before the whole of it."""
        try:
            return pickle.load(self._answers)
        except (EOFError, OSError, pickle.UnpicklingError):
            raise self._death() from None

    def _death(self) -> DiedError:
        self.close()
        code = self.process.returncode
        return DiedError(signal.Signals(-code).name if code < 0 else f"exit code {code}")

    def close(self) -> None:
        """Wait for its end, and force it if need be."""
        try:
            self.process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def streams() -> tuple[IO[bytes], IO[bytes]]:
    """In such a process: where messages come from and where they go; what is printed is none."""
    messages, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    return messages, answers


def cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def share_of_cores() -> int:
    """How many of them are for one command: `LP_NUM_THREADS`, which limits OpenGL, limits all."""
    told = os.environ.get("LP_NUM_THREADS", "")
    return max(int(told), 1) if told.isdecimal() else cores()
