"""The process that works: it takes one item after the other from the process that started it.

Requests come through its standard input and replies go through its standard output, as pickles.
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
import struct
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from ..errors import in_one_line, line_for
from ..keeping import keep, let_go
from ..stopping import handle_signals

PATIENCE = 300.0  # [s] without work, after which the process ends
LENGTH = struct.Struct("<Q")  # before each message: how long it is [bytes]


@dataclass(frozen=True)
class Reply:
    """How an attempt at an item ended: with what it gave, or with a line that says why not."""

    result: Any
    error: str | None
    seconds: float


def send(stream: IO[bytes], message: object) -> None:
    """Write a message; what cannot be pickled raises before anything is written."""
    content = pickle.dumps(message)
    stream.write(LENGTH.pack(len(content)) + content)
    stream.flush()


def receive(stream: IO[bytes]) -> bytes:
    """The next message, pickled; EOFError where there is none, or not the whole of it."""
    head = stream.read(LENGTH.size)
    if len(head) < LENGTH.size:
        raise EOFError
    (length,) = LENGTH.unpack(head)
    content = stream.read(length)
    if len(content) < length:
        raise EOFError
    return content


def serve() -> None:
    """Work until nobody asks any more."""
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # what is printed is no reply
    handle_signals()
    faulthandler.enable()  # a fault in a driver tells the log where
    keep()
    inbox: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(requests, inbox), daemon=True).start()
    with contextlib.suppress(queue.Empty, BrokenPipeError):
        while True:
            _answer(inbox.get(timeout=PATIENCE), replies)


def _listen(requests: IO[bytes], inbox: queue.SimpleQueue[bytes]) -> None:
    """Take requests, also while one is worked on: only so is their end noticed at once."""
    with contextlib.suppress(EOFError):
        while True:
            inbox.put(receive(requests))
    os.kill(os.getpid(), signal.SIGTERM)


def _answer(request: bytes, replies: IO[bytes]) -> None:
    start = time.monotonic()
    log, asked = pickle.loads(request)
    with _printed_to(log):
        result, error = _attempt(asked)
        try:
            send(replies, Reply(result, error, time.monotonic() - start))
        except (pickle.PicklingError, TypeError, AttributeError) as unfit:
            why = f"the result cannot be sent: {in_one_line(unfit)}"
            send(replies, Reply(None, why, time.monotonic() - start))


def _attempt(asked: bytes) -> tuple[Any, str | None]:
    """Do what is asked, a pickled function and its argument."""
    try:
        work, item = pickle.loads(asked)
        done: Callable[[Any], Any] = work
        return done(item), None
    except Exception as error:
        let_go()
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
