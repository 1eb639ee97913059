"""The request for a data set: all options that determine its samples, except their number."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..passes.labels import check_wanted
from ..passes.passes import IMAGE_PASSES
from ..refining.refiners import parse_options
from ..text import as_text
from .surroundings import Backgrounds, LightFiles, backgrounds_of, light_files_of
from .table import SampleTable, load_table


@dataclass(frozen=True)
class SetRequest:
    """The request for a data set; it can be pickled.

    output: the folder of the set.
    size: width and height of pictures [pixels].
    passes: names of passes, see app/passes/passes.py.
    refiner: name of a refiner; None for the default.
    degrade: whether pictures get blur, noise and JPEG compression.
    shards: number of samples in each shard; None: no shards.
    arguments: the same request as command-line options.
    """

    output: Path
    seed: int
    size: tuple[int, int]
    passes: tuple[str, ...]
    table: SampleTable
    backgrounds: Backgrounds = Backgrounds()  # noqa: RUF009 - frozen
    lights: LightFiles = LightFiles()  # noqa: RUF009 - frozen
    refiner: str | None = None
    degrade: bool = False
    shards: int | None = None
    arguments: str = ""
    version: str = version("risorius")

    def options(self) -> dict[str, Any]:
        """Return the options that determine samples, as JSON values; a resumed set keeps them."""
        table = asdict(self.table) | {"excluded": sorted(map(sorted, self.table.excluded.pairs))}
        table["expressions"] = {name: row.row for name, row in self.table.expressions.items()}
        options = {
            "risorius": self.version,
            "seed": self.seed,
            "size": list(self.size),
            "passes": list(self.passes),
            "background": self.backgrounds.options,
            "light": self.lights.options,
            "refiner": self.refiner,
            "degrade": self.degrade,
            "shards": self.shards,
            **{f"[{name}]": section for name, section in table.items()},
        }
        return dict(json.loads(json.dumps(options)))


def request_of(
    output: Path,
    *,
    seed: int,
    size: tuple[int, int],
    passes: Sequence[str],
    sample: Path | None = None,
    background: str | None = None,
    light: Path | None = None,
    refiner: str | None = None,
    degrade: bool = False,
    shards: int | None = None,
) -> SetRequest:
    """Make a request from command-line options; if these do not fit together, raise UserError."""
    check_wanted(passes, "face")
    parse_options(refiner, ())
    passes = tuple(name for name in IMAGE_PASSES if name in passes)
    settings = {
        "sample": sample,
        "seed": seed,
        "passes": ",".join(passes),
        "size": "x".join(map(str, size)),
        "background": background,
        "light": light,
        "refiner": refiner,
        "shards": shards,
    }
    words = ["--degrade"] if degrade else []
    for name, value in settings.items():
        if value is not None:
            words += [f"--{name}", as_text(value)]
    return SetRequest(
        output=output.absolute(),
        seed=seed,
        size=size,
        passes=passes,
        table=load_table(sample),
        backgrounds=backgrounds_of(background),
        lights=light_files_of(light),
        refiner=refiner,
        degrade=degrade,
        shards=shards,
        arguments=shlex.join(words),
    )
