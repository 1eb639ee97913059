"""Lines on the workers of a Dask cluster, each of which has processes of its own for them.

Threads of a Dask worker cannot draw, and a crash of one looks like a kill. So a Dask worker hands
its lines to a `WorkerPool`, as this computer does.
"""

from __future__ import annotations

import contextlib
import secrets
import socket
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

from ..errors import UserError
from ..extras import needed
from ..stopping import cleaned_up_if_stopped
from ..text import in_one_line
from ..workers import ATTEMPTS, WorkerPool, share_of_cores

PATIENCE = 10.0  # [s] for the scheduler to answer

_pools: dict[str, WorkerPool] = {}
"""In a Dask worker: the processes of each run."""


def run_on_cluster(
    work: Callable[[WorkerPool, Any], Any], items: Sequence[Any], scheduler: str
) -> Iterator[tuple[Any, Any, str]]:
    """Each item as it ends, with the result of its work, or with None and the reason.

    Raises UserError where no scheduler answers.
    """
    distributed = needed("distributed", "--scheduler", "cluster")
    try:  # asked first: a client takes half a minute to find that nobody is there
        host_and_port = distributed.comm.get_address_host_port(scheduler)
        socket.create_connection(host_and_port, PATIENCE).close()
        client = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError, ValueError, OverflowError) as error:
        why = getattr(error, "strerror", None) or error or "it does not speak Dask's protocol"
        raise UserError(
            f"--scheduler {scheduler}: no Dask scheduler answers there ({why}); "
            "write the address that it prints at its start, as in tcp://host:8786"
        ) from None
    run = secrets.token_hex(8)

    def end() -> None:
        """End the run's processes on all workers, busy or not."""
        with contextlib.suppress(Exception):  # workers, or the scheduler, may be gone
            client.run(_end, run, wait=True, on_error="ignore")

    with client, cleaned_up_if_stopped(end):
        try:
            futures = client.map(partial(_do, run, work), items, pure=False, retries=ATTEMPTS - 1)
            item_of = dict(zip((future.key for future in futures), items, strict=True))
            for future, result in distributed.as_completed(
                futures, loop=client.loop, with_results=True, raise_errors=False
            ):
                is_done = future.status == "finished"
                why = "" if is_done else in_one_line(future.exception())
                yield item_of[future.key], result if is_done else None, why
        finally:
            end()


def _do(run: str, work: Callable[[WorkerPool, Any], Any], item: Any) -> Any:
    """In a Dask worker: work on an item."""
    return work(_pools.setdefault(run, WorkerPool(share_of_cores())), item)


def _end(run: str) -> None:
    """In a Dask worker: the run is over."""
    _pools.setdefault(run, WorkerPool()).stop()
