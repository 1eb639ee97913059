"""Work on a Dask cluster; each Dask worker does its work in separate processes.

Threads of a Dask worker cannot draw, and Dask reports a crash in a thread as a killed worker. So a
Dask worker passes its work on to a `WorkerPool`.
"""

from __future__ import annotations

import contextlib
import secrets
import socket
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from functools import partial
from typing import Any

from .errors import UserError
from .extras import optional_import
from .stopping import cleaned_up_if_stopped
from .text import in_one_line
from .workers import MOST_ATTEMPTS, WorkerPool, share_of_cores

SCHEDULER_TIMEOUT = 10.0  # [s] for the scheduler to answer
MOST_LOSSES = 10  # an item fails when Dask has lost its workers so many times

_pools: dict[str, WorkerPool] = {}
"""In a Dask worker: the processes of each run."""


def run_on_cluster(
    work: Callable[[WorkerPool, Any], Any], items: Sequence[Any], scheduler: str
) -> Generator[tuple[Any, Any, str], None, None]:
    """Yield each item when it ends: (item, result, ""), or (item, None, reason) if it fails.

    An item whose workers are lost goes to other workers. The cluster deletes each fetched result.
    Raises UserError if no scheduler answers.
    """
    distributed = optional_import("distributed", "--scheduler", "cluster")
    client = _client(distributed, scheduler)
    run = secrets.token_hex(8)

    def end() -> None:
        """End the run's processes on all workers, busy or not."""
        with contextlib.suppress(Exception):  # workers or the scheduler may be gone
            client.run(_end, run, wait=True, on_error="ignore")

    with client, cleaned_up_if_stopped(end):
        try:
            yield from _results(distributed, client, partial(_work_on, run, work), items)
        finally:
            end()


def _client(distributed: Any, scheduler: str) -> Any:
    """Connect to the scheduler at an address; raise UserError if no scheduler answers."""
    try:  # tested first: a client takes half a minute to notice a missing scheduler
        host_and_port = distributed.comm.get_address_host_port(scheduler)
        socket.create_connection(host_and_port, SCHEDULER_TIMEOUT).close()
        return distributed.Client(scheduler, timeout=SCHEDULER_TIMEOUT, set_as_default=False)
    except (OSError, TimeoutError, ValueError, OverflowError) as error:
        why = getattr(error, "strerror", None) or error or "it does not speak Dask's protocol"
        raise UserError(
            f"--scheduler {scheduler}: no Dask scheduler answers there ({why}); "
            "write the address that it prints at its start, such as tcp://host:8786"
        ) from None


def _results(
    distributed: Any, client: Any, do: Callable[[Any], Any], items: Sequence[Any]
) -> Iterator[tuple[Any, Any, str]]:
    """Yield results in the form of `run_on_cluster`."""
    losses = Counter[int]()
    futures = client.map(do, items, pure=False, retries=MOST_ATTEMPTS - 1)
    number_of = {future.key: number for number, future in enumerate(futures)}
    ended = distributed.as_completed(
        futures, loop=client.loop, with_results=True, raise_errors=False
    )
    del futures  # else the cluster would keep all results
    for future, result in ended:
        number = number_of.pop(future.key)
        if future.status == "finished":
            future.release()
            yield items[number], result, ""
            continue
        error = future.exception()
        losses[number] += 1
        if isinstance(error, distributed.KilledWorker) and losses[number] < MOST_LOSSES:
            again = client.submit(do, items[number], pure=False, retries=MOST_ATTEMPTS - 1)
            number_of[again.key] = number
            ended.add(again)
        else:
            yield items[number], None, in_one_line(error)


def _work_on(run: str, work: Callable[[WorkerPool, Any], Any], item: Any) -> Any:
    """Work on an item, inside a Dask worker."""
    return work(_pools.setdefault(run, WorkerPool(share_of_cores())), item)


def _end(run: str) -> None:
    """Stop the processes of a run, inside a Dask worker."""
    _pools.setdefault(run, WorkerPool()).stop()
