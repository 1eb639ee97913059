"""Data sets that are made in the test's process, which starts no worker."""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from risorius.app.dataset import making


@contextlib.contextmanager
def in_this_process() -> Iterator[None]:
    """Within this context, data sets are made in this process, which has imported everything."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(making, "run_all", _run_here)
        yield


def _run_here(
    work: Callable[..., object], parts: Sequence[Any], *, log: Path | None = None
) -> Iterator[Any]:
    """Do `work(part, send)` for all parts in order, and yield their messages."""
    for part in parts:
        messages: list[Any] = []
        work(part, messages.append)
        yield from messages
