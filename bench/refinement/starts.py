"""How long the first frame takes, which only a fresh interpreter can tell.

The first start ever compiles the kernels and keeps them on disk; every later one loads them. Import
of numpy is not counted, since every user of the plug-in has it.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass

import numpy as np

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


def _start(cache: str) -> float:
    result = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**os.environ, "NUMBA_CACHE_DIR": cache},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(result.stdout)
