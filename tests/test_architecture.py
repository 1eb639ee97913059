"""The three sentences of docs/architecture.md, as far as imports can tell."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def test_import_rules() -> None:
    """The four packages never import each other, nor the application."""
    lint = Path(sys.executable).with_name("lint-imports")
    result = subprocess.run(
        [str(lint), "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize(
    ("package", "banned"),
    [
        ("refine", {"sim", "render", "assets", "app", "moderngl", "glfw", "trimesh"}),
        ("sim", {"refine", "render", "assets", "app", "moderngl", "glfw"}),
        ("assets", {"refine", "render", "sim", "app", "moderngl", "glfw", "numba"}),
        ("render", {"refine", "sim", "assets", "app", "numba"}),
    ],
)
def test_fresh_import(package: str, banned: set[str]) -> None:
    """In a fresh interpreter a package brings none of its neighbours with it."""
    code = (
        f"import sys, {package}; "
        f"print(*sorted({banned!r} & {{name.partition('.')[0] for name in sys.modules}}))"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert result.stdout.split() == []
