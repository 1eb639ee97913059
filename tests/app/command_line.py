"""Run the command in this process, read its refusals, and read files with Blender."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from risorius.__main__ import command


def report_lines(text: str) -> dict[str, str]:
    """The lines "name: words" of a report, by name."""
    return dict(line.split(": ", 1) for line in text.splitlines() if ": " in line)


def risorius(*arguments: object) -> Result:
    """Run the command in this process."""
    return CliRunner().invoke(command(), [str(argument) for argument in arguments])


def succeeded(*arguments: object) -> str:
    """The output of the command; the test fails unless the command succeeds."""
    result = risorius(*arguments)
    assert result.exit_code == 0, result.output
    return result.output


def refusal(result: Result) -> str:
    """The single error line of a refused command, without a line about compilation."""
    assert result.exit_code == 2, result.output
    lines = [line for line in result.output.splitlines() if not line.startswith("Compiling, ")]
    assert len(lines) == 1 and lines[0].startswith("risorius: "), result.output
    return lines[0]


def started(*words: object, **options: Any) -> subprocess.Popen[bytes]:
    """Start Python with these words as a process that receives signals in every shell.

    Processes started behind `&` or `nohup` ignore signals, and so would their children. The output
    is kept.
    """

    def hear() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGHUP, signal.SIG_DFL)

    command = [sys.executable, *map(str, words)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, preexec_fn=hear, **options)


def positions_in_blender(path: Path, folder: Path, rate: float, frames: int) -> Path:
    """Positions of a file's vertices by frame, as Blender has them (.npz); skips without bpy."""
    found = folder / "found.npz"
    _in_blender("positions_in_blender.py", path, found, f"{rate:g}", frames)
    return found


def shape_keys_in_blender(path: Path, folder: Path) -> Path:
    """The shape keys of a file, as Blender has them (.npz); skips without bpy."""
    found = folder / "keys.npz"
    _in_blender("shape_keys_in_blender.py", path, found)
    return found


def _in_blender(program: str, *arguments: object) -> None:
    """Run a program of this folder in a Python with bpy; skip the test without it."""
    python = os.environ.get("RISORIUS_BLENDER_PYTHON", sys.executable)
    if subprocess.run([python, "-c", "import bpy"], capture_output=True, check=False).returncode:
        pytest.skip("no bpy; RISORIUS_BLENDER_PYTHON may name a Python that has it")
    command = [python, Path(__file__).with_name(program), *map(str, arguments)]
    subprocess.run(command, check=True, capture_output=True)
