"""Every program in examples/ runs, and does what its first lines say."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from risorius import refine
from risorius.app.dataset.making import make_set
from risorius.app.dataset.request import request_of
from tests.tracked import tracked

FOLDER = Path(__file__).parents[2] / "examples"


def example(name: str) -> ModuleType:
    """Import a program without running it."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_example_is_tested():
    """A new program in the folder needs a test here."""
    found = {path.stem for path in tracked(FOLDER, "*.py") if path.parent == FOLDER}
    assert found == {"plain_script", "own_refiner", "read_dataset", "in_mujoco", "in_newton"}


@pytest.mark.slow
@pytest.mark.parametrize("library", ["mujoco", "newton"])
def test_a_fine_mesh_on_a_coarse_cloth(library):
    """The embedding is nearer to the finer simulation than the library's own flat binding.

    No carried mesh can be nearer than the coarse vertices themselves are, but for a little.
    """
    pytest.importorskip(library, reason=f"needs the extra '{library}'")
    flat, ours, least = example(f"in_{library}").main().values()
    assert 0.9 * least < ours < 0.8 * flat
    assert flat < 20.0  # mm, of a sheet that is 2 m wide


def test_plain_script(tmp_path):
    """As a user starts it: triangles grow with the bend, and the file has them."""
    target = tmp_path / "tube.obj"
    result = subprocess.run(
        [sys.executable, str(FOLDER / "plain_script.py"), str(target)],
        cwd=FOLDER.parent,
        env={"PYTHONPATH": str(FOLDER.parent)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert result.stdout.startswith("384 triangles at rest")
    lines = target.read_text(encoding="utf-8").splitlines()
    assert sum(line.startswith("f ") for line in lines) > 384
    assert sum(line.startswith("v ") for line in lines) > 204


@pytest.mark.usefixtures("own_refiners")
def test_own_refiner():
    """A refiner from outside is registered, known by name, passes the checker, and cuts in four."""
    assert "quarters" not in refine.refiners.available()
    module = example("own_refiner")
    assert module.main() == [8, 8, 32, 32]
    assert "quarters" in refine.refiners.available()
    assert isinstance(
        module.Quarters([[0, 1, 2]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]]), refine.Refiner
    )
    with pytest.raises(ValueError, match="takes \\['attributes', 'crease_angle', 'longest'\\]"):
        refine.create("quarters", [[0, 1, 2]], [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], level=3)


@pytest.mark.slow
def test_read_dataset(tmp_path):
    """As a user starts it: nobody is both in training and in testing."""
    request = request_of(tmp_path, seed=1, size=(48, 40), passes=("segmentation",))
    make_set(request, 4, progress=False)
    result = subprocess.run(
        [sys.executable, str(FOLDER / "read_dataset.py"), str(tmp_path)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert result.stdout.startswith("3 samples to train with, 1 to test with")
    assert len(result.stdout.splitlines()) == 13
