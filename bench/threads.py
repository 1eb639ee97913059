"""Time a frame of refinement with one thread and with all threads.

Frames are timed in pairs, by one thread and by all. The reported gain is the median of the
quotients of pairs, because other work on the machine slows both frames of a pair. Both frames have
bit-identical results (refine/mesh/threads.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from risorius import refine
from risorius.app.errors import UserError
from risorius.refine.mesh import threads

from .refine import RULES, Pair, Points, load_of, timed_pair
from .report import processor, table

SIZES = ("20k", "200k", "1M")
"""The meshes of a run by default."""


def measure(
    sizes: Sequence[str], seconds: float, progress: Callable[[str], object] = lambda _: None
) -> list[Pair]:
    """Time each rule on meshes of these sizes, for about `seconds` each, at least five pairs.

    Raises UserError if there is only one thread.
    """
    count = threads.THREAD_COUNT
    if count == 1:
        raise UserError(
            "--threads: refinement has one thread here; more come with more cores, or with "
            "NUMBA_NUM_THREADS=2"
        )
    rows = []
    for size in sizes or SIZES:
        progress(size)
        load = load_of(size)
        for rule, options in RULES.items():
            refiner = refine.create("kahler", load.faces, load.rest, **options)
            calls = [partial(_refine, refiner, each) for each in (1, count)]
            try:
                rows.append(timed_pair(load, rule, calls, seconds / len(RULES)))
            finally:
                threads.THREAD_COUNT = count
    return rows


def _refine(refiner: refine.Refiner, thread_count: int, positions: Points) -> None:
    """Refine a frame by this number of threads."""
    threads.THREAD_COUNT = thread_count
    refiner.refine(positions)


def report(rows: Sequence[Pair]) -> str:
    """The text to print."""
    columns = "mesh:<6|rule:<15|triangles:10d|1 thread ms:12.2f|all ms:9.2f|gain:7.2f"
    return "\n".join(
        [
            f"A frame by one thread and by {threads.THREAD_COUNT}, in pairs, on {processor()}:",
            "medians; gain is that of the quotients of pairs.",
            "",
            *table(columns, rows),
        ]
    )
