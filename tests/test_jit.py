"""Cached machine code: stored in trusted folders, compiled anew otherwise, and never outdated."""

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
KERNELS_MODULE = """
from risorius.jit import njit
from .other import factor

@njit
def scale(number):
    return factor() * number
"""
OTHER_MODULE = """
from risorius.jit import njit

@njit
def factor():
    return 2.0
"""
KERNEL_PROGRAM = """
import logging, sys
logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stdout)
from risorius.refine.kernels import scale
print(scale(2.0), scale(3.0))
"""
MEETING_PROGRAM = """
import os, pathlib, time
import numba.core.event as event
import risorius.jit
class Slowness(event.Listener):
    on_start = on_end = lambda *_: time.sleep(0.3)
event.register("numba:compile", Slowness())
pathlib.Path(f"here-{os.getpid()}").touch()
while len([*pathlib.Path(".").glob("here-*")]) < 2:
    time.sleep(0.001)
"""
COMPILED_LINES = [f"compiling risorius.refine.{name}" for name in ("kernels.scale", "other.factor")]
PRINTED_RESULT = "4.0 6.0"


class Package:
    """A package with a kernel that calls a kernel of another file, and the user's cache folder."""

    def __init__(self, folder):
        self.folder = folder
        self.code = folder / "home" / "risorius"
        self.refine = folder / "risorius" / "refine"
        self.refine.mkdir(parents=True)
        shutil.copy(ROOT / "risorius" / "jit.py", folder / "risorius")
        (folder / "risorius" / "__init__.py").write_text("")
        (self.refine / "__init__.py").write_text("")
        (self.refine / "other.py").write_text(OTHER_MODULE)
        (self.refine / "kernels.py").write_text(KERNELS_MODULE)

    def run(self, program=KERNEL_PROGRAM, **environment):
        """Run a process that calls the kernel, and return its output lines; it must succeed."""
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

    def kept(self):
        """Folders of cached machine code."""
        return sorted(self.code.glob("compiled-*"))


@pytest.fixture
def package(tmp_path: Path) -> Package:
    """The package, without cached machine code."""
    return Package(tmp_path)


def test_code_is_kept_and_never_old(package):
    """A second start compiles nothing; a change of either file compiles again.

    The cache folder is private.
    """
    assert package.run() == [*COMPILED_LINES, PRINTED_RESULT]
    assert package.run() == [PRINTED_RESULT]
    (folder,) = package.kept()
    assert folder.stat().st_mode & 0o077 == 0
    (package.refine / "other.py").write_text(OTHER_MODULE.replace("2.0", "5.0"))
    assert package.run() == [*COMPILED_LINES, "10.0 15.0"]
    (package.refine / "other.py").write_text(OTHER_MODULE)
    assert package.run() == [PRINTED_RESULT]  # as after `git switch` there and back


@pytest.mark.slow
def test_code_is_kept_for_python_and_for_kernels(package):
    """A kernel that Python and another kernel call is compiled for each, in either order."""
    both = KERNEL_PROGRAM.replace("kernels import scale", "kernels import scale, factor")
    outer, inner = COMPILED_LINES
    assert package.run(f"{both}print(factor())") == [outer, inner, PRINTED_RESULT, inner, "2.0"]
    assert package.run(f"{both}print(factor())") == [PRINTED_RESULT, "2.0"]
    assert package.run(both.replace("print(", "print(factor(), ")) == [f"2.0 {PRINTED_RESULT}"]


@pytest.mark.parametrize(
    "fault",
    [
        "no folder",
        "open",
        pytest.param("a link", marks=pytest.mark.slow),
        pytest.param("of somebody else", marks=pytest.mark.slow),
    ],
)
def test_without_a_folder_code_is_compiled_anew(package, fault):
    """Code in a folder that others can write is not run; one line states the cost of compiling."""
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
    warned, *lines = package.run()
    assert lines == [*COMPILED_LINES, PRINTED_RESULT]
    assert warned.startswith("compiled code is not kept (")
    assert "NUMBA_CACHE_DIR" in warned


def test_runs_as_python(package):
    """With NUMBA_DISABLE_JIT=1 kernels run as Python functions, and nothing is stored."""
    assert package.run(NUMBA_DISABLE_JIT="1") == [PRINTED_RESULT]
    assert not package.kept()


def test_processes_that_start_together(package):
    """Processes that start together without cached code compile each kernel once in all.

    The next one compiles nothing.
    """
    with ThreadPoolExecutor(2) as threads:
        program = MEETING_PROGRAM + KERNEL_PROGRAM
        runs = list(threads.map(lambda _: package.run(program), range(2)))
    assert [lines[-1] for lines in runs] == [PRINTED_RESULT] * 2
    assert sorted(line for lines in runs for line in lines[:-1]) == COMPILED_LINES
    assert package.run() == [PRINTED_RESULT]


@pytest.mark.slow
def test_a_process_that_dies_while_it_compiles_stops_no_other(package):
    """Its lock ends with it, so the next process compiles at once."""
    dying = (
        "import os, risorius.jit as jit; jit._SharedCache.save_overload = lambda *_: os._exit(0)"
    )
    assert package.run(f"{dying}\n{KERNEL_PROGRAM}") == COMPILED_LINES
    assert package.run() == [*COMPILED_LINES, PRINTED_RESULT]


def test_a_kernel_that_does_not_compile_stops_no_other_process(package):
    """Its lock ends with the error, so another process compiles the kernel at once."""
    program = (
        "import subprocess, sys, numba\n"
        "from risorius.refine.kernels import scale\n"
        "try: scale('no number')\n"
        "except numba.errors.TypingError: pass\n"
        f"subprocess.run([sys.executable, '-B', '-c', {KERNEL_PROGRAM!r}], timeout=60, check=True)"
    )
    assert package.run(program) == [COMPILED_LINES[0], PRINTED_RESULT]


def test_functions_without_a_module_compile():
    """Kernels that other programs make with `exec` compile, and do not appear in the log."""
    program = (
        "import numba, risorius.jit; names = {}; exec('def twice(x): return 2 * x', names); "
        "names['twice'].__module__ = None; print(numba.njit(names['twice'])(3))"
    )
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == "6"


def test_lanes_are_a_setting_of_one_kernel(package):
    """A kernel with `lanes` gives the same result, and numba's settings are restored."""
    (package.refine / "kernels.py").write_text(KERNELS_MODULE.replace("@njit", "@njit(lanes=True)"))
    program = f"{KERNEL_PROGRAM}\nimport numba; print(numba.config.SLP_VECTORIZE)"
    assert package.run(program) == [*COMPILED_LINES, PRINTED_RESULT, "0"]
