"""What is said of how a recording is played; conversion.py does it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

LEAD = 0.047  # [s] that muscles and the skin on them follow late


@dataclass(frozen=True)
class Playback:
    """How a recording becomes a script; what is not said is as suits the kind of file.

    neutral: "first:SECONDS", "percentile" or "none". gains: "NAME=x" each. mirror: left and right
    change places. smooth: whether channels go through the one-euro filter. lead: how far muscles
    are asked ahead of the recording [s]; eyes and head in proportion. mapping: a table of one's
    own. face, rate: see `read_take`.
    """

    neutral: str | None = None
    gains: tuple[str, ...] = ()
    mirror: bool = False
    smooth: bool = False
    lead: float = LEAD
    mapping: Path | None = None
    face: str | None = None
    rate: float | None = None
