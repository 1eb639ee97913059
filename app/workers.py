"""Work in separate processes; if a process dies, another one repeats its work.

A new process is started for each piece of work. It is not forked, because a forked process hangs if
its parent has used OpenGL. It has its own session, so that only its parent gets Ctrl-C. Work is a
function at the top of a module; its arguments and messages are pickled. When the parent ends, for
any reason, the process also ends, and removes half-written files.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from enum import Enum
from pathlib import Path
from typing import Any

from .errors import UserError, line_for, traceback_of
from .stopping import cleaned_up_if_stopped, handle_signals
from .tally import tally
from .text import as_text, in_one_line

Send = Callable[[object], None]  # sends a message to the process that started the work
MOST_ATTEMPTS = 3  # number of attempts at a piece of work whose process dies
GRACE_TIME = 5.0  # [s] for a process to clean up before it is killed


class AnswerKind(Enum):
    """Kinds of answers from a process: messages of its work, then success or failure."""

    MESSAGE = 1
    FAILED = 2
    DONE = 3


class DiedError(Exception):
    """A process died; the text names the cause."""


class Worker:
    """A process that does one piece of work, as its parent sees it."""

    def __init__(
        self,
        work: Callable[..., object],
        *arguments: Any,
        threads: int = 1,
        log: Path | None = None,
    ) -> None:
        """Begin `work(*arguments, send)`.

        threads: number of threads for each of OpenGL, BLAS and refinement; without a limit they
        use one for each core. log: the file for the output of the process; None: the error stream.
        """
        code = f"import sys; sys.path[:] = {sys.path!r}; from {__name__} import serve; serve()"
        with contextlib.ExitStack() as stack:
            libraries = [
                f"{name}_NUM_THREADS" for name in ("LP", "OMP", "OPENBLAS", "MKL", "NUMBA")
            ]
            self.process = subprocess.Popen(
                [sys.executable, "-c", code],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=None if log is None else stack.enter_context(log.open("ab")),
                env={**os.environ, **dict.fromkeys(libraries, str(threads))},
                start_new_session=True,
            )
        assert self.process.stdin is not None and self.process.stdout is not None
        self._answers = self.process.stdout
        with contextlib.suppress(OSError):  # it died, as `messages` will report
            self.process.stdin.write(pickle.dumps((work, arguments)))
            self.process.stdin.flush()

    def messages(self) -> Iterator[Any]:
        """Yield messages of the work.

        Raises UserError for an error in the work, and DiedError if the process died.
        """
        while True:
            try:
                kind, content = pickle.load(self._answers)
            except (EOFError, OSError, pickle.UnpicklingError):
                self.close()
                code = self.process.returncode
                why = signal.Signals(-code).name if code < 0 else f"exit code {code}"
                raise DiedError(why) from None
            if kind is AnswerKind.MESSAGE:
                yield content
                continue
            self.close()
            if kind is AnswerKind.FAILED:
                raise UserError(*content)
            return

    def close(self) -> None:
        """Wait until the process ends, and kill it if necessary."""
        try:
            self.process.wait(GRACE_TIME)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def serve() -> None:
    """Read the work from the standard input, and do it; this runs in a worker's process."""
    requests = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # prints must not mix with messages
    handle_signals()
    faulthandler.enable()  # the log gets the place of a driver's fault
    try:
        request = pickle.load(requests)
    except EOFError:  # the parent was stopped
        return

    def end_with_parent() -> None:
        os.read(requests.fileno(), 1)
        os.kill(os.getpid(), signal.SIGTERM)

    waiting: queue.Queue[bytes] = queue.Queue(4)  # messages not yet sent

    def hand_over() -> None:
        """Send messages while the work goes on; end the process if the parent does not read."""
        try:
            while content := waiting.get():
                answers.write(content)
                answers.flush()
        except BrokenPipeError:
            os._exit(1)

    writer = threading.Thread(target=hand_over)
    writer.start()
    threading.Thread(target=end_with_parent, daemon=True).start()
    end = _outcome(
        *request, send=lambda each: waiting.put(pickle.dumps((AnswerKind.MESSAGE, each)))
    )
    waiting.put(pickle.dumps(end))
    waiting.put(b"")
    writer.join()


def _outcome(
    work: Callable[..., object], arguments: Sequence[Any], *, send: Send
) -> tuple[AnswerKind, tuple[str, str]]:
    """Do the work; return DONE, or FAILED with the reason in one line and the traceback."""
    try:
        work(*arguments, send)
    except Exception as error:
        line = line_for(error)
        if line is None:  # a defect
            traceback.print_exc()
            line = in_one_line(f"{type(error).__name__}: {error}")
        return AnswerKind.FAILED, (line, traceback_of(error))
    return AnswerKind.DONE, ("", "")


