"""Options that decide how a recording is played."""

from __future__ import annotations

from dataclasses import dataclass

LEAD_TIME = 0.047  # [s] by which simulated muscles and skin lag behind their controls


@dataclass(frozen=True)
class Playback:
    """Options for the conversion of a recording; None leaves a choice to the kind of file.

    neutral: "first:SECONDS", "percentile" or "none". gains: factors of channels, as "NAME=x".
    mirror: whether to swap left and right. lead: time by which muscles act before the recording
    [s]; eyes and head act earlier in proportion. face, rate: see `read_take`.
    """

    neutral: str | None = None
    gains: tuple[str, ...] = ()
    mirror: bool = False
    lead: float = LEAD_TIME
    face: str | None = None
    rate: float | None = None
