"""Processes that work on many things at once, here or on a cluster.

    for outcome in run_all(work, items, jobs=2):
        ...

A process takes one item after the other, so that it pays once for imports, compiled code and what
it keeps (`app/process_cache.py`). One that dies, killed or by a fault in a driver, costs another
attempt at its item, and nothing else.

    child.py     a process of ours, started anew, and messages to it and back
    pool.py      the processes of a run, as the one that started them sees them
    serving.py   what runs in them
    progress.py  one task in such a process, and how far it is
    cluster.py   the same on the workers of a Dask cluster
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from ..stopping import cleaned_up_if_stopped
from .child import cores
from .pool import Outcome, WorkerPool

__all__ = ["Outcome", "run_all"]


def run_all(
    work: Callable[[Any], Any],
    items: Sequence[Any],
    *,
    jobs: int,
    scheduler: str | None = None,
    logs: Sequence[Path] | None = None,
) -> Iterator[Outcome]:
    """Call `work` on every item in `jobs` processes, and yield what became of each as it ends.

    work: a function at the top of a module, which is imported where it runs; items and results
    must be fit to be pickled. What it raises is told in one line and not tried again, for it would
    be raised again; an item whose process dies is tried twice more.
    scheduler: the address of a Dask scheduler, whose workers do it instead; all that items name
    must be there, too. logs: for each item, the file that what is printed is added to.
    Whoever stops early, or is stopped, ends the processes at once. Raises UserError where no
    scheduler answers.
    """
    logged = list(logs) if logs else [None] * len(items)
    if scheduler is not None:
        from .cluster import run_on_cluster

        yield from run_on_cluster(work, items, logged, scheduler)
        return
    pool = WorkerPool(max(1, cores() // jobs))
    with cleaned_up_if_stopped(pool.stop), ThreadPoolExecutor(jobs) as threads:
        try:
            futures = [
                threads.submit(pool.do, work, index, item, log)
                for index, (item, log) in enumerate(zip(items, logged, strict=True))
            ]
            for future in as_completed(futures):
                yield future.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
            pool.stop()
