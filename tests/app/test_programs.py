"""The programs beside the command obey the rules of the command."""

from __future__ import annotations

import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    ("program", "words", "told"),
    [
        ("sheet", ["/dev/null/x"], "risorius: /dev/null/x/action_units.png: cannot be written"),
        ("portraits", ["/dev/null/x"], "risorius: /dev/null/x/head_views.png: cannot be"),
        ("refinement_figures", ["/dev/null/x"], "risorius: /dev/null/x/refine_cases.png: can"),
        ("sheet", ["--only", "AU127"], "risorius: unknown control 'AU127'"),
        ("sheet", ["--width", "99999"], "error: argument --width: '99999' is no width; write"),
        ("portraits", ["--width", "0"], "argument --width: '0' is no width; write 16 to 8192"),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="paths of POSIX systems")
@pytest.mark.slow
def test_mistakes_are_told(program: str, words: list[str], told: str) -> None:
    """What cannot be drawn or written is told in one line, before anything is drawn."""
    ended = subprocess.run(
        [sys.executable, "-m", f"risorius.app.{program}", *words],
        capture_output=True,
        text=True,
        check=False,
    )
    lines = [line for line in ended.stderr.splitlines() if not line.startswith("Compiling")]
    assert ended.returncode == 2
    assert told in lines[-1]
    assert len(lines) == 1 or lines[0].startswith("usage: python -m risorius.app.")
