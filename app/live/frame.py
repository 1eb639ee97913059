"""The content of one packet in the vocabulary of recordings, and checks of its numbers.

A parser is a pure function of a packet: it returns a `LiveFrame`, or None for a packet of another
kind. It never raises, because packets come from a network.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..recordings.names import NONSENSE, shape_of

MOST_BYTES = 16384  # of a packet; the largest that anybody sends has about 3000


@dataclass(frozen=True)
class LiveFrame:
    """The content of a packet; a channel that it does not name stays as it was.

    channels: by the names and in the units of recordings/names.py.
    subject: the person's name, as the sender gives it; "" if it gives none.
    has_face: False where the sender says that it sees nobody.
    is_complete: False where more packets of the same frame must come before it counts.
    """

    channels: Mapping[str, float] = field(default_factory=dict)
    subject: str = ""
    has_face: bool = True
    is_complete: bool = True


def put_shape(channels: dict[str, float], name: str, value: float) -> None:
    """Set a shape, unless its value is far from 0 and 1, as trackers now and then send it."""
    if abs(value) <= NONSENSE:
        channels[name] = value


def put_angle(channels: dict[str, float], name: str, degrees: float) -> None:
    """Set an angle, unless it is more than half a turn or no number."""
    if abs(degrees) <= 180.0:
        channels[name] = degrees


def readable_subject(name: bytes) -> str:
    """A sender's name for a face, as far as it can be shown."""
    longest_subject = 40  # letters; it is shown in the window
    text = name[: 4 * longest_subject].decode("utf-8", "replace")
    return "".join(filter(str.isprintable, text))[:longest_subject]


def shape_named(name: str) -> str | None:
    """The shape that a sender calls so, None for another name."""
    longest_name = 40  # letters of a shape
    return shape_of(name) if len(name) <= longest_name else None
