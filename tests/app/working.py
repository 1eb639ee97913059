"""Work for the processes in tests of `app/workers.py`."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from risorius.app.errors import UserError
from risorius.app.files import written_atomically
from risorius.app.workers import Send


def double(numbers: list[int], send: Send) -> None:
    """Twice each number, and the process that computed it."""
    for number in numbers:
        send((2 * number, os.getpid()))


def library_threads(send: Send) -> None:
    """The number of threads allowed for software OpenGL."""
    send(os.environ.get("LP_NUM_THREADS"))


def die_once(mark: Path, send: Send) -> None:
    """Die in the first call, when a file is almost complete."""
    with written_atomically(mark.with_suffix(".txt")) as part:
        part.write_text("whole")
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    send(mark.name)


def die(send: Send) -> None:
    """Die in every call by a crash."""
    os.kill(os.getpid(), signal.SIGSEGV)


def fail(kind: str, send: Send) -> None:
    """Raise the named error, or return an object that cannot be sent."""
    if kind == "user":
        raise UserError("the nose is too long")
    if kind == "defect":
        raise ZeroDivisionError("one by zero")
    if kind == "disk":
        raise OSError(28, "No space left on device")
    send(lambda: None)


def talk(word: str, send: Send) -> None:
    """Print in every possible way."""
    print(f"{word} by Python", flush=True)
    print(f"{word} as an error", file=sys.stderr)
    os.write(1, f"{word} by a library\n".encode())
    subprocess.run([sys.executable, "-c", f"print('{word} by a child')"], check=True)


def write_slowly(target: Path, send: Send) -> None:
    """Write a file without end; its folder shows that writing has begun."""
    with written_atomically(target) as part:
        part.write_text("half")
        while True:
            time.sleep(0.01)
