"""What is said while kernels are compiled, and that `risorius warm` compiles all of them."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

COMMANDS = (
    "capture --set joy",
    "capture --set joy --option scheme=detail --option criterion=displacement",
    "capture --set joy --option criterion=silhouette+curvature+border",
    "capture --set joy --option coherent=on",
    "capture --set joy --option blend=on --option criterion=normal",
    "capture --set joy --refiner loop --option levels=2",
    "capture --set amplitude=1 --scene plane --compare",
)
PROGRAM = """
import sys
from risorius.__main__ import command
for words in eval(sys.argv[1]):
    command()(words, standalone_mode=False)
"""


@pytest.mark.slow
def test_nothing_is_left_to_compile_after_warm(tmp_path: Path) -> None:
    """Whatever is drawn afterwards finds its machine code on disk."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}

    def run(*commands: str) -> None:
        words = [command.split() for command in commands]
        result = subprocess.run(
            [sys.executable, "-c", PROGRAM, repr(words)],
            env=environment,
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert result.returncode == 0, result.stderr
        assert "Compiling" not in result.stderr

    run("warm --quiet")
    compiled = sorted((tmp_path / "cache").rglob("*.nbc"))
    assert len(compiled) > 50
    run(*(f"{each} --quiet --size 64x64 -o {tmp_path}/{k}.png" for k, each in enumerate(COMMANDS)))
    assert sorted((tmp_path / "cache").rglob("*.nbc")) == compiled
