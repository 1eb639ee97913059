"""What a process keeps for the next piece of work; a process that does one thing keeps nothing."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import TypeVar

Thing = TypeVar("Thing")
MOST = 4  # things of one kind; those that were used last

_kept: dict[str, dict[Hashable, object]] | None = None


def keep() -> None:
    """From here on keep what `kept` is asked for."""
    global _kept
    _kept = {}


def kept(kind: str, key: Hashable, make: Callable[[], Thing]) -> Thing:
    """What was made for this key before, or else what `make` makes now.

    Whoever takes it brings it into the state that a new one has.
    """
    if _kept is None:
        return make()
    things = _kept.setdefault(kind, {})
    thing = things.pop(key) if key in things else make()
    things[key] = thing  # as the last one
    if len(things) > MOST:
        del things[next(iter(things))]
    return thing  # type: ignore[return-value]


def state_of(path: Path) -> tuple[str, int, int]:
    """What tells one content of a file from another: its place, size and time.

    The size is -1 where there is none.
    """
    try:
        found = path.stat()
    except OSError:
        return str(path), -1, 0
    return os.path.realpath(path), found.st_size, found.st_mtime_ns
