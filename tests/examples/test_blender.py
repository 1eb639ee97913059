"""The add-on in Blender: needs bpy, or a Python that has it, named by RISORIUS_BLENDER_PYTHON."""

import ast
import json
import os
import subprocess
import sys
import tomllib
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.as_installed import lay

EXAMPLES = Path(__file__).parents[2] / "examples" / "blender"
OWN_PYTHON = sys.executable if find_spec("bpy") else ""
BLENDER_PYTHON = os.environ.get("RISORIUS_BLENDER_PYTHON", OWN_PYTHON)


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The results of in_blender.py."""
    if not BLENDER_PYTHON:
        pytest.skip("no bpy; RISORIUS_BLENDER_PYTHON may name a Python that has it")
    folder = tmp_path_factory.mktemp("blender")
    lay(folder / "lib")
    program = Path(__file__).with_name("in_blender.py")
    environment = {**os.environ, "PYTHONPATH": str(folder / "lib")}
    environment["BLENDER_USER_RESOURCES"] = str(folder / "blender")
    ended = subprocess.run(
        [BLENDER_PYTHON, str(program), str(folder)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    lines = [line for line in ended.stdout.splitlines() if line.startswith("SEEN ")]
    assert ended.returncode == 0 and lines, ended.stdout + ended.stderr
    assert "Traceback" not in ended.stderr
    return json.loads(lines[0].removeprefix("SEEN "))


@pytest.mark.blender
def test_it_follows_the_source(seen):
    """In 50 frames triangles are added and removed; they equal the refiner's to the last bit."""
    assert len(set(seen["triangles"])) > 5
    assert min(seen["triangles"]) > 338
    assert seen["others"] == seen["invalid"] == 0
    assert seen["off"] == 0.0
    assert seen["normals_off"] < 1e-5
    assert not seen["problem"]


@pytest.mark.blender
def test_numbers_of_points_go_along(seen):
    """Numbers that change in every frame are refined; new points have interpolated values."""
    assert seen["heat_off"] < 1e-5


@pytest.mark.blender
def test_the_copy_looks_like_its_source(seen):
    """The copy has the source's place, face materials and active UV map.

    The source is hidden in renders.
    """
    assert seen["finished"] == ["FINISHED"]
    assert seen["hidden"]
    assert not seen["again"]
    assert seen["materials"] == ["skin", "cloth"]
    assert seen["uv_shown"] == "Second"
    assert seen["uv_off"] < 0.02  # cubic curves move points along the sheet, too
    np.testing.assert_array_equal(*seen["world"])


@pytest.mark.blender
def test_settings(seen):
    """Settings take effect at once: each look splits other edges."""
    assert seen["paper"] > 338
    assert seen["unblended"] > 338
    assert seen["paper"] != seen["unblended"]


@pytest.mark.blender
def test_one_topology_for_the_frame_range(seen):
    """All frames of the range get the same triangles, at least as many as any frame needs.

    A second operator gives each frame its own triangles again.
    """
    assert seen["kept"] == seen["let_go"] == ["FINISHED"]
    assert seen["kept_at"] == 11
    assert len(set(seen["kept_triangles"])) == len(set(seen["kept_corners"])) == 1
    assert seen["kept_triangles"][0] >= max(seen["triangles_there"])
    assert seen["kept_off"] == 0.0


@pytest.mark.blender
def test_renders_files_and_undo(seen):
    """A rendered film, and a file opened again, have the triangles of each frame."""
    assert seen["rendered"] == seen["triangles_there"]
    assert len(set(seen["rendered"])) > 2
    assert seen["after_loading"] == seen["triangles_there"][2]
    assert seen["other_mesh"] == "The source has other vertices or faces than at rest"
    assert seen["mended"] == ["", seen["triangles_there"][2]]
    undone, redone = seen["steps"]
    assert undone == ["SMOOTH", seen["triangles_there"][2]]
    assert redone[0] == "PAPER"
    assert redone[1] != undone[1]
    assert not seen["registered"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("version", "python", "beyond"), [("5.2", "cp313", "5.3.0"), ("5.0", "cp311", "5.1.0")]
)
def test_the_zip_has_all_that_it_needs(tmp_path, version, python, beyond):
    """In the package for Linux, the manifest names each bundled wheel; Blender accepts it."""
    target = tmp_path / "a new folder"
    build = [sys.executable, EXAMPLES / "build.py", "--blender", version, "linux-x64", target]
    subprocess.run(build, check=True, capture_output=True)
    (file,) = target.iterdir()
    with zipfile.ZipFile(file) as archive:
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        names = set(archive.namelist())
    wheels = {f"./{name}" for name in names if name.startswith("wheels/")}
    assert set(manifest["wheels"]) == wheels
    assert {Path(wheel).name.partition("-")[0] for wheel in wheels} == {
        *("risorius", "numba", "llvmlite")
    }
    assert all(python in wheel for wheel in wheels if "risorius" not in wheel)
    assert manifest["platforms"] == ["linux-x64"]
    assert manifest["blender_version_min"] == f"{version}.0"
    assert manifest["blender_version_max"] == beyond
    assert names - {wheel.removeprefix("./") for wheel in wheels} == {
        *("__init__.py", "blender_manifest.toml")
    }
    if BLENDER_PYTHON:
        find = "import bpy; print(bpy.utils.resource_path('LOCAL'))"
        message = subprocess.run(
            [BLENDER_PYTHON, "-c", find], capture_output=True, text=True, check=True
        )
        (judge,) = Path(message.stdout.strip()).rglob("blender_ext.py")
        subprocess.run([BLENDER_PYTHON, judge, "validate", file], check=True, capture_output=True)


def test_the_manifest_keeps_the_rules():
    """The manifest has the package's version, a short tagline, and asks for no network access."""
    import risorius

    manifest = tomllib.loads(
        (EXAMPLES / "risorius_refine" / "blender_manifest.toml").read_text(encoding="utf-8")
    )
    assert manifest["schema_version"] == "1.0.0"
    assert manifest["id"] == "risorius_refine"
    assert manifest["version"] == risorius.__version__
    assert len(manifest["tagline"]) <= 64
    assert not manifest["tagline"].endswith(".")
    assert set(manifest["permissions"]) == {"files"}
    assert manifest["license"] == ["SPDX:MIT"]


def test_every_setting_of_the_looks_is_an_option():
    """The refiner accepts every option of the add-on's looks; this needs no Blender."""
    from risorius import refine

    source = (EXAMPLES / "risorius_refine" / "__init__.py").read_text(encoding="utf-8")
    (looks,) = [
        node.value
        for node in ast.parse(source).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "LOOK_OPTIONS"
    ]
    for options in ast.literal_eval(looks).values():
        refine.create("kahler", [[0, 1, 2]], [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], **options)
