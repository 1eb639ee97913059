"""The number of frames that this process has played, which its parent reads as progress.

This file imports nothing, so a worker that plays no frames starts at once.
"""

from dataclasses import dataclass


@dataclass
class Tally:
    """A number of frames."""

    frames: int = 0


tally = Tally()
