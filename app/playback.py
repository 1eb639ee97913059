"""How a recording is played: the options of `Playback`."""

from __future__ import annotations

from dataclasses import dataclass

LEAD = 0.047  # [s] that muscles and the skin on them follow late


@dataclass(frozen=True)
class Playback:
    """How a recording becomes a script; a field that is None is chosen by the kind of file.

    neutral: "first:SECONDS", "percentile" or "none". gains: "NAME=x" each. mirror: left and right
    change places. lead: how far muscles are asked ahead of the recording [s]; eyes and head in
    proportion. face, rate: see `read_take`.
    """

    neutral: str | None = None
    gains: tuple[str, ...] = ()
    mirror: bool = False
    lead: float = LEAD
    face: str | None = None
    rate: float | None = None
