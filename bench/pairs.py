"""Time frames of refinement in pairs.

One kind of pair compares one thread with all threads; both frames have equal bits
(refine/mesh/threads.py). The other kind compares our refiner with a stored sparse matrix.

If every edge is split once, one level of Loop subdivision is a matrix, the same in all frames. Two
rivals multiply positions by this matrix, which libigl's `loop_matrix` makes: scipy, and a plain
loop over rows in numba. Our refiner also makes normals; the rivals do not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib.metadata import version
from typing import Any, NamedTuple

import numba
import numpy as np

from risorius import refine
from risorius.app.errors import UserError
from risorius.app.extras import optional_import
from risorius.geometry.arrays import Floats64, Integers32
from risorius.refine.mesh import threads

from .refine import OPTIONS_OF_RULES, Load, interleaved, load_of
from .report import processor, table

Progress = Callable[[str], object]


class TimedPair(NamedTuple):
    """The times of two ways to refine the frames of a mesh."""

    mesh: str
    method: str
    triangles: int
    """Triangles of the mesh before refinement."""
    first: float
    """Time of a frame in the first way, median [ms]."""
    second: float
    """Time of a frame in the second way, median [ms]."""
    gain: float
    """Ratio of the first time to the second in a pair, median of the pairs."""


def timed_pair(
    load: Load, method: str, calls: Sequence[Callable[[Floats64], object]], seconds: float
) -> TimedPair:
    """Time two calls in turn for about `seconds`, at least five pairs.

    Other work on the machine slows both calls of a pair.
    """

    def run(call: Callable[[Floats64], object]) -> None:
        for frame in load.frames:
            call(frame)

    both = [partial(run, call) for call in calls]
    spent = float(interleaved(both, 1).sum())
    fewest_pairs = 5
    times = interleaved(both, max(round(seconds / spent), fewest_pairs))
    first, second = (1e3 * np.median(times, axis=0) / len(load.frames)).tolist()
    gain = float(np.median(times[:, 0] / times[:, 1]))
    return TimedPair(
        mesh=load.name,
        method=method,
        triangles=len(load.faces),
        first=first,
        second=second,
        gain=gain,
    )


def by_threads(
    sizes: Sequence[str], seconds: float, progress: Progress = lambda _: None
) -> list[TimedPair]:
    """Time each rule on meshes of these sizes by one thread and by all, for about `seconds` each.

    Raises UserError if there is only one thread.
    """
    count = threads.THREAD_COUNT
    if count == 1:
        raise UserError(
            "--threads: refinement has one thread here; more come with more cores, or with "
            "NUMBA_NUM_THREADS=2"
        )
    rows = []
    for size in sizes or ("20k", "200k", "1M"):
        progress(size)
        load = load_of(size)
        for rule, options in OPTIONS_OF_RULES.items():
            refiner = refine.create("kahler", load.faces, load.rest, **options)
            calls = [partial(_refine, refiner, each) for each in (1, count)]
            try:
                rows.append(timed_pair(load, rule, calls, seconds / len(OPTIONS_OF_RULES)))
            finally:
                threads.THREAD_COUNT = count
    return rows


def _refine(refiner: refine.Refiner, thread_count: int, positions: Floats64) -> None:
    """Refine a frame by this number of threads."""
    threads.THREAD_COUNT = thread_count
    refiner.refine(positions)


def by_matrix(
    sizes: Sequence[str], seconds: float, progress: Progress = lambda _: None
) -> list[TimedPair]:
    """Time each rival and our refiner on meshes of these sizes, for about `seconds` each.

    Raises UserError without libigl.
    """
    igl = optional_import("igl", "libigl", "rivals", package="libigl")
    rows = []
    for size in sizes or ("2k", "20k", "200k", "1M"):
        progress(size)
        load = load_of(size)
        edge_count = len(refine.connect(load.faces, len(load.rest)).edges)
        splits = np.ones(edge_count, dtype=np.uint8)
        fixed = refine.create("kahler", load.faces, load.rest, splits=splits)
        for rival, call in _rivals(load, igl):
            rows.append(timed_pair(load, rival, [call, fixed.refine], 0.5 * seconds))
    return rows


def report_of_threads(rows: Sequence[TimedPair]) -> str:
    """The text to print about threads."""
    title = f"A frame by one thread and by {threads.THREAD_COUNT}, in pairs, on {processor()}:"
    return _text([title], "rule:<15|triangles:10d|1 thread ms:12.2f|all ms:9.2f", rows)


def report_of_matrix(rows: Sequence[TimedPair]) -> str:
    """The text to print about matrices."""
    versions = ", ".join(f"{name} {version(name)}" for name in ("libigl", "scipy", "numba"))
    titles = [
        f"Every edge split once, on {processor()}: ours with normals by {threads.THREAD_COUNT}",
        f"threads at most, and a kept Loop matrix without normals by one ({versions}):",
    ]
    return _text(titles, "rival:<20|triangles:10d|theirs ms:11.3f|ours ms:10.3f", rows)


def _text(titles: Sequence[str], columns: str, rows: Sequence[TimedPair]) -> str:
    """A report; columns: those between the mesh and the gain."""
    note = "medians; gain is that of the quotients of pairs."
    return "\n".join([*titles, note, "", *table(f"mesh:<6|{columns}|gain:7.2f", rows)])


def _rivals(load: Load, igl: Any) -> Iterator[tuple[str, Callable[[Floats64], object]]]:
    matrix = igl.loop_matrix(load.faces.astype(np.int64), len(load.rest))[0].tocsr()
    yield "libigl, loop_matrix", partial(_multiply, matrix)
    starts = matrix.indptr.astype(np.int32)
    columns = matrix.indices.astype(np.int32)
    out = np.zeros((matrix.shape[0], 3))
    kept = starts, columns, matrix.data
    multiply = numba.njit(nogil=True)(multiply_plainly)
    multiply(*kept, load.rest, out)
    yield "numba, a plain loop", lambda positions: multiply(*kept, positions, out)


def _multiply(matrix: Any, positions: Floats64) -> object:
    return matrix @ positions


def multiply_plainly(
    starts: Integers32, columns: Integers32, weights: Floats64, positions: Floats64, out: Floats64
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
