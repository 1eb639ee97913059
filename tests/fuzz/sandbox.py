"""A working folder with hostile files, and the rules for how every command must end."""

import os
import re
import resource
import signal
import time
import wave
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from click.testing import CliRunner

from risorius.__main__ import command

LONGEST_RUN = 60.0  # [s] on a busy machine with compilation; the slowest takes 2 s otherwise
MOST_MEMORY = 600 << 20  # [bytes] above the memory before the input
MEMORY_LIMIT = 8 << 30  # [bytes] of address space; the system refuses larger requests
LONGEST_LINE = 2200  # [characters]; names are shortened, and explanations need no more
STATUS_FILE = Path("/proc/self/status")

GOOD_SCRIPT = """
[[pose]]
time = 0.0
[[pose]]
time = 0.2
name = "joy"
joy = 1.0
"""


class TookTooLong(BaseException):
    """An input kept the program busy, or waiting, for too long.

    It is a BaseException, so that no `except Exception` in the program catches it.
    """


@dataclass(frozen=True)
class Ended:
    """How a command ended: exit code and both outputs."""

    code: int
    out: str
    err: str


def put_files(folder: Path) -> None:
    """Put good files and hostile files of every kind into a folder."""
    (folder / "good.toml").write_text(GOOD_SCRIPT)
    (folder / "notes.txt").write_text("mine")
    (folder / "keep.png").write_text("mine")
    with wave.open(str(folder / "hum.wav"), "wb") as sound:
        sound.setparams((1, 2, 8000, 0, "NONE", ""))
        sound.writeframes(bytes(range(256)) * 30)
    (folder / "head.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (folder / "marks.json").write_text('{"landmarks": [0, 1, 2]}')
    (folder / "take.csv").write_text("time,jawOpen\n0,0\n0.1,0.5\n0.2,0\n")
    (folder / "folder").mkdir()
    (folder / "broken").mkdir()
    (folder / "broken" / "face.png").write_text("no picture")
    (folder / "folder.png").mkdir()
    (folder / "full").mkdir()
    (folder / "full" / "mine.txt").write_text("mine")
    for name in ("pipe", "pipe.png", "pipe.toml"):
        os.mkfifo(folder / name)
    for name in ("loop", "loop.png", "loop.toml"):
        (folder / name).symlink_to(name)
    (folder / "dangling.png").symlink_to("nowhere/at/all.png")
    (folder / "zeros.toml").symlink_to("/dev/zero")


def contents(folder: Path) -> dict[str, str]:
    """Every name in a folder with its content, link target or kind."""
    found = {}
    for parent, folders, names in os.walk(folder):
        for name in (*folders, *names):
            path = Path(parent) / name
            if path.is_symlink():
                what = f"link to {os.readlink(path)}"
            elif path.is_file():
                what = path.read_bytes().hex()
            else:
                what = "folder" if path.is_dir() else "device"
            found[str(path.relative_to(folder))] = what
    return found


@contextmanager
def bounded(seconds: float = LONGEST_RUN, memory: int = MOST_MEMORY) -> Iterator[None]:
    """Fail if the work takes too long, never ends, or takes too much memory."""

    def stop(*_: object) -> None:
        raise TookTooLong(f"more than {seconds:g} s")

    if STATUS_FILE.exists():
        Path("/proc/self/clear_refs").write_text("5")  # the peak is measured from this point on
    before = _kilobytes("VmHWM")
    limits = resource.getrlimit(resource.RLIMIT_AS)
    handler = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds, 1.0)
    start = time.monotonic()
    try:
        if STATUS_FILE.exists():
            resource.setrlimit(
                resource.RLIMIT_AS, (1024 * _kilobytes("VmSize") + MEMORY_LIMIT, limits[1])
            )
        yield
    except TookTooLong as error:
        raise AssertionError(str(error)) from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, handler)
        resource.setrlimit(resource.RLIMIT_AS, limits)
    assert time.monotonic() - start < seconds
    assert 1024 * (_kilobytes("VmHWM") - before) < memory


def _kilobytes(name: str) -> int:
    """A memory figure of this process [kB]; 0 if the system has no such figure."""
    if not STATUS_FILE.exists():
        return 0
    found = re.search(rf"{name}:\s+(\d+) kB", STATUS_FILE.read_text())
    return int(found[1]) if found else 0


def run_command(arguments: tuple[str, ...]) -> Ended:
    """Run the command in this process, within the limits.

    Errors that it does not handle pass through.
    """
    with bounded():
        result = CliRunner(catch_exceptions=False).invoke(command(), arguments)
    return Ended(result.exit_code, result.stdout, result.stderr)


def check_line(text: str) -> None:
    """Check that a message is one line of limited length, without control codes."""
    assert text.isprintable(), text
    assert 10 < len(text) < LONGEST_LINE, len(text)


def check_end(ended: Ended, folder: Path, before: dict[str, str]) -> None:
    """Check for success, or for one clear line with exit code 2 and unchanged files."""
    assert "Traceback" not in ended.err
    after = contents(folder)
    assert not [name for name in after if ".risorius-" in name]
    assert {name: after.get(name) for name in before} == before
    if ended.code == 0:
        return
    assert ended.code == 2, ended
    assert after == before, "something is left behind"
    lines = [line for line in ended.err.splitlines() if not line.startswith("Compiling")]
    if "Usage: " in ended.err:  # a group without a command shows its help
        return
    assert len(lines) == 1, ended.err
    assert lines[0].startswith("risorius: ")
    check_line(lines[0])
