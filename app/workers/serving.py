"""The process that works: it takes one item after the other from the process that started it.

What is printed meanwhile, by anybody, goes to the log of the item. Where the input ends, whoever
started it has ended or has no use for it: it ends at once, and half-written files go.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import pickle
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

from .. import process_cache
from ..errors import in_one_line, line_for
from ..stopping import handle_signals
from .child import streams

PATIENCE = 300.0  # [s] without work, after which the process ends
Request = tuple[Path | None, bytes]  # the log, and a pickled function with its argument


def serve() -> None:
    """Work until nobody asks any more."""
    requests, replies = streams()
    handle_signals()
    faulthandler.enable()  # a fault in a driver tells the log where
    process_cache.enable()
    inbox: queue.SimpleQueue[Request] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(requests, inbox), daemon=True).start()
    with contextlib.suppress(queue.Empty, BrokenPipeError):
        while True:
            _answer(inbox.get(timeout=PATIENCE), replies)


def _listen(requests: IO[bytes], inbox: queue.SimpleQueue[Request]) -> None:
    """Take requests, also while one is worked on: only so is their end noticed at once."""
    with contextlib.suppress(EOFError, pickle.UnpicklingError):
        while True:
            inbox.put(pickle.load(requests))
    os.kill(os.getpid(), signal.SIGTERM)


def _answer(request: Request, replies: IO[bytes]) -> None:
    """Do what is asked, and send what it gave, or None and a line that says why not."""
    log, asked = request
    with _printed_to(log):
        try:
            content = pickle.dumps(_attempt(asked))
        except (pickle.PicklingError, TypeError, AttributeError) as unfit:
            content = pickle.dumps((None, f"the result cannot be sent: {in_one_line(unfit)}"))
        replies.write(content)
        replies.flush()


def _attempt(asked: bytes) -> tuple[Any, str | None]:
    try:
        work, item = pickle.loads(asked)
        done: Callable[[Any], Any] = work
        return done(item), None
    except Exception as error:
        process_cache.clear()
        line = line_for(error)
        if line is None:  # a defect
            traceback.print_exc()
            line = in_one_line(f"{type(error).__name__}: {error}")
        print(f"risorius: {line}", file=sys.stderr)
        return None, line


@contextlib.contextmanager
def _printed_to(log: Path | None) -> Iterator[None]:
    """Add to a file what this process and those that it starts print, until the block ends."""
    if log is None:
        yield
        return
    usual = os.dup(2)
    file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
    try:
        for stream in (1, 2):
            os.dup2(file, stream)
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for stream in (1, 2):
            os.dup2(usual, stream)
        os.close(file)
        os.close(usual)
