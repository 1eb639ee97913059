"""Time a frame of refinement with one thread and with all threads.

Frames are timed in pairs, one frame with one thread and one with all, in alternating order. Other
work on the machine slows both frames of a pair, so the reported gain is the median of the quotients
of pairs. Both frames have bit-identical results (refine/mesh/threads.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from risorius import refine
from risorius.app.errors import UserError
from risorius.refine.mesh import threads

from .refine import RULES, Load, interleaved, load_of
from .report import processor, table

SIZES = ("20k", "200k", "1M")
"""The meshes of a run by default."""


class Row(NamedTuple):
    """The times of one rule on one mesh."""

    mesh: str
    rule: str
    triangles: int
    """Triangles of the refined mesh."""
    alone: float
    """Time of a frame by one thread, median [ms]."""
    together: float
    """Time of a frame by all threads, median [ms]."""
    gain: float
    """Ratio of the time by one thread to that by all in a pair, median of the pairs."""


def measure(
    sizes: Sequence[str], seconds: float, progress: Callable[[str], object] = lambda _: None
) -> list[Row]:
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
            calls = [partial(_refine, load, refiner, each) for each in (1, count)]
            try:
                rows.append(_row(load, rule, calls, seconds / len(RULES)))
            finally:
                threads.THREAD_COUNT = count
    return rows


def _refine(load: Load, refiner: refine.Refiner, thread_count: int) -> None:
    """Refine all frames by this number of threads."""
    threads.THREAD_COUNT = thread_count
    for frame in load.frames:
        refiner.refine(frame)


def _row(load: Load, rule: str, calls: Sequence[Callable[[], object]], seconds: float) -> Row:
    spent = float(interleaved(calls, 1).sum())
    fewest_pairs = 5
    times = interleaved(calls, max(round(seconds / spent), fewest_pairs))
    alone, together = 1e3 * np.median(times, axis=0) / len(load.frames)
    gain = float(np.median(times[:, 0] / times[:, 1]))
    return Row(load.name, rule, len(load.faces), float(alone), float(together), gain)


def report(rows: Sequence[Row]) -> str:
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