class WorkerPool:
    """The processes of one run, for which threads of this process wait; `stop` ends them all."""

    def __init__(self, jobs: int = 1) -> None:
        """jobs: number of simultaneous processes, which share the cores."""
        self._threads = max(1, share_of_cores() // jobs)
        self._workers = list[Worker]()
        self._is_over = False

    def run(
        self,
        work: Callable[..., object],
        *arguments: Any,
        on_message: Callable[[Any], object] = lambda _: None,
        log: Path | None = None,
        attempts: int = MOST_ATTEMPTS,
    ) -> None:
        """Do work in a process, and again if the process dies.

        on_message: function that gets each message. Raises UserError for an error in the work, if
        the process dies in the last attempt, and after `stop`.
        """
        why = ""
        for attempt in range(attempts):
            if self._is_over:
                break
            worker = Worker(work, *arguments, threads=self._threads, log=log)
            self._workers.append(worker)
            if self._is_over:  # stopped during its start
                worker.process.terminate()
            try:
                for message in worker.messages():
                    on_message(message)
                return
            except UserError as error:
                if error.trace:
                    _note(log, error.trace)
                raise
            except DiedError as end:
                why = str(end)
                _note(log, f"risorius: the process of attempt {attempt + 1} died of {why}\n")
            finally:
                self._workers.remove(worker)
        if self._is_over:
            raise UserError("stopped")
        times = f" {attempts} times, the last time" if attempts > 1 else ""
        raise UserError(f"the process that worked on it died{times} of {why}")

    def stop(self) -> None:
        """End all processes at once; they remove half-written files."""
        self._is_over = True
        workers = [*self._workers]
        for worker in workers:
            worker.process.terminate()
        for worker in workers:
            worker.close()


def _note(log: Path | None, text: str) -> None:
    """Add a text to the log of a process, if it has one."""
    if log is not None:
        with contextlib.suppress(OSError), log.open("a", encoding="utf-8") as file:
            file.write(as_text(text))


def run_all(
    work: Callable[..., object], parts: Sequence[Any], *, log: Path | None = None
) -> Iterator[Any]:
    """Do `work(part, send)` for all parts in parallel; yield their messages as they come.

    A part whose process died begins again. If the caller stops early, or is stopped, all processes
    end. Raises UserError for the first failure.
    """
    pool = WorkerPool(max(len(parts), 1))
    messages = queue.SimpleQueue[Any]()
    end = object()

    def run(part: Any) -> None:
        """Do one part in a process, and queue its messages, its error or its end."""
        try:
            pool.run(work, part, on_message=messages.put, log=log)
            messages.put(end)
        except Exception as error:
            messages.put(error)

    with cleaned_up_if_stopped(pool.stop), ThreadPoolExecutor(max(len(parts), 1)) as threads:
        try:
            left = len([threads.submit(run, part) for part in parts])
            while left:
                message = messages.get()
                if isinstance(message, Exception):
                    raise message
                if message is end:
                    left -= 1
                else:
                    yield message
        finally:
            pool.stop()


class BackgroundWork:
    """Work that plays frames in a process, while the calling process stays free."""

    def __init__(self, work: Callable[[], object], frame_count: int, wake: Callable[[], None]):
        """Start the work; wake: function that a thread calls when the work has ended."""
        self._frame_count = frame_count
        self._frames = 0
        self._pool = WorkerPool(share_of_cores())  # one is for the work, others for the window
        thread = ThreadPoolExecutor(1)
        self._end = thread.submit(
            self._pool.run, count_frames, work, on_message=self._count, attempts=1
        )
        self._end.add_done_callback(lambda _: wake())
        thread.shutdown(wait=False)
        self._stopping: threading.Thread | None = None

    def _count(self, frames: int) -> None:
        self._frames = frames

    @property
    def share(self) -> float:
        """Finished fraction of the work, 0..1; 0 if it is stopped."""
        return 0.0 if self.is_stopped else min(self._frames / self._frame_count, 1.0)

    @property
    def is_done(self) -> bool:
        """Whether the work has ended."""
        return self._end.done()

    @property
    def is_stopped(self) -> bool:
        """Whether `stop` was called."""
        return self._stopping is not None

    def check(self) -> None:
        """Raise UserError if the work failed; call this after the end of the work."""
        self._end.result()

    def stop(self, *, waits: bool) -> None:
        """End the work at once; removing half-written files takes a while."""
        if self._stopping is None:
            self._stopping = threading.Thread(target=self._pool.stop)
            self._stopping.start()
        if waits:
            self._stopping.join()


def count_frames(work: Callable[[], object], send: Send) -> None:
    """Do the work in this process, and repeatedly send the number of played frames."""
    is_done = threading.Event()
    lower_priority(5)

    def report() -> None:
        while not is_done.wait(0.2):  # [s] between two numbers
            send(tally.frames)

    thread = threading.Thread(target=report)
    thread.start()
    try:
        work()
    finally:
        is_done.set()
        thread.join()


def lower_priority(niceness: int) -> None:
    """Lower the priority of this process below its parent's; niceness: 1 to 19."""
    if hasattr(os, "nice"):
        os.nice(niceness)
    # If Linux shares time between sessions, niceness only works within one, and each process has
    # its own session.
    with contextlib.suppress(OSError):
        Path("/proc/self/autogroup").write_text(str(niceness))


def share_of_cores() -> int:
    """Return the number of cores for one command; `LP_NUM_THREADS` limits it, as it does OpenGL."""
    limit = os.environ.get("LP_NUM_THREADS", "")
    if limit.isdecimal():
        return max(int(limit), 1)
    has_affinity = hasattr(os, "sched_getaffinity")
    return len(os.sched_getaffinity(0)) if has_affinity else os.cpu_count() or 1
