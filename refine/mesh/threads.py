"""Loops over large meshes are shared among threads; loops over small meshes run in one thread.

A kernel is called as kernel(first, last, ...). It writes the results of the items from first to
last, and reads no result of other items. So a frame is equal to the last bit for any number and
order of threads.

Each free thread takes the next part of a loop. If a core is busy with other work, the other cores
do its parts, and no thread waits for one that has not begun. The number of threads is numba's
default: one for each core, or the number in NUMBA_NUM_THREADS.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

ITEMS_OF_PART = 1 << 15
"""Least number of items for which waking a thread is worth its tenth of a millisecond."""
PARTS_OF_THREAD = 4
"""Parts of the work of each thread: many, so that a slow thread delays the others only a little."""


def _thread_count() -> int:
    """Return the number in NUMBA_NUM_THREADS, or else that of the cores of this process."""
    wanted = int(os.environ.get("NUMBA_NUM_THREADS") or 0)
    if wanted:
        return wanted
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


THREAD_COUNT = _thread_count()
"""Number of threads that share a loop, including the calling one."""

_pool: ThreadPoolExecutor | None = None


def parallel_for(kernel: Callable[..., object], count: int, *arguments: object) -> None:
    """Call kernel(first, last, *arguments) in threads, for parts that cover `count` items."""
    threads = threads_for(count)
    if threads == 1:
        kernel(0, count, *arguments)
        return
    part_count = threads * PARTS_OF_THREAD
    cuts = [count * part // part_count for part in range(part_count + 1)]
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


def start_beside(task: Callable[[], object], count: int) -> Callable[[], object]:
    """Start a task in another thread if `count` is large; return a function that completes it."""
    if threads_for(count) == 1:
        return task
    other = _threads().submit(task)

    def complete() -> object:
        return task() if other.cancel() else other.result()

    return complete


def threads_for(count: int) -> int:
    """Return the number of threads for a loop over `count` items, including this thread."""
    if count < 2 * ITEMS_OF_PART:  # for small meshes this check is a part of the frame's time
        return 1
    return max(min(count // ITEMS_OF_PART, THREAD_COUNT), 1)


def _threads() -> ThreadPoolExecutor:
    global _pool
    if _pool is None:
        _pool = ThreadPoolExecutor(thread_name_prefix="refine")
    return _pool


def _forget_threads() -> None:
    """Forget the threads in a forked process, which has none of them."""
    global _pool
    _pool = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_threads)
