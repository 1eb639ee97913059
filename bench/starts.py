"""What only a fresh interpreter can tell: how long the first frame takes, and the peak of memory.

The first start ever compiles the kernels and keeps them on disk; every later one loads them. Import
of numpy is not counted, since every user of the plug-in has it. Nor is what the mesh itself takes
in memory.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .waving_meshes import Load

PROGRAM = """
import time
import numpy
start = time.perf_counter()
from risorius import refine
faces = numpy.array([[0, 1, 2], [2, 1, 3]])
rest = numpy.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
refine.create("kahler", faces, rest).refine(rest + rest[:, :1] * rest[:, 1:2])
print(time.perf_counter() - start)
"""
PEAK_PROGRAM = """
import sys
import numpy
from risorius import refine
def kilobytes(name):
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith(name))
faces, rest, positions = (numpy.load(f"{sys.argv[1]}/{name}.npy") for name in "abc")
flat = numpy.eye(3)
refine.create("kahler", [[0, 1, 2]], flat).refine(flat)  # kernels are loaded
with open("/proc/self/clear_refs", "w") as file:
    file.write("5")  # the peak begins anew
before = kilobytes("VmRSS")
once, twice = float(sys.argv[2]), float(sys.argv[3])
refiner = refine.create("kahler", faces, rest, threshold_once=once, threshold_twice=twice)
refiner.refine(positions)
print(kilobytes("VmHWM") - before)
"""
REPEATS = 5


@dataclass(frozen=True)
class Starts:
    """Seconds from numpy's import to the first refined frame [s]."""

    first: float
    """Kernels compiled."""
    later: float
    """Kernels loaded from disk: median of five."""
    best_later: float


def measure_starts() -> Starts:
    """Start interpreters with an empty cache of their own: once to fill it, then again."""
    with tempfile.TemporaryDirectory() as cache:
        first = _start(cache)
        later = [_start(cache) for _ in range(REPEATS)]
    return Starts(first, float(np.median(later)), min(later))


def measure_peak(load: Load, once: float, twice: float) -> float | None:
    """Most memory that binding a mesh and refining its first frame take [MB], in a new process.

    `once`, `twice`: thresholds. None where the system does not tell (it is read from /proc).
    """
    if not Path("/proc/self/clear_refs").exists():
        return None
    with tempfile.TemporaryDirectory() as folder:
        for name, array in zip("abc", (load.faces, load.rest, load.frames[0]), strict=True):
            np.save(Path(folder) / f"{name}.npy", np.asarray(array))
        return 1.024e-3 * float(_run(PEAK_PROGRAM, folder, str(once), str(twice)))


def _start(cache: str) -> float:
    return float(_run(PROGRAM, cache=cache))


def _run(program: str, *arguments: str, cache: str | None = None) -> str:
    result = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        env=dict(os.environ) if cache is None else {**os.environ, "NUMBA_CACHE_DIR": cache},
        capture_output=True,
        text=True,
        check=True,
    )
    return result.stdout
