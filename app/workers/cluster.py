"""The same on the workers of a Dask cluster: each of them has processes of its own for the work.

Threads of a Dask worker cannot draw, nor can one that crashed be told from one that was killed. So
what is sent there asks a `WorkerPool`, just as here.
"""

from __future__ import annotations

import asyncio
import contextlib
import secrets
import socket
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from ..errors import UserError, in_one_line, needed
from ..stopping import cleaned_up_if_stopped
from .pool import RETRIES, Outcome, WorkerPool

PATIENCE = 10.0  # [s] for the scheduler to answer

_pools: dict[str, WorkerPool] = {}
"""In a Dask worker: the processes of each run."""


def run_on_cluster(
    work: Callable[[Any], Any],
    items: Sequence[Any],
    logs: Sequence[Path | None],
    scheduler: str,
) -> Iterator[Outcome]:
    """Yield what became of each item as it ends; UserError where no scheduler answers."""
    distributed = needed("distributed", "--scheduler", "cluster")
    try:
        # Asked first: a client takes half a minute to find that nobody is there, and waits for ever
        # where somebody answers who is no scheduler.
        host_and_port = distributed.comm.get_address_host_port(scheduler)
        socket.create_connection(host_and_port, PATIENCE).close()
        asyncio.run(_greet(distributed, scheduler))
        client = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError, ValueError, OverflowError) as error:
        why = getattr(error, "strerror", None) or str(error) or "it does not speak Dask's protocol"
        raise UserError(
            f"--scheduler {scheduler}: no Dask scheduler answers there ({why}); "
            "write what it says when it starts, as in tcp://host:8786"
        ) from None
    run = secrets.token_hex(8)

    def end() -> None:
        """End the run's processes on all workers, whatever they do."""
        with contextlib.suppress(Exception):  # workers, or the scheduler, may be gone
            client.run(_end, run, wait=True, on_error="ignore")

    with client, cleaned_up_if_stopped(end):
        try:
            places = list(range(len(items)))
            futures = client.map(
                partial(_do, run, work),
                places,
                items,
                logs,
                pure=False,
                retries=RETRIES,
                key=[f"{run}-{place}" for place in places],
            )
            place_of = {future.key: place for place, future in enumerate(futures)}
            for future, outcome in distributed.as_completed(
                futures, loop=client.loop, with_results=True, raise_errors=False
            ):
                place = place_of[future.key]
                if future.status != "finished":
                    why = in_one_line(future.exception())
                    outcome = Outcome(place, items[place], None, why, RETRIES + 1, 0.0)
                futures[place] = None  # the cluster may forget it
                yield outcome
        finally:
            end()


async def _greet(distributed: Any, scheduler: str) -> None:
    """Shake hands with a scheduler; TimeoutError where nobody does in time."""
    greeting = distributed.comm.connect(scheduler, timeout=PATIENCE)
    (await asyncio.wait_for(greeting, PATIENCE)).abort()


def _do(run: str, work: Callable[[Any], Any], index: int, item: Any, log: Path | None) -> Outcome:
    """In a Dask worker: work on an item."""
    return _pools.setdefault(run, WorkerPool(threads=1)).do(work, index, item, log)


def _end(run: str) -> None:
    """In a Dask worker: the run is over."""
    _pools.setdefault(run, WorkerPool(threads=1)).stop()
