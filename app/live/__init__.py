"""Faces that are sent while they move: sockets, packets, and what is done when nobody sends."""

from .live_face import LOST_AFTER, LiveFace, State
from .protocols import ANYWHERE, LOOPBACK, PROTOCOLS, Listening, own_address
from .receiver import Receiver

__all__ = [
    "ANYWHERE",
    "LOOPBACK",
    "LOST_AFTER",
    "PROTOCOLS",
    "Listening",
    "LiveFace",
    "Receiver",
    "State",
    "own_address",
]
