"""Imports of commands: only those their work needs, so that commands start quickly."""

import os
import subprocess
import sys

MODULES_PROGRAM = """
import contextlib, sys
from risorius.__main__ import command
with contextlib.suppress(SystemExit):
    command()(sys.argv[1:])
print("loaded:", *sys.modules)
"""


def loaded_by(*words, cache, program=MODULES_PROGRAM):
    """Packages that a command imports, the project's as two words; `cache`: compiled code."""
    result = subprocess.run(
        [sys.executable, "-c", program, *words],
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=True,
    )
    modules = result.stdout.rpartition("loaded: ")[2].split()
    packages = set()
    for module in modules:
        words = module.split(".")
        packages.add(".".join(words[:2]) if words[0] == "risorius" else words[0])
    return packages


def test_help_loads_no_library_but_click(tmp_path):
    """The help of all commands, and of each, imports no library but click."""
    slow = {"PIL", "moderngl", "numba", "numpy", "pydantic", "risorius.assets", "scipy", "tqdm"}
    for words in (("--help",), ("capture", "--help"), ("reproduce", "--help")):
        assert not loaded_by(*words, cache=tmp_path) & slow, words


def test_controls_compiles_nothing(tmp_path):
    """The list of controls reads a head and its rig: no picture, refiner or simulation."""
    drawing = {"PIL", "moderngl", "glfw", "risorius.render", "risorius.refine", "trimesh"}
    assert not loaded_by("controls", cache=tmp_path) & drawing
    assert not list(tmp_path.rglob("*.nbc"))


def test_doctor_simulates_nothing(tmp_path):
    """The report on the machine needs OpenGL and names of refiners: no head, no script."""
    loaded = loaded_by("doctor", cache=tmp_path)
    assert not loaded & {"risorius.sim", "risorius.assets", "pydantic", "trimesh"}
    assert not list(tmp_path.rglob("*.nbc"))


def test_a_worker_starts_without_its_work(tmp_path):
    """A worker imports what its work needs later; it loaded heads and numba to count frames."""
    program = "import sys, risorius.app.workers; print('loaded:', *sys.modules)"
    loaded = loaded_by(cache=tmp_path, program=program)
    assert not loaded & {"numba", "numpy", "risorius.assets", "risorius.sim", "scipy"}


def test_lights_of_maps_are_computed_when_they_are_read(tmp_path):
    """The package that draws starts without the light of any map, and has the names of all."""
    program = (
        "from risorius.render import LIGHT_MAPS, LIGHTS\n"
        "print('loaded:', *LIGHTS, *(name for each in LIGHT_MAPS.values() for name in vars(each)))"
    )
    assert loaded_by(cache=tmp_path, program=program) > {"street", "radiance"}
    assert "_gathered" not in loaded_by(cache=tmp_path, program=program)
