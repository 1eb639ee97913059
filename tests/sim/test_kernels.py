"""Compiled code must not outlive the source that it came from."""

from __future__ import annotations

import ast
import builtins
from pathlib import Path

import pytest

import sim

MODULES = sorted(Path(sim.__file__).parent.glob("*.py"))


def _kernels(tree: ast.Module) -> list[ast.FunctionDef]:
    """Functions decorated with numba.njit."""
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    return [f for f in functions if any("njit" in ast.dump(d) for d in f.decorator_list)]


def test_there_are_kernels_to_check() -> None:
    """The search for kernels finds them."""
    found = [k for path in MODULES for k in _kernels(ast.parse(path.read_text("utf-8")))]
    assert len(found) >= 12


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_kernels_use_their_own_file_only(path: Path) -> None:
    """Numba's cache knows one file: a kernel that uses another file's code would go stale."""
    tree = ast.parse(path.read_text("utf-8"))
    imported = {
        (alias.asname or alias.name): node
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    for kernel in _kernels(tree):
        names = {node.id for node in ast.walk(kernel) if isinstance(node, ast.Name)}
        foreign = {name for name in names & set(imported) if name not in vars(builtins)}
        assert not foreign, f"{path.name}: {kernel.name} uses {sorted(foreign)} of another file"
