"""The command as a process: stopped, hung up, piped into nothing, without streams or memory."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

COMMAND = (sys.executable, "-m", "app")
SLOW = ("capture", "--scene", "face", "--size", "320x240", "--samples", "0")


def wait_for_output(folder: Path, process: subprocess.Popen[bytes]) -> None:
    """Until something is being written."""
    for _ in range(1200):
        if any(folder.iterdir()) or process.poll() is not None:
            return
        time.sleep(0.05)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
@pytest.mark.parametrize("output", ["film.mp4", "frames"])
@pytest.mark.parametrize(
    ("number", "code", "words"),
    [(signal.SIGINT, 130, b"risorius: stopped"), (signal.SIGHUP, 129, b"")],
)
def test_nothing_half_written_is_left(
    tmp_path: Path, output: str, number: signal.Signals, code: int, words: bytes
) -> None:
    """Ctrl-C, or a closed terminal, in the middle of a film or of frames."""
    process = subprocess.Popen(
        [*COMMAND, *SLOW, "-o", str(tmp_path / output), "--quiet"],
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    wait_for_output(tmp_path, process)
    os.killpg(process.pid, number)
    _, told = process.communicate(timeout=60)
    assert process.returncode == code
    # The first start on a machine also says that it compiles.
    lines = [line for line in told.splitlines() if not line.startswith(b"Compiling")]
    assert lines == ([words] if words else [])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="a POSIX shell")
def test_missing_streams_are_no_error(tmp_path: Path) -> None:
    """Nobody reads the output, or there is no stream at all: no traceback, and the picture."""
    python = f"{sys.executable} -m app"
    piped = subprocess.run(
        f"{python} controls | true", shell=True, capture_output=True, text=True, check=False
    )
    assert piped.stderr == ""
    target = tmp_path / "joy.png"
    closed = subprocess.run(
        f"{python} capture --set joy -o {target} --size 64x64 <&- >&- 2>&-", shell=True, check=False
    )
    assert closed.returncode == 0 and target.stat().st_size > 1000
