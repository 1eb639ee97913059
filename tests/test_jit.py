"""Compiled code: kept where that can be trusted, made again where it cannot, never old."""

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
KERNELS = """
from risorius.jit import njit
from .other import factor

@njit
def scale(number):
    return factor() * number
"""
OTHER = """
from risorius.jit import njit

@njit
def factor():
    return 2.0
"""
PROGRAM = """
import logging, sys
logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stdout)
from risorius.refine.kernels import scale
print(scale(2.0), scale(3.0))
"""
COMPILED = [f"compiling risorius.refine.{name}" for name in ("kernels.scale", "other.factor")]
RESULT = "4.0 6.0"


class Package:
    """A package of one kernel that calls one of another file, and the user's folder of code."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.code = folder / "home" / "risorius"
        self.refine = folder / "risorius" / "refine"
        self.refine.mkdir(parents=True)
        shutil.copy(ROOT / "risorius" / "jit.py", folder / "risorius")
        (folder / "risorius" / "__init__.py").write_text("")
        (self.refine / "__init__.py").write_text("")
        (self.refine / "other.py").write_text(OTHER)
        (self.refine / "kernels.py").write_text(KERNELS)

    def run(self, program: str = PROGRAM, **environment: str) -> list[str]:
        """Lines of a process that calls the kernel; it must end well."""
        clean = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
        result = subprocess.run(
            [sys.executable, "-B", "-c", program],
            cwd=self.folder,
            env={**clean, "XDG_CACHE_HOME": str(self.code.parent), **environment},
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert result.returncode == 0, result.stderr
        return result.stdout.splitlines()

    def kept(self) -> list[Path]:
        """Folders of machine code."""
        return sorted(self.code.glob("compiled-*"))


@pytest.fixture
def package(tmp_path: Path) -> Package:
    """The package, with nothing compiled."""
    return Package(tmp_path)


def test_code_is_kept_and_never_old(package: Package) -> None:
    """A second start compiles nothing, whichever file changed counts, and the folder is private."""
    assert package.run() == [*COMPILED, RESULT]
    assert package.run() == [RESULT]
    (folder,) = package.kept()
    assert folder.stat().st_mode & 0o077 == 0
    (package.refine / "other.py").write_text(OTHER.replace("2.0", "5.0"))
    assert package.run() == [*COMPILED, "10.0 15.0"]
    (package.refine / "other.py").write_text(OTHER)
    assert package.run() == [RESULT]  # as after `git switch`, there and back


@pytest.mark.parametrize("fault", ["no folder", "open", "a link", "of somebody else"])
def test_without_a_folder_code_is_compiled_each_time(package: Package, fault: str) -> None:
    """What others could have written is not run; one line says what it costs."""
    if fault == "no folder":
        package.code.parent.write_text("")
    else:
        package.run()
        (folder,) = package.kept()
        if fault == "open":
            folder.chmod(0o777)
        elif fault == "a link":
            folder.rename(folder.with_name("elsewhere"))
            folder.symlink_to("elsewhere")
        elif getattr(os, "geteuid", lambda: 1)() == 0:
            os.chown(folder, 12345, 12345)
        else:
            pytest.skip("only root can give a folder away")
    for _ in range(2):
        warned, *lines = package.run()
        assert lines == [*COMPILED, RESULT]
        assert warned.startswith("compiled code is not kept (")
        assert "NUMBA_CACHE_DIR" in warned


def test_runs_as_python(package: Package) -> None:
    """With NUMBA_DISABLE_JIT=1 kernels are the functions that are written; nothing is stored."""
    assert package.run(NUMBA_DISABLE_JIT="1") == [RESULT]
    assert not package.kept()


def test_processes_that_start_together(package: Package) -> None:
    """Several that start at once on nothing all end well, and the next compiles nothing."""
    with ThreadPoolExecutor(4) as threads:
        assert {lines[-1] for lines in threads.map(lambda _: package.run(), range(4))} == {RESULT}
    assert package.run() == [RESULT]


REFINE = """
import sys, threading
import numpy as np
from risorius import refine
from tests import meshes
mesh = meshes.irregular(3)
deformed = meshes.wrinkled(mesh, 5)
finer = refine.create("loop", mesh.faces, mesh.vertices).refine(mesh.vertices)
detail = {"scheme": "detail", "detail": (finer.positions.copy(), finer.triangles.copy())}
choices = [{}, {"scheme": "cubic"}, {"blend": True}, {"coherent": True}, detail,
           {**detail, "blend": False}, {"criterion": "curvature+rest"},
           {"criterion": "silhouette+border"},
           {"scheme": "cubic", "criterion": "displacement"}]
found = {}
def work(k):
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, **choices[k % len(choices)])
    frame = refiner.refine(deformed, view=refine.View((3.0, 2.0, 9.0)))
    found[f"{k} rows"] = np.hstack([frame.positions, frame.normals])
    found[f"{k} triangles"] = frame.triangles.copy()
threads = [threading.Thread(target=work, args=[k]) for k in range(2 * len(choices))]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
np.savez(sys.argv[1], **found)
"""


def frames_of_threads(file: Path, **environment: str) -> dict[str, np.ndarray]:
    """Frames of refiners that threads make all at once, in a new process."""
    result = subprocess.run(
        [sys.executable, "-c", REFINE, file],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert result.returncode == 0, result.stderr
    return dict(np.load(file))


@pytest.mark.slow
def test_threads_and_python_agree(tmp_path: Path) -> None:
    """Each thread a refiner of its own, all at once; and all of it as the Python it is written in.

    The second half of the threads makes the same refiners as the first.
    """
    compiled = frames_of_threads(tmp_path / "compiled.npz")
    plain = frames_of_threads(tmp_path / "plain.npz", NUMBA_DISABLE_JIT="1")
    assert len(compiled) == len(plain) == 36
    for name, array in compiled.items():
        np.testing.assert_allclose(plain[name], array, rtol=0, atol=1e-5, err_msg=name)
        k, what = name.split()
        assert np.array_equal(compiled[f"{(int(k) + 9) % 18} {what}"], array)
