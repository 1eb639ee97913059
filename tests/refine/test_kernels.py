"""Rules for compiled code."""

from __future__ import annotations

import ast
import importlib
from pathlib import Path

import pytest

import refine
from refine import masks, normals, output
from refine.kernels import Compiled, Kernel
from refine.lanes import Instruction

FOLDER = Path(refine.__file__).parent
MODULES = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem != "__init__")


def imported_names(tree: ast.Module) -> set[str]:
    """Names that a module imports from its own package."""
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom) and node.level]
    return {alias.asname or alias.name for node in imports for alias in node.names}


@pytest.mark.parametrize("name", MODULES)
def test_kernels_stand_alone(name: str) -> None:
    """A kernel freezes nothing of other files: the cache would not notice when they change.

    Native ones may call kernels and instructions of other files: their cache knows of those.
    """
    imported = imported_names(ast.parse((FOLDER / f"{name}.py").read_text(encoding="utf-8")))
    module = importlib.import_module(f"refine.{name}")
    kernels = [value for value in vars(module).values() if isinstance(value, Compiled)]
    for kernel in kernels:
        if kernel.py_func.__module__ == module.__name__:
            frozen = imported & set(kernel.py_func.__code__.co_names)
            if not isinstance(kernel, Kernel):
                covered = Compiled | Instruction
                frozen = {n for n in frozen if not isinstance(vars(module)[n], covered)}
            assert not frozen, f"{kernel.py_func.__name__} freezes {frozen}"


def test_there_are_kernels() -> None:
    """The rule above is not kept by there being nothing it applies to."""
    for kernel in (normals.vertex_normals, masks.place_quarters, output.number_points):
        assert isinstance(kernel, Compiled)
    assert "ONE" in normals.unit.py_func.__code__.co_names
    assert masks.place_vertices.__module__ == "refine.masks"
