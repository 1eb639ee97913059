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


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
@pytest.mark.parametrize("output", ["film.mp4", "frames"])
@pytest.mark.parametrize(
    ("number", "code", "words"),
    [(signal.SIGINT, 130, b"risorius: stopped"), (signal.SIGHUP, 129, b"")],
)
def test_nothing_half_written_is_left(
    tmp_path: Path, output: str, number: signal.Signals, code: int, words: bytes
) -> None:
    """Ctrl-C, or a closed terminal, while a film or frames are begun and while they are written."""
    target = tmp_path / output
    for pattern in (
        "*",  # the place is tried: OpenGL is set up next
        "**/*.png" if output == "frames" else "**/film.mp4",
    ):
        process = subprocess.Popen(
            [*COMMAND, *SLOW, "-o", str(target), "--quiet"],
            stderr=subprocess.PIPE,
            start_new_session=True,
            # Tests that run behind an `&` or `nohup` have the signals ignored, and pass that on.
            preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),
        )
        while process.poll() is None and not any(tmp_path.glob(pattern)):
            time.sleep(0.01)
        os.killpg(process.pid, number)
        _, told = process.communicate(timeout=60)
        assert process.returncode == code
        # The first start on a machine also says that it compiles.
        lines = [line for line in told.splitlines() if not line.startswith(b"Compiling")]
        assert lines == ([words] if words else [])
        assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
def test_a_signal_is_heard_where_errors_are_dropped() -> None:
    """C code that calls Python and ignores what it raises does not lose the signal."""
    code = (
        "import ctypes, signal\nfrom app.stopping import cleaned_up_if_stopped, listen\nlisten()\n"
        "callback = ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGTERM))\n"
        "cleanups = lambda: print('clean'), lambda: 1 / 0\n"
        "with cleaned_up_if_stopped(cleanups[0]), cleaned_up_if_stopped(cleanups[1]):\n"
        "    callback()\nprint('went on')"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (143, "clean\n", "")


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
