"""Processes that work on many things at once, here or on a cluster.

    for outcome in run_all(work, items, jobs=2):
        ...

A process takes one item after the other, so that it pays once for imports, compiled code and what
it keeps (`app/process_cache.py`). One that dies, killed or by a fault in a driver, costs another
attempt at its item, and nothing else.

    child.py     a process of ours, started anew, and messages to it and back
    running.py   `run_all`, and what became of an item
    crew.py      the processes of one run, as the process that started them sees them
    serving.py   what runs in them
    cluster.py   the same on the workers of a Dask cluster
"""

from .crew import Outcome
from .running import run_all

__all__ = ["Outcome", "run_all"]
