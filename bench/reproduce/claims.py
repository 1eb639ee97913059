"""What the paper says, by number, and whether what was measured agrees with it.

The command line imports this at once, so it imports nothing that is slow.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

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
    """A statement of the paper, and the numbers that agree with it."""

    value: str
    """Name of what is measured."""
    statement: str
    """What the paper says, in our words."""
    expected: str
    """The paper's number, as a reader is to see it; empty where it gives none."""
    low: float = -math.inf
    high: float = math.inf
    style: str = "g"
    """How our number is written."""
    is_met: bool = True
    """False where numbers within the bounds are as we expect, and not as the paper says."""

    @property
    def tolerance(self) -> str:
        """What is allowed, in words."""
        if self.low == self.high:
            return f"exactly {self.low:{self.style}}"
        parts = []
        if self.low > -math.inf:
            parts.append(f"at least {self.low:{self.style}}")
        if self.high < math.inf:
            parts.append(f"at most {self.high:{self.style}}")
        return ", ".join(parts)

    def judge(self, measured: Measured) -> Verdict:
        """Whether it is so; what is no number misses, too."""
        if measured.value < measured.least:
            return Verdict.NOISE
        if not self.low <= measured.value <= self.high:
            return Verdict.MISSED
        return Verdict.MET if self.is_met else Verdict.DIFFERS


@dataclass(frozen=True)
class Outcome:
    """What an experiment made."""

    values: Mapping[str, Measured | float] = field(default_factory=dict)
    """What was measured, by name."""
    pictures: Mapping[str, Image] = field(default_factory=dict)
    """What was drawn, by the name of its file without `.png`."""
    text: str = ""
    """A table of more than the claims."""
    renderer: str = ""
    """What OpenGL calls itself; empty where nothing was drawn."""


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
        least = self.measured.least
        if least == -math.inf:
            return self.claim.tolerance
        return f"{self.claim.tolerance}; possible from {least:{self.claim.style}}"

    @property
    def ours(self) -> str:
        """Our number, with its quartiles."""
        text = f"{self.measured.value:{self.claim.style}}"
        if self.measured.quartiles is not None:
            low, high = (f"{each:{self.claim.style}}" for each in self.measured.quartiles)
            text += f" ({low} to {high})"
        return text
