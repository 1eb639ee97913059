"""What a data set is to be: all that decides its samples, but their number."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .table import SampleTable

PASSES = ("depth", "normal", "segmentation", "landmarks")


@dataclass(frozen=True)
class Request:
    """A data set that is asked for; fit to be pickled.

    size: of the pictures [pixels]. passes: some of those of `risorius capture --passes`. output:
    the folder of the set.
    """

    output: Path
    seed: int
    size: tuple[int, int]
    passes: tuple[str, ...]
    table: SampleTable
    background: str | None

    def options(self) -> dict[str, Any]:
        """For the file that says how the set was begun."""
        return {}
