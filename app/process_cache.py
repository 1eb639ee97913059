"""What a process keeps for the next piece of work; a process that does one thing keeps nothing."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import TypeVar, cast

Thing = TypeVar("Thing")
MOST = 2  # things of one kind; those that were used last

_cached: dict[str, dict[Hashable, tuple[object, Callable[[], object]]]] | None = None


def enable() -> None:
    """From here on keep what `cached` is asked for."""
    global _cached
    _cached = {}


def clear() -> None:
    """Close what is kept, and begin anew: after an error nobody knows in what state it is."""
    for things in (_cached or {}).values():
        for _, close in things.values():
            with contextlib.suppress(Exception):  # what is broken cannot be closed
                close()
        things.clear()


def is_enabled() -> bool:
    """Whether this process keeps things."""
    return _cached is not None


def cached(
    kind: str,
    key: Hashable,
    make: Callable[[], Thing],
    close: Callable[[Thing], object] = lambda _: None,
) -> Thing:
    """What was made for this key before, or else what `make` makes now.

    Whoever takes it brings it into the state that a new one has. close: is called with what gives
    way to others; what is not kept at all is the caller's to close.
    """
    if _cached is None:
        return make()
    things = _cached.setdefault(kind, {})
    if key not in things:
        while len(things) >= MOST:  # first, so that there is room for the new one
            _, close_it = things.pop(next(iter(things)))
            close_it()
        thing = make()
        things[key] = thing, lambda: close(thing)
    things[key] = things.pop(key)  # as the last one
    return cast(Thing, things[key][0])


def file_state(path: Path) -> tuple[str, int, int]:
    """What tells one content of a file from another: its place, size and time.

    The size is -1 where there is none.
    """
    try:
        found = path.stat()
    except OSError:
        return str(path), -1, 0
    return os.path.realpath(path), found.st_size, found.st_mtime_ns
