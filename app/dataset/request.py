"""What a data set is to be: all that decides its samples, but their number."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..passes.exr import CHANNELS
from .table import SampleTable


@dataclass(frozen=True)
class Request:
    """A data set that is asked for; fit to be pickled.

    output: the folder of the set. size: of the pictures [pixels]. passes: some of those of
    `risorius capture --passes`, see app/passes/passes.py.
    """

    output: Path
    seed: int
    size: tuple[int, int]
    passes: tuple[str, ...]
    table: SampleTable
    version: str = version("risorius")

    def options(self) -> dict[str, Any]:
        """What decides the samples, for JSON: resumed is what was begun with the same."""
        return {
            "risorius": self.version,
            "seed": self.seed,
            "size": list(self.size),
            "passes": list(self.passes),
            "table": dict(self.table.sections),
        }

    def files(self) -> list[list[str]]:
        """What lies in the set for each sample: names, and what that is."""
        floats = ", ".join(name for name in self.passes if name in CHANNELS)
        rows = [["ID.png", "the picture, 8 bits sRGB"]]
        if floats:
            rows.append(["ID.exr", f"{floats}: 32 bits for each pixel (OpenEXR)"])
        if "segmentation" in self.passes:
            rows.append(["ID_seg.png", "what each pixel shows, by the numbers of FaceSynthetics"])
        if "landmarks" in self.passes:
            rows.append(["ID_ldmks.txt", "x and y of 68 landmarks and both pupils [pixels]"])
        return [*rows, ["ID.json", "all labels"]]
