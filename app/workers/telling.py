"""How far a process is that works on something, for the one that waits for it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from ..motion import tally

PAUSE = 0.2  # [s] between two numbers
Result = TypeVar("Result")


def telling(task: Callable[[], Result]) -> Result:
    """In a process that works: do a task, and print again and again how many frames were played."""
    before, is_done = tally.frames, threading.Event()

    def tell() -> None:
        """Print numbers until the task is done."""
        while not is_done.wait(PAUSE):
            print(tally.frames - before, flush=True)

    threading.Thread(target=tell, daemon=True).start()
    try:
        return task()
    finally:
        is_done.set()


def told(log: Path) -> int:
    """How many frames were played, by the log of a process that is telling; 0 for none yet."""
    lines = log.read_text(errors="replace").split()
    return next((int(word) for word in reversed(lines) if word.isdecimal()), 0)
