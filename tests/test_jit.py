"""Compiled code: stored on disk where that can be trusted, made again where it cannot."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
KERNELS = """
import numpy as np
from risorius.jit import njit
from .other import FACTOR

@njit
def scale(numbers, scaled):
    for k in range(numbers.shape[0]):
        scaled[k] = FACTOR * numbers[k]
"""
PROGRAM = """
import logging, sys
import numpy as np
from risorius import jit

class Count(logging.Handler):
    def emit(self, record):
        print(record.levelname, record.getMessage(), flush=True)

jit.log.addHandler(Count())
jit.log.setLevel(logging.INFO)
jit.log.propagate = False
from risorius.refine.kernels import scale
scaled = np.zeros(3)
scale(np.arange(3.0), scaled)
scale(np.arange(3.0), scaled)
print(scaled.tolist())
"""
COMPILED = "INFO compiling risorius.refine.kernels.scale"
RESULT = "[0.0, 2.0, 4.0]"

Run = Callable[..., list[str]]


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package of one kernel that uses a number of another file."""
    folder = tmp_path / "risorius"
    (folder / "refine").mkdir(parents=True)
    shutil.copy(ROOT / "risorius" / "jit.py", folder)
    (folder / "__init__.py").write_text("")
    (folder / "refine" / "__init__.py").write_text("")
    (folder / "refine" / "other.py").write_text("FACTOR = 2.0\n")
    (folder / "refine" / "kernels.py").write_text(KERNELS)
    return folder


@pytest.fixture
def run(package: Path, tmp_path: Path) -> Run:
    """A function that calls the kernel in a new process and returns what was told."""

    def run_once(**environment: str) -> list[str]:
        return start(package, tmp_path, **environment)

    return run_once


