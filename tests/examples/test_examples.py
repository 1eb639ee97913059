"""Every program in examples/ runs, with the results that its first lines promise."""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import PIL.Image
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
    """Every program in the folder has a test in this module."""
    found = {path.stem for path in tracked(FOLDER, "*.py") if path.parent == FOLDER}
    assert found == {
        "in_mujoco",
        "in_newton",
        "landmark_faces",
        "own_refiner",
        "plain_script",
        "read_dataset",
        "train_landmarks",
    }


@pytest.mark.slow
@pytest.mark.parametrize("library", ["mujoco", "newton"])
def test_a_fine_mesh_on_a_coarse_cloth(library):
    """The embedding is nearer to the finer simulation than the library's flat binding.

    An embedded mesh can hardly be nearer than the coarse vertices themselves.
    """
    pytest.importorskip(library, reason=f"needs the extra '{library}'")
    flat, ours, least = example(f"in_{library}").main().values()
    assert 0.9 * least < ours < 0.8 * flat
    assert flat < 20.0  # [mm], for a sheet 2 m wide


def test_plain_script(tmp_path):
    """The program makes more triangles where the mesh bends more, and the written file has them."""
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
    """An external refiner is registered, passes the checker, and cuts each triangle in four."""
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
    """The program puts no person into both the training part and the test part."""
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


def test_a_folder_without_a_set_is_named_in_one_line(tmp_path):
    """For a wrong folder the program prints one line without a traceback."""
    result = subprocess.run(
        [sys.executable, str(FOLDER / "read_dataset.py"), str(tmp_path / "fcaes")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 2
    assert "Traceback" not in result.stderr
    assert "fcaes/index.csv: no such index of a data set" in result.stderr


def test_faces_are_cut_out_with_their_points(tmp_path):
    """A photograph and its `.pts` file become one cropped face with its points in place."""
    random = np.random.default_rng(4)
    points = random.uniform([400.0, 350.0], [600.0, 560.0], (68, 2))
    picture = PIL.Image.new("RGB", (1000, 900))
    column, row = np.floor(points[30]).astype(int)
    picture.paste((255, 255, 255), (column - 4, row - 4, column + 5, row + 5))
    picture.save(tmp_path / "face.png")
    rows = "\n".join(f"{x + 0.5} {y + 0.5}" for x, y in points)  # pixel numbers begin at 1
    marks = f"version: 1\nn_points: 68\n{{\n{rows}\n}}\n"
    (tmp_path / "face.pts").write_text(marks, encoding="utf-8")
    by_hand, by_dlib = example("landmark_faces").read_photographs(tmp_path)
    assert (len(by_hand), len(by_dlib)) == (1, 0)
    cut, places = by_hand[0]
    assert cut.shape == (3, 144, 144)
    bright = np.argwhere(cut[0] > 128).mean(axis=0)[::-1] + 0.5
    assert np.allclose((places[30] + 1.0) * 72.0, bright, atol=0.7)


def test_a_face_at_a_corner_is_cut_out_without_black_margins():
    """Margins outside a picture would show a network where the face is, so they are mirrored."""
    random = np.random.default_rng(5)
    points = random.uniform([0.0, 0.0], [40.0, 50.0], (68, 2))
    picture = PIL.Image.new("RGB", (120, 90), (200, 180, 160))
    cut, _ = example("landmark_faces").cut_out(picture, points)
    assert (cut[0] == 200).all()
    assert (cut[2] == 160).all()


@pytest.mark.slow
def test_train_landmarks(tmp_path):
    """In training on few faces the loss falls, and errors on photographs are printed, too."""
    pytest.importorskip("torch", reason="pip install '.[torch]' brings it")
    faces = tmp_path / "faces"
    make_set(request_of(faces, seed=1, size=(96, 96), passes=()), 8, progress=False)
    photographs = tmp_path / "photographs"
    photographs.mkdir()
    shutil.copy(faces / "000001.png", photographs / "face.png")
    points = (faces / "000001_ldmks.txt").read_text("utf-8").splitlines()[:68]
    marks = "\n".join(["version: 1", "n_points: 68", "{", *points, "}"])
    (photographs / "face.pts").write_text(marks, encoding="utf-8")
    command = [FOLDER / "train_landmarks.py", faces, photographs, "--epochs", 12]
    result = subprocess.run(
        [sys.executable, *map(str, command)],
        capture_output=True,
        text=True,
        check=True,
    )
    lines = result.stdout.splitlines()
    losses = [float(line.split()[-1]) for line in lines[:12]]
    assert losses[-1] < 0.9 * losses[0]
    assert lines[12].startswith("ours, ")
    assert "photographs marked by hand, 1 faces [%]" in result.stdout
