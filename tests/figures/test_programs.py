"""The programs that draw the documentation obey the rules of the command."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import refinement

PROGRAMS = Path(__file__).parents[2] / "docs" / "figures"


@pytest.mark.parametrize(
    ("program", "arguments", "told"),
    [
        ("controls", ["/dev/null/x"], "risorius: /dev/null/x/action_units.webp: cannot be written"),
        ("head", ["--only", "foot"], "risorius: unknown figure 'foot'; there are head_views, "),
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
    assert ended.returncode == 2
    assert told in ended.stderr and ended.stderr.count("\n") == 1


def test_line_drawings() -> None:
    """There is ink on each of the page on refinement."""
    for figure in (refinement.cases, refinement.lookup):
        assert 0.01 < (figure().min(axis=2) < 128).mean() < 0.8
    assert np.array_equal(refinement.cases(), refinement.cases())
