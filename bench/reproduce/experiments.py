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
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from risorius.app.files import Image


class Verdict(enum.StrEnum):
    """What becomes of a claim."""

    MET = "met"
    MISSED = "MISSED"
    DIFFERS = "differs"
    """It is not as the paper says, for a reason that the statement tells."""
    NOISE = "noise"
    """The measurement says what cannot be: the machine was busy with something else."""


@dataclass(frozen=True)
class Measured:
    """A number, and how far it can be trusted."""

    value: float
    quartiles: tuple[float, float] | None = None
    """Half of what was seen lies between these; None for what is counted."""
    least: float = -math.inf
    """Nothing below this is possible."""

    @classmethod
    def median(cls, values: npt.NDArray[np.floating], *, least: float = -math.inf) -> Measured:
        """The median of what was seen, with its quartiles."""
        import numpy

        low, middle, high = numpy.percentile(values, (25, 50, 75)).tolist()
        return cls(middle, (low, high), least)


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

    @classmethod
    def of(cls, entry: Mapping[str, Any]) -> Claim:
        """One of the table."""
        told = dict(entry)
        if "exactly" in told:
            told["low"] = told["high"] = told.pop("exactly")
        return cls(**told)

    def judge(self, measured: Measured) -> Verdict:
        """Whether it is so; what is no number misses, too."""
        if measured.value < measured.least:
            return Verdict.NOISE
        if not self.low <= measured.value <= self.high:
            return Verdict.MISSED
        return Verdict.DIFFERS if self.differs else Verdict.MET


@dataclass(frozen=True)
class Finding:
    """A claim beside what was measured."""

    claim: Claim
    measured: Measured

    @property
    def verdict(self) -> Verdict:
        """What becomes of the claim."""
        return self.claim.judge(self.measured)

    @property
    def allowed(self) -> str:
        """What is allowed, and below what it cannot be."""
        low, high, style = self.claim.low, self.claim.high, self.claim.style
        if low == high:
            return f"exactly {low:{style}}"
        bounds = [f"at least {low:{style}}"] if low > -math.inf else []
        bounds += [f"at most {high:{style}}"] if high < math.inf else []
        least = self.measured.least
        return ", ".join(bounds) + (f"; possible from {least:{style}}" if least > -math.inf else "")

    @property
    def ours(self) -> str:
        """Our number, with its quartiles."""
        text = f"{self.measured.value:{self.claim.style}}"
        if self.measured.quartiles is not None:
            low, high = (f"{each:{self.claim.style}}" for each in self.measured.quartiles)
            text += f" ({low} to {high})"
        return text


@dataclass(frozen=True)
class Outcome:
    """What an experiment made."""

    values: Mapping[str, Measured | float]
    """What was measured, by name."""
    picture: Image | None = None
    text: str = ""
    """A table of more than the claims."""


@dataclass(frozen=True)
class Result:
    """An experiment that was made."""

    experiment: Experiment
    outcome: Outcome
    findings: list[Finding]

    @property
    def missed(self) -> list[Finding]:
        """Those that are not met."""
        expected = (Verdict.MET, Verdict.DIFFERS)
        return [each for each in self.findings if each.verdict not in expected]


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
        findings = []
        for claim in self.claims:
            value = outcome.values[claim.value]
            measured = value if isinstance(value, Measured) else Measured(float(value))
            findings.append(Finding(claim, measured))
        return Result(self, outcome, findings)


_TABLE = tomllib.loads((Path(__file__).parent / "paper.toml").read_text(encoding="utf-8"))
EXPERIMENTS = tuple(
    Experiment(**entry, claims=list(map(Claim.of, claims)))
    for entry in _TABLE["experiment"]
    for claims in [entry.pop("claim")]
)
"""All experiments."""
INFERRED: list[dict[str, str]] = _TABLE["inferred"]
"""What the paper does not give: place, what, value and source of each."""
