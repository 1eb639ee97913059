"""The paper's claims, and whether our measurements agree with them.

`paper.toml` is the only table of experiments, in the order of the paper. Each entry there becomes a
command and a part of the page; a new entry needs no other change. The command line always imports
this module, so it has no slow imports.
"""

from __future__ import annotations

import importlib
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from risorius.app.pictures import Image


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, and the range of numbers that agree with it; see `paper.toml`."""

    value: str
    statement: str
    paper: str = ""
    low: float = -math.inf
    high: float = math.inf
    style: str = "g"
    differs: str = ""
    """Reason why our number differs from the paper; "" if it should agree."""

    def verdict(self, number: float) -> str:
        """Whether the number agrees with the statement; NaN does not."""
        if not self.low <= number <= self.high:
            return "MISSED"
        return "differs" if self.differs else "met"

    @property
    def allowed(self) -> str:
        """The range of numbers that agree, as text."""
        low = self.ours(self.low)
        high = self.ours(self.high)
        if low == high:
            return f"exactly {low}"
        bounds = [f"at least {low}"] if self.low > -math.inf else []
        if self.high < math.inf:
            bounds.append(f"at most {high}")
        text = ", ".join(bounds)
        return f"(expected here: {text})" if self.differs else text

    def ours(self, number: float) -> str:
        """A measured number as text."""
        return f"{number:{self.style}}"


@dataclass(frozen=True)
class Outcome:
    """The results of an experiment."""

    values: Mapping[str, float]
    """Measured values, by name."""
    picture: Image | None = None
    text: str = ""
    """A table with more than the claims."""


@dataclass(frozen=True)
class Experiment:
    """A statement of the paper, and the function that tests it; see `paper.toml`."""

    name: str
    """Name of the command, and of its picture."""
    title: str
    place: str
    function: str
    claims: list[Claim] = field(default_factory=list)
    picture: bool = False
    rounds: int | None = None

    def run(self, *, rounds: int | None = None) -> ExperimentResult:
        """Run the experiment. KeyError for a claim without a measurement."""
        timing = {} if self.rounds is None else {"rounds": rounds or self.rounds}
        module, _, name = self.function.partition(".")
        function = getattr(importlib.import_module(f"{__package__}.{module}"), name)
        outcome: Outcome = function(**timing)
        findings = [(claim, float(outcome.values[claim.value])) for claim in self.claims]
        return ExperimentResult(self, outcome, findings)


class ExperimentResult(NamedTuple):
    """A finished experiment, with a measurement for each claim."""

    experiment: Experiment
    outcome: Outcome
    findings: list[tuple[Claim, float]]

    @property
    def missed(self) -> list[tuple[Claim, float]]:
        """The claims that the measurements do not meet."""
        return [(claim, x) for claim, x in self.findings if claim.verdict(x) == "MISSED"]


def _claim(entry: dict[str, Any]) -> Claim:
    """Make a claim from an entry of the table."""
    if "exactly" in entry:
        entry["low"] = entry["high"] = entry.pop("exactly")
    return Claim(**entry)


PAPERS_TABLE = tomllib.loads((Path(__file__).parent / "paper.toml").read_text(encoding="utf-8"))
EXPERIMENTS = tuple(
    Experiment(**entry, claims=list(map(_claim, claims)))
    for entry in PAPERS_TABLE["experiment"]
    for claims in [entry.pop("claim")]
)
"""All experiments."""
