"""The three sentences of docs/architecture.md, as far as imports can tell."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.as_installed import lay

ROOT = Path(__file__).parents[1]


def test_import_rules(tmp_path: Path) -> None:
    """The four packages never import each other, nor the application."""
    lay(tmp_path)
    lint = Path(sys.executable).with_name("lint-imports")
    result = subprocess.run(
        [str(lint), "--no-cache", "--config", str(ROOT / "pyproject.toml")],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize(
    ("package", "banned"),
    [
        ("refine", {"moderngl", "glfw", "trimesh"}),
        ("sim", {"moderngl", "glfw"}),
        ("assets", {"moderngl", "glfw", "numba"}),
        ("render", {"numba"}),
    ],
)
def test_fresh_import(package: str, banned: set[str]) -> None:
    """In a fresh interpreter a package brings none of its neighbours with it."""
    code = f"import sys; from risorius import {package}; print(*sys.modules)"
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    modules = {name.removeprefix("risorius.").partition(".")[0] for name in result.stdout.split()}
    assert package in modules
    neighbours = {"app", "assets", "bench", "refine", "render", "sim"} - {package}
    assert not modules & (banned | neighbours)
