"""The content of one packet, with the channels of recordings, and checks of its numbers.

A parser is a pure function of a packet: it returns a `LiveFrame`, or None for a packet of another
kind. It never raises, because packets come from a network.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..recordings.names import LARGEST_VALUE, shape_of

MOST_BYTES = 16384  # in a packet that is read; known senders send at most about 3000


@dataclass(frozen=True)
class LiveFrame:
    """The content of a packet; a channel that it does not name keeps its value.

    channels: values with names and units of recordings/names.py.
    subject: the sender's name for the person, or "".
    has_face: False if the sender reports that it sees nobody.
    is_complete: False if further packets belong to the same frame.
    """

    channels: Mapping[str, float] = field(default_factory=dict)
    subject: str = ""
    has_face: bool = True
    is_complete: bool = True


def set_shape(channels: dict[str, float], name: str, value: float) -> None:
    """Set a shape; ignore a value far outside of 0 to 1, which trackers sometimes send."""
    if abs(value) <= LARGEST_VALUE:
        channels[name] = value


def set_angle(channels: dict[str, float], name: str, degrees: float) -> None:
    """Set an angle, unless it is more than half a turn or NaN."""
    if abs(degrees) <= 180.0:
        channels[name] = degrees


def readable_subject(name: bytes) -> str:
    """Return a sender's name for a face, reduced to printable letters."""
    longest_subject = 40  # letters, shown in the window
    text = name[: 4 * longest_subject].decode("utf-8", "replace")
    return "".join(filter(str.isprintable, text))[:longest_subject]


def shape_named(name: str) -> str | None:
    """Return the shape that a sender's name means, or None."""
    longest_name = 40  # letters of a shape
    return shape_of(name) if len(name) <= longest_name else None
