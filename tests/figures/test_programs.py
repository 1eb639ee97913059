"""The programs that draw the documentation obey the rules of the command."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAMS = Path(__file__).parents[2] / "docs" / "figures"


@pytest.mark.parametrize(
    ("program", "arguments", "told"),
    [
        ("controls", ["/dev/null/x"], "risorius: /dev/null/x/action_units.webp: cannot be written"),
        ("head", ["/dev/null/x"], "risorius: /dev/null/x/head_views.webp: cannot be"),
        ("refinement", ["/dev/null/x"], "risorius: /dev/null/x/refine_cases.webp: can"),
        ("controls", ["--only", "AU127"], "risorius: there is no control called 'AU127'"),
        ("head", ["--only", "foot"], "risorius: unknown figure 'foot'; there are head_views, "),
        ("controls", ["--width", "99999"], "error: argument --width: '99999' is no width; write"),
        ("head", ["--width", "0"], "argument --width: '0' is no width; write 16 to 8192"),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="paths of POSIX systems")
@pytest.mark.slow
def test_mistakes_are_told(program: str, arguments: list[str], told: str, tmp_path: Path) -> None:
    """What cannot be drawn or written is told in one line, before anything is drawn."""
    ended = subprocess.run(
        [sys.executable, PROGRAMS / f"{program}.py", *arguments],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    lines = [line for line in ended.stderr.splitlines() if not line.startswith("Compiling")]
    assert ended.returncode == 2
    assert told in lines[-1]
    assert len(lines) == 1 or lines[0].startswith(f"usage: {program}.py")
