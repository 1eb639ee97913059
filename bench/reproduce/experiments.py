"""What the paper says, by number, and whether what was measured agrees with it.

`paper.toml` is the one table of experiments, in the order of the paper. An entry there is a command
and a part of the page: nothing else has to be told of a new one. The command line imports this at
once, so it imports nothing that is slow.
"""

from __future__ import annotations

import enum
import importlib
import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from risorius.app.files import Image


class Verdict(enum.StrEnum):
    """What becomes of a claim."""

    MET = "met"
    MISSED = "MISSED"
    DIFFERS = "differs"
    """It is not as the paper says, for a reason that the statement tells."""
    NOISE = "noise"
    """The measurement says what cannot be: the machine was busy with something else."""


class Measured(NamedTuple):
    """A number, and how far it can be trusted."""

    value: float
    quartiles: tuple[float, float] | None = None
    """Half of what was seen lies between these; None for what is counted."""
    least: float = -math.inf
    """Nothing below this is possible."""


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, and the numbers that agree with it; see `paper.toml`."""

    value: str
    statement: str
    paper: str = ""
    low: float = -math.inf
    high: float = math.inf
    style: str = "g"
    differs: bool = False

    def judge(self, measured: Measured) -> Verdict:
        """Whether it is so; what is no number misses, too."""
        if measured.value < measured.least:
            return Verdict.NOISE
        if not self.low <= measured.value <= self.high:
            return Verdict.MISSED
        return Verdict.DIFFERS if self.differs else Verdict.MET

    def allowed(self, measured: Measured) -> str:
        """What is allowed, and below what it cannot be."""
        low, high, least = (f"{x:{self.style}}" for x in (self.low, self.high, measured.least))
        if low == high:
            return f"exactly {low}"
        bounds = [f"at least {low}"] if self.low > -math.inf else []
        bounds += [f"at most {high}"] if self.high < math.inf else []
        return ", ".join(bounds) + (
            f"; possible from {least}" if measured.least > -math.inf else ""
        )

    def ours(self, measured: Measured) -> str:
        """Our number, with its quartiles."""
        value, *quartiles = (
            f"{x:{self.style}}" for x in (measured.value, *(measured.quartiles or ()))
        )
        return f"{value} ({' to '.join(quartiles)})" if quartiles else value


@dataclass(frozen=True)
class Outcome:
    """What an experiment made."""

    values: Mapping[str, Measured | float]
    """What was measured, by name."""
    picture: Image | None = None
    text: str = ""
    """A table of more than the claims."""


@dataclass(frozen=True)
class Experiment:
    """One thing that the paper says, and how it is tried; see `paper.toml`."""

    name: str
    """Of the command, and of its picture."""
    title: str
    place: str
    about: str
    function: str
    claims: list[Claim] = field(default_factory=list)
    picture: bool = False
    rounds: int | None = None

    @property
    def callable(self) -> Callable[..., Outcome]:
        """The function, imported now."""
        module, _, name = self.function.partition(".")
        function: Callable[..., Outcome]
        function = getattr(importlib.import_module(f"{__package__}.{module}"), name)
        return function

    def run(self, *, rounds: int | None = None) -> Result:
        """Do it. KeyError for a claim that was not measured."""
        timing = {} if self.rounds is None else {"rounds": rounds or self.rounds}
        outcome = self.callable(**timing)
        found = [(claim, outcome.values[claim.value]) for claim in self.claims]
        findings = [(c, x if isinstance(x, Measured) else Measured(float(x))) for c, x in found]
        return Result(self, outcome, findings)


class Result(NamedTuple):
    """An experiment that was made, and what was measured for each of its claims."""

    experiment: Experiment
    outcome: Outcome
    findings: list[tuple[Claim, Measured]]

    @property
    def missed(self) -> list[tuple[Claim, Measured]]:
        """Those that are not met."""
        expected = Verdict.MET, Verdict.DIFFERS
        return [(claim, x) for claim, x in self.findings if claim.judge(x) not in expected]


def _claim(entry: dict[str, Any]) -> Claim:
    """One of the table."""
    if "exactly" in entry:
        entry["low"] = entry["high"] = entry.pop("exactly")
    return Claim(**entry)


_TABLE = tomllib.loads((Path(__file__).parent / "paper.toml").read_text(encoding="utf-8"))
EXPERIMENTS = tuple(
    Experiment(**entry, claims=list(map(_claim, claims)))
    for entry in _TABLE["experiment"]
    for claims in [entry.pop("claim")]
)
"""All experiments."""
INFERRED: list[dict[str, str]] = _TABLE["inferred"]
"""What the paper does not give: place, what, value and source of each."""
