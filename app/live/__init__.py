"""Faces that are sent while they move: sockets, packets, and what is done when nobody sends."""

from .live_face import LiveFace, State
from .protocols import LOOPBACK, PROTOCOLS, Listening
from .receiver import Receiver

__all__ = ["LOOPBACK", "PROTOCOLS", "Listening", "LiveFace", "Receiver", "State"]
