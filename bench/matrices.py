"""Compare a frame of constant splits with multiplication by a stored sparse matrix.

If every edge is split once, one level of Loop subdivision is a matrix, the same in all frames. The
rivals multiply positions by this matrix, which libigl's `loop_matrix` makes: one in scipy, the
other in a plain loop over rows in numba. Our refiner also makes normals; the rivals do not. Frames
are timed in pairs, one of ours and one of a rival, in alternating order, so that other work on the
machine slows both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib.metadata import version
from typing import Any

import numba
import numpy as np

from risorius import refine
from risorius.app.extras import needed
from risorius.geometry.arrays import Floats64, Integers32
from risorius.refine.mesh import threads

from .refine import Load, Pair, Points, load_of, timed_pair
from .report import processor, table

SIZES = ("2k", "20k", "200k", "1M")
"""The meshes of a run by default."""


def measure(
    sizes: Sequence[str], seconds: float, progress: Callable[[str], object] = lambda _: None
) -> list[Pair]:
    """Time our refiner and each rival on meshes of these sizes, for about `seconds` each.

    Raises UserError without libigl.
    """
    igl = needed("igl", "libigl", "rivals", package="libigl")
    rows = []
    for size in sizes or SIZES:
        progress(size)
        load = load_of(size)
        edge_count = len(refine.connect(load.faces, len(load.rest)).edges)
        splits = np.ones(edge_count, dtype=np.uint8)
        fixed = refine.create("kahler", load.faces, load.rest, splits=splits)
        for rival, call in _rivals(load, igl):
            rows.append(timed_pair(load, rival, [call, fixed.refine], 0.5 * seconds))
    return rows


def report(rows: Sequence[Pair]) -> str:
    """The text to print."""
    columns = "mesh:<6|rival:<20|triangles:10d|theirs ms:11.3f|ours ms:10.3f|gain:7.2f"
    versions = ", ".join(f"{name} {version(name)}" for name in ("libigl", "scipy", "numba"))
    return "\n".join(
        [
            f"Every edge split once, on {processor()}: ours with normals by {threads.THREAD_COUNT}",
            f"threads at most, and a kept Loop matrix without normals by one ({versions}).",
            "Medians of pairs; gain is that of the quotients of pairs.",
            "",
            *table(columns, rows),
        ]
    )


def _rivals(load: Load, igl: Any) -> Iterator[tuple[str, Callable[[Points], object]]]:
    matrix = igl.loop_matrix(load.faces.astype(np.int64), len(load.rest))[0].tocsr()
    yield "libigl, loop_matrix", partial(_multiply, matrix)
    starts = matrix.indptr.astype(np.int32)
    columns = matrix.indices.astype(np.int32)
    out = np.zeros((matrix.shape[0], 3))
    kept = starts, columns, matrix.data
    multiply = numba.njit(nogil=True)(multiply_plainly)
    multiply(*kept, load.rest, out)
    yield "numba, a plain loop", lambda positions: multiply(*kept, positions, out)


def _multiply(matrix: Any, positions: Points) -> object:
    return matrix @ positions


def multiply_plainly(
    starts: Integers32, columns: Integers32, weights: Floats64, positions: Points, out: Points
) -> None:
    """Write the product of a sparse matrix and positions, in plain numba."""
    for row in range(len(out)):
        x = 0.0
        y = 0.0
        z = 0.0
        for k in range(starts[row], starts[row + 1]):
            column = columns[k]
            weight = weights[k]
            x += weight * positions[column, 0]
            y += weight * positions[column, 1]
            z += weight * positions[column, 2]
        out[row, 0] = x
        out[row, 1] = y
        out[row, 2] = z
