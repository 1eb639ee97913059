"""What processes are asked to do in the tests of `app/workers`."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from risorius.app.errors import UserError
from risorius.app.files import written_atomically


def double(number: int) -> tuple[int, int]:
    """Twice the number, and the process that found it."""
    return 2 * number, os.getpid()


def library_threads(_: object) -> str | None:
    """How many threads software OpenGL may have."""
    return os.environ.get("LP_NUM_THREADS")


def die_once(mark: Path) -> str:
    """Die at the first call, unless the mark's name begins with `calm`."""
    if not mark.exists() and not mark.name.startswith("calm"):
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return mark.name


def die_before_the_end(target: Path) -> None:
    """Write a file, and die at the first call when it is all but whole."""
    begun = target.with_name(f"{target.name}.begun")
    with written_atomically(target) as part:
        part.write_text("whole")
        if not begun.exists():
            begun.touch()
            os.kill(os.getpid(), signal.SIGKILL)


def die(name: str) -> str:
    """Die at every call of this name, by a fault."""
    if name == "deadly":
        os.kill(os.getpid(), signal.SIGSEGV)
    return name


def fail(kind: str) -> Callable[[], None] | None:
    """Raise what the name says; give back what cannot be sent."""
    if kind == "user":
        raise UserError("the nose is too long")
    if kind == "defect":
        raise ZeroDivisionError("one by zero")
    if kind == "disk":
        raise OSError(28, "No space left on device")
    return lambda: None


def talk(word: str) -> None:
    """Print in every way there is."""
    print(f"{word} by Python")
    print(f"{word} as an error", file=sys.stderr)
    os.write(1, f"{word} by a library\n".encode())
    subprocess.run([sys.executable, "-c", f"print('{word} by a child')"], check=True)


def write_slowly(target: Path) -> None:
    """Write a file for ever; its folder tells that it has begun."""
    with written_atomically(target) as part:
        part.write_text("half")
        while True:
            time.sleep(0.01)


def write_in_steps(target: Path) -> int:
    """Write a file in a second, and return whose work it is."""
    with written_atomically(target) as part:
        part.write_text("half")
        time.sleep(1.0)
        part.write_text(f"whole {target.name}")
    with target.with_suffix(".times").open("a") as times:
        times.write("once\n")
    return os.getpid()
