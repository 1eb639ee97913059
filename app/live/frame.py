"""What one packet says, in the vocabulary of recordings, and what every parser does with numbers.

A parser is a pure function of a packet: it answers with a `LiveFrame`, or with None for what is no
packet of its kind. It never raises, whatever it is given: packets come from a network.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..recordings.names import NONSENSE, shape_of

MOST_BYTES = 16384  # of a packet; the largest that anybody sends has about 3000
LONGEST_NAME = 40  # letters of a shape
LONGEST_SUBJECT = 40  # letters; it is shown in the window


@dataclass(frozen=True)
class LiveFrame:
    """What a packet says; a channel that it does not name stays as it was.

    channels: by the names and in the units of recordings/names.py.
    subject: whose face it is, as the sender calls it; "" where it does not tell.
    has_face: False where the sender says that it sees nobody.
    is_complete: False where more packets of the same frame must come before it counts.
    """

    channels: Mapping[str, float] = field(default_factory=dict)
    subject: str = ""
    has_face: bool = True
    is_complete: bool = True


def put_shape(channels: dict[str, float], name: str, value: float) -> None:
    """Set a shape; what is far from 0 and 1, as trackers now and then send it, is left out."""
    if abs(value) <= NONSENSE:
        channels[name] = value


def put_angle(channels: dict[str, float], name: str, degrees: float) -> None:
    """Set an angle; what is more than half a turn, or no number, is left out."""
    if abs(degrees) <= 180.0:
        channels[name] = degrees


def readable_subject(name: bytes) -> str:
    """A sender's name for a face, as far as it can be shown."""
    text = name[: 4 * LONGEST_SUBJECT].decode("utf-8", "replace")
    return "".join(filter(str.isprintable, text))[:LONGEST_SUBJECT]


def shape_named(name: str) -> str | None:
    """The shape that a sender calls so, None for another name."""
    return shape_of(name) if len(name) <= LONGEST_NAME else None
