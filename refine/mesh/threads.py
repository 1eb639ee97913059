"""Loops over large meshes, shared among threads; those over small ones stay where they are.

A kernel is called as kernel(first, last, ...). It writes what belongs to the items from first to
last, and reads nothing that the loop writes elsewhere: so a frame has the same bits, however many
threads there are and in which order they run.

Parts of a loop are taken as threads come to them. Where a core is busy with other things the rest
is done on the others, and nobody waits for a thread that has not begun. There are as many threads
as numba would take: one for each core, or as many as NUMBA_NUM_THREADS says.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

ITEMS_OF_PART = 1 << 15
"""Items whose loop is worth waking a thread, which takes a tenth of a millisecond."""
PARTS_OF_THREAD = 4
"""Into how many parts the share of a thread is cut, so that a slow one holds nobody up for long."""

THREAD_COUNT = int(os.environ.get("NUMBA_NUM_THREADS") or 0) or (
    len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
)
"""Threads that share a loop, the one that calls among them."""

_pool: ThreadPoolExecutor | None = None


def share(kernel: Callable[..., object], count: int, *arguments: object) -> None:
    """Call kernel(first, last, *arguments) for parts that make up all of `count` items."""
    threads = threads_for(count)
    if threads == 1:
        kernel(0, count, *arguments)
        return
    cuts = [count * k // (threads * PARTS_OF_THREAD) for k in range(threads * PARTS_OF_THREAD + 1)]
    parts = iter(list(pairwise(cuts)))

    def work() -> None:
        for first, last in parts:
            kernel(first, last, *arguments)

    others = [_threads().submit(work) for _ in range(threads - 1)]
    try:
        work()
    finally:
        for other in others:
            if not other.cancel():
                other.result()


def beside(task: Callable[[], object], count: int) -> Callable[[], object]:
    """Begin a task of `count` items in another thread, if it is worth one; return what ends it."""
    if threads_for(count) == 1:
        return task
    other = _threads().submit(task)
    return lambda: task() if other.cancel() else other.result()


def threads_for(count: int) -> int:
    """How many threads, this one among them, a loop over `count` items is worth."""
    if count < 2 * ITEMS_OF_PART:  # of small meshes, whose frame this is a part of
        return 1
    return max(min(count // ITEMS_OF_PART, THREAD_COUNT), 1)


def _threads() -> ThreadPoolExecutor:
    global _pool
    if _pool is None:
        _pool = ThreadPoolExecutor(thread_name_prefix="refine")
    return _pool


def _forget_threads() -> None:
    """In a process that was forked, which has none of them."""
    global _pool
    _pool = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_threads)
