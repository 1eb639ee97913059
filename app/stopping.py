"""Handle Ctrl-C, a closed terminal or `kill`: remove half-written files, and end the process.

The handlers raise no exception. If C code calls Python and ignores its errors, an exception would
be lost, and the signal would have no effect. During a compilation an exception crashes moderngl.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Callable, Iterator

_cleanups: list[Callable[[], object]] = []
_postponed: list[int] = []
_is_postponing = False


@contextlib.contextmanager
def cleaned_up_if_stopped(clean_up: Callable[[], object]) -> Iterator[None]:
    """Call `clean_up` if a signal ends the process inside this block; otherwise do nothing."""
    _cleanups.append(clean_up)
    try:
        yield
    finally:
        _cleanups.remove(clean_up)


@contextlib.contextmanager
def delay_signals() -> Iterator[None]:
    """Delay signals inside this block until its end; the block must be short."""
    global _is_postponing
    _is_postponing = True
    try:
        yield
    finally:
        _is_postponing = False
        if _postponed:
            _stop(_postponed[0], None)


def handle_signals() -> None:
    """Install the handlers of this module; signals that are ignored stay ignored."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # Windows lacks SIGHUP
        number = getattr(signal, name, None)
        usual = (signal.SIG_DFL, signal.default_int_handler)
        if number is not None and signal.getsignal(number) in usual:
            signal.signal(number, _stop)


def _stop(number: int, _: object) -> None:
    if _is_postponing:
        _postponed.append(number)
        return
    signal.signal(number, signal.SIG_DFL)  # a second signal ends the process at once
    for clean_up in reversed(_cleanups):
        with contextlib.suppress(Exception):  # other functions still run
            clean_up()
    with contextlib.suppress(Exception):  # streams may be closed, or in use
        if number == signal.SIGINT:
            print("risorius: stopped", file=sys.stderr)
        sys.stderr.flush()
    with contextlib.suppress(Exception):
        sys.stdout.flush()
    # The process ends as without a handler, so that a shell also ends a loop around it.
    signal.raise_signal(number)
    os._exit(128 + number)  # for systems that do not end a process this way
