"""The three rules of docs/architecture.md, as far as imports show them, and limits of size."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from .tracked import tracked

ROOT = Path(__file__).parents[1]
FOLDERS = (
    *("app", "assets", "bench", "docs", "examples"),
    *("refine", "refine_gl", "render", "risorius", "sim"),
)
LONGEST_FILE = 400  # [lines]
LONGEST_FUNCTION = 60  # [lines]


@pytest.mark.parametrize(
    ("package", "banned"),
    [
        ("refine", {"moderngl", "glfw", "pyvista", "trimesh"}),
        ("sim", {"moderngl", "glfw"}),
        ("assets", {"moderngl", "glfw", "numba"}),
        ("render", {"numba"}),
    ],
)
def test_fresh_import(package, banned):
    """In a fresh interpreter a package imports none of its neighbours."""
    code = f"import sys; from risorius import {package}; print(*sys.modules)"
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    modules = {name.removeprefix("risorius.").partition(".")[0] for name in result.stdout.split()}
    assert package in modules
    neighbours = {"app", "assets", "bench", "refine", "refine_gl", "render", "sim"} - {package}
    assert not modules & (banned | neighbours)


def test_no_other_code_tests_the_kind_of_a_scene():
    """Outside app/scenes no code tests the class of a scene, or derives a class of scenes."""
    asked = []
    made = []
    for folder in ("app", "bench", "docs", "examples"):
        for path in tracked(folder, "*.py"):
            if "app/scenes" in path.as_posix():
                continue
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance":
                    asked += [path.name] * ("Scene" in ast.unparse(node.args[1]))
                if isinstance(node, ast.ClassDef):
                    bases = {ast.unparse(base) for base in node.bases}
                    kinds = {"Drawable", "FaceScene", "PlaneScene", "Scene"}
                    made += [path.name] * bool(bases & kinds)
    assert not asked
    assert not made


@pytest.mark.parametrize(
    ("folder", "allowed"),
    [
        (
            "risorius",
            {"PIL", "click", "numba", "numpy", "pydantic", "pydantic_core", "pyvista", "scipy"}
            | {"risorius", "tqdm"},
        ),
        ("refine", {"numpy"}),
        ("refine_gl", {"moderngl", "numpy", "risorius"}),
        ("sim", {"numpy", "scipy"}),
        ("render", {"glfw", "moderngl", "numpy", "pyrr"}),
        ("assets", {"PIL", "fast_simplification", "numpy", "pygltflib", "scipy", "trimesh"}),
    ],
)
def test_packages_import_only_what_they_may(folder, allowed):
    """Each package imports only its allowed dependencies, also within functions.

    Below `app/`, imports of our own modules are relative.
    """
    found = {
        name.partition(".")[0]
        for path in tracked(folder, "*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        for name in _imported(node)
    }
    assert found - sys.stdlib_module_names == allowed


def _imported(node):
    """Names of the modules that a statement imports, without relative imports."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom) and node.level == 0:
        return [str(node.module)]
    return []


def test_files_and_functions_are_short():
    """No file outside tests has more than LONGEST_FILE lines, no function more than its limit."""
    sources = [path for folder in FOLDERS for path in tracked(folder, "*.py")]
    assert len(sources) > 100
    long = {
        str(path.relative_to(ROOT)) for path in sources if _is_too_long(path.read_text("utf-8"))
    }
    assert not long


def _is_too_long(source):
    """Whether a file or one of its functions has too many lines."""
    functions = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.FunctionDef)]
    lengths = [(node.end_lineno or 0) - node.lineno + 1 for node in functions]
    return source.count("\n") > LONGEST_FILE or max(lengths, default=0) > LONGEST_FUNCTION
