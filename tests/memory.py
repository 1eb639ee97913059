"""Memory of this process, for tests that repeat an operation."""

import ctypes
import gc
import os
import sys
from pathlib import Path

import pytest

MEGABYTE = 2**20


def held_memory() -> float:
    """The memory of this process [MB], without pages that the allocator keeps for later.

    The test is skipped if the system does not report it.
    """
    status = Path("/proc/self/statm")
    if not status.exists():
        pytest.skip("this system has no /proc, which says how much memory a process holds")
    gc.collect()
    if sys.platform.startswith("linux"):
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:  # a function of glibc
            trim(0)
    resident = int(status.read_text().split()[1])
    return resident * os.sysconf("SC_PAGE_SIZE") / MEGABYTE