def start(package: Path, home: Path, **environment: str) -> list[str]:
    """Lines of a process that calls the kernel; it must end well."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "XDG_"))}
    result = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=package.parent,
        env={**clean, "HOME": str(home), "PYTHONDONTWRITEBYTECODE": "1", **environment},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.splitlines()


def stored_files(folder: Path) -> list[Path]:
    """Files of machine code anywhere below a folder."""
    return sorted(folder.rglob("*.code"))


def test_second_start_compiles_nothing(run: Run, package: Path) -> None:
    """Code lies beside the package, closed to others, and is read the next time."""
    assert run() == [COMPILED, RESULT]
    (file,) = stored_files(package)
    assert file.parent.stat().st_mode & 0o077 == 0
    assert run() == [RESULT]


@pytest.mark.slow
def test_change_in_another_file_counts(run: Run, package: Path) -> None:
    """What a kernel takes from another file of its package is part of its code."""
    run()
    (package / "refine" / "other.py").write_text("FACTOR = 3.0\n")
    assert run() == [COMPILED, "[0.0, 3.0, 6.0]"]
    assert len(stored_files(package)) == 1  # the old code was written over


@pytest.mark.slow
def test_code_of_other_programs_is_not_kept(tmp_path: Path, package: Path) -> None:
    """Nobody knows what it depends on; nor what a function has closed over."""
    program = tmp_path / "program.py"
    program.write_text(
        "from risorius.jit import njit\n"
        "def times(factor):\n"
        "    @njit\n    def scale(x):\n        return factor * x\n    return scale\n"
        "print(times(3.0)(1.0), times(5.0)(1.0))\n"
    )
    inside = package / "refine" / "scaling.py"
    inside.write_text(program.read_text().replace("print(", "RESULT = ("))
    for code in ([str(program)], ["-c", "import risorius.refine.scaling as s; print(*s.RESULT)"]):
        result = subprocess.run(
            [sys.executable, *code],
            cwd=tmp_path,
            env={k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")},
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert result.stdout == "3.0 5.0\n", result.stderr
    assert not stored_files(package)


@pytest.mark.slow
def test_changed_options_count(run: Run, package: Path) -> None:
    """Options that are the same for all kernels are part of the code."""
    run()
    text = (package / "jit.py").read_text()
    (package / "jit.py").write_text(text.replace('"error_model": "numpy"', '"boundscheck": True'))
    assert run() == [COMPILED, RESULT]


@pytest.mark.slow
def test_damaged_file_is_made_again(run: Run, package: Path) -> None:
    """A file that is empty, foreign or cut off costs a compilation, nothing else."""
    run()
    (file,) = stored_files(package)
    whole = file.read_bytes()
    for damaged in (b"", b"torn", whole[: len(whole) // 2]):
        file.write_bytes(damaged)
        assert run() == [COMPILED, RESULT]
    assert file.read_bytes() == whole


def read_only(folder: Path) -> None:
    """Close a folder for a user who may write anywhere, too: a file takes its place."""
    (folder / "__pycache__").write_text("")


@pytest.mark.slow
def test_code_goes_to_the_user_where_the_package_is_read_only(
    run: Run, package: Path, tmp_path: Path
) -> None:
    """An installation that belongs to somebody else is left alone."""
    read_only(package)
    assert run() == [COMPILED, RESULT]
    (file,) = stored_files(tmp_path / ".cache")
    assert "risorius" in str(file.parent.name)
    assert run() == [RESULT]


@pytest.mark.parametrize(
    "home",
    [
        "/nonexistent/home",
        pytest.param("/dev/null", marks=pytest.mark.slow),
        pytest.param("", marks=pytest.mark.slow),
    ],
)
def test_without_a_folder_code_is_compiled_each_time(run: Run, package: Path, home: str) -> None:
    """No home, none that can be written, none at all: it runs, and one line says what it costs."""
    read_only(package)
    environment = {"HOME": home or "relative", "XDG_CACHE_HOME": home}
    if os.access("/", os.W_OK) and home.startswith("/nonexistent"):
        environment["XDG_CACHE_HOME"] = "/proc/none"  # root may make any other folder
    compiled, warned, result = run(**environment)
    assert (compiled, result) == (COMPILED, RESULT)
    assert warned.startswith("WARNING compiled code is not kept (there is no folder")
    assert "NUMBA_CACHE_DIR" in warned


@pytest.mark.parametrize(
    ("inside", "is_needed"),
    [
        ("compiler.CompileResult._rebuild", True),
        pytest.param("codegen.CPUCodegen.magic_tuple", True, marks=pytest.mark.slow),
        pytest.param("compiler.CompileResult._reduce", True, marks=pytest.mark.slow),
        pytest.param("caching._Cache", False, marks=pytest.mark.slow),
    ],
)
def test_numba_of_other_insides(run: Run, package: Path, inside: str, is_needed: bool) -> None:
    """Where numba has not what keeping code needs, each process compiles, and one line says so."""
    text = (package / "jit.py").read_text()
    (package / "jit.py").write_text(
        text.replace("import numba\n", f"import numba\ndel numba.core.{inside}\n", 1)
    )
    if is_needed:
        warned, result = run()
        assert warned.startswith("WARNING compiled code is not kept (numba ")
        assert result == RESULT
    else:
        assert run() == [COMPILED, RESULT]
    assert bool(stored_files(package)) != is_needed


@pytest.mark.slow
def test_full_disk(run: Run, package: Path) -> None:
    """A file that cannot be written whole is not left behind, and one line says why."""
    text = (package / "jit.py").read_text()
    limited = text.replace(
        "import functools\n",
        "import functools\nimport resource, signal\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))\n",
    )
    (package / "jit.py").write_text(limited)
    compiled, warned, result = run()
    assert (compiled, result) == (COMPILED, RESULT)
    assert "File too large" in warned
    assert [file.name for file in (package / "__pycache__" / "machine_code").iterdir()] == ["lock"]


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no owners of files here")
@pytest.mark.parametrize("fault", ["open", "open above", "a link", "of somebody else"])
@pytest.mark.slow
def test_folders_of_others_are_not_trusted(
    run: Run, package: Path, tmp_path: Path, fault: str
) -> None:
    """What others could have written is neither run nor written over."""
    run(NUMBA_CACHE_DIR=str(tmp_path / "shared"))
    (file,) = stored_files(tmp_path / "shared")
    if fault == "open":
        file.parent.chmod(0o777)
    elif fault == "open above":  # where others could move it away and put their own in its place
        file.parent.parent.chmod(0o777)
    elif fault == "a link":
        file.parent.rename(tmp_path / "elsewhere")
        file.parent.symlink_to(tmp_path / "elsewhere")
    elif os.geteuid() == 0:
        os.chown(file.parent, 12345, 12345)
    else:
        pytest.skip("only root can give a folder away")
    assert run(NUMBA_CACHE_DIR=str(tmp_path / "shared")) == [COMPILED, RESULT]
    assert stored_files(package)  # beside the code instead


@pytest.mark.parametrize("name", ["code", "lock"])
@pytest.mark.slow
def test_pipes_in_the_folder_do_not_hang(run: Run, package: Path, name: str) -> None:
    """A pipe in the place of a file is no code, and nothing waits for what it will say."""
    run()
    (file,) = stored_files(package)
    pipe = file if name == "code" else file.with_name("lock")
    pipe.unlink()
    if name == "lock":
        file.unlink()
    os.mkfifo(pipe)
    assert run() == [COMPILED, RESULT]


@pytest.mark.skipif(getattr(os, "geteuid", lambda: 1)() != 0, reason="only root gives files away")
@pytest.mark.slow
def test_files_of_others_are_not_trusted(run: Run, package: Path) -> None:
    """Nor is a file in a folder of ours that somebody else owns."""
    run()
    (file,) = stored_files(package)
    os.chown(file, 12345, 12345)
    assert run() == [COMPILED, RESULT]


def test_function_without_a_source(tmp_path: Path, package: Path) -> None:
    """What is typed in by hand is compiled, and not stored."""
    program = "from risorius.jit import njit\n@njit\ndef one(x):\n    return x\nprint(one(1))"
    result = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    assert result.stdout == "1\n", result.stderr
    assert not stored_files(package)


@pytest.mark.slow
def test_edited_after_import(package: Path, run: Run) -> None:
    """Code is stored under the sources that it was made of, not those that lie there by now."""
    edit = "(open('risorius/refine/other.py', 'w').write('FACTOR = 7.0\\n'))\n"
    program = PROGRAM.replace("scaled = np.zeros(3)\n", f"scaled = np.zeros(3)\n{edit}")
    result = subprocess.run(
        [sys.executable, "-c", program],
        cwd=package.parent,
        env={
            **{k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")},
            "PYTHONDONTWRITEBYTECODE": "1",  # Python's own cache looks at whole seconds only
        },
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert result.stdout.splitlines() == [COMPILED, RESULT], result.stderr
    assert run() == [COMPILED, "[0.0, 7.0, 14.0]"]


@pytest.mark.slow
def test_processes_wait_for_the_one_that_compiles(package: Path, tmp_path: Path) -> None:
    """Of several that start together on nothing, one compiles and the others read."""
    told: list[list[str]] = []
    slow = (package / "jit.py").read_text().replace(
        "        code = numba.core.serialize.dumps(data._reduce())\n",
        "        time.sleep(1.0)\n"
        "        code = numba.core.serialize.dumps(data._reduce())\n        print('MADE')\n",
    )  # fmt: skip
    (package / "jit.py").write_text(slow)
    threads = [
        threading.Thread(target=lambda: told.append(start(package, tmp_path))) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(told) == 4
    assert all(lines[-1] == RESULT for lines in told)
    assert sum("MADE" in lines for lines in told) == 1


@pytest.mark.slow
def test_a_lock_that_is_never_given_back(package: Path, tmp_path: Path) -> None:
    """Patience ends: a process that hangs does not keep others from working."""
    fcntl = pytest.importorskip("fcntl")
    start(package, tmp_path)
    (file,) = stored_files(package)
    file.unlink()
    text = (package / "jit.py").read_text()
    (package / "jit.py").write_text(text.replace("PATIENCE = 30.0", "PATIENCE = 0.5"))
    with (file.parent / "lock").open("wb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        begun = time.monotonic()
        assert start(package, tmp_path)[-1] == RESULT
        assert time.monotonic() - begun > 0.5


def test_runs_as_python(package: Path, run: Run) -> None:
    """With NUMBA_DISABLE_JIT=1 kernels are the functions that are written; nothing is stored."""
    assert run(NUMBA_DISABLE_JIT="1") == [RESULT]
    assert not stored_files(package)


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
           {"criterion": "silhouette+screen+border"}, {"scheme": "cubic", "criterion": "bulge"}]
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


@pytest.mark.slow
def test_threads_on_nothing_compiled(tmp_path: Path) -> None:
    """The same where every thread has to compile first."""
    for k in range(3):
        frames_of_threads(tmp_path / f"{k}.npz", NUMBA_CACHE_DIR=str(tmp_path / str(k)))
