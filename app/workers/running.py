"""`run_all`: a function on many items, in processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from ..stopping import cleaned_up_if_stopped
from .child import cores
from .crew import Crew, Outcome


def run_all(
    work: Callable[[Any], Any],
    items: Sequence[Any],
    *,
    jobs: int,
    scheduler: str | None = None,
    retries: int = 2,
    logs: Sequence[Path] | None = None,
) -> Iterator[Outcome]:
    """Call `work` on every item in `jobs` processes, and yield what became of each as it ends.

    work: a function at the top of a module, which is imported where it runs; items and results
    must be fit to be pickled. What it raises is told in one line and not tried again, for it would
    be raised again; an item whose process dies is tried `retries` times more.
    scheduler: the address of a Dask scheduler, whose workers do it instead; all that items name
    must be there, too. logs: for each item, the file that what is printed is added to.
    Whoever stops early, or is stopped, ends the processes at once. Raises UserError where no
    scheduler answers.
    """
    if scheduler is not None:
        from .cluster import run_on_cluster

        yield from run_on_cluster(work, items, scheduler=scheduler, retries=retries, logs=logs)
        return
    crew = Crew(max(1, cores() // jobs))
    with cleaned_up_if_stopped(crew.stop), ThreadPoolExecutor(jobs) as threads:
        try:
            futures = [
                threads.submit(
                    crew.do, work, index, item, retries=retries, log=logs[index] if logs else None
                )
                for index, item in enumerate(items)
            ]
            for future in as_completed(futures):
                yield future.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
            crew.stop()
