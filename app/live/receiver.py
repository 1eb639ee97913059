"""Packets as they come: a thread takes them from the socket and wakes whoever waits for them.

A window sleeps until something happens, and a packet must be such a thing: asking for it once a
frame would let it lie for half a frame. The thread only hands packets on; they are read where the
face is moved.
"""

from __future__ import annotations

import socket
import threading
import time
from collections import deque
from collections.abc import Callable

from ..errors import UserError
from .frame import MOST_BYTES
from .protocols import ANYWHERE, LOOPBACK, Listening

MOST_WAITING = 256  # packets; of more, the oldest are dropped
LOOK_AROUND = 0.1  # [s] after which the thread sees that it is to end
REQUEST_EVERY = 1.0  # [s] a phone is asked to send while nothing comes


class Receiver:
    """A socket and its thread; `close` ends both."""

    def __init__(self, listening: Listening, wake: Callable[[], None] = lambda: None) -> None:
        """Listen at once. wake: called from the thread when packets wait that did not before.

        Raises UserError where that cannot be.
        """
        self._listening, self._wake = listening, wake
        self._waiting: deque[tuple[float, bytes]] = deque(maxlen=MOST_WAITING)
        self.received = 0  # packets, those too large among them
        self.too_large = 0
        self._socket = _bound_socket(listening)
        self._socket.settimeout(LOOK_AROUND)
        self._asked_at = -REQUEST_EVERY
        self._is_closing = False
        self._thread = threading.Thread(target=self._receive, name="live face", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return int(self._socket.getsockname()[1])

    @property
    def has_packets(self) -> bool:
        """Whether there is something to take."""
        return bool(self._waiting)

    def take(self) -> list[tuple[float, bytes]]:
        """The packets that came since the last call, oldest first, each with its time [s].

        The time is that of time.monotonic.
        """
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

    def close(self) -> None:
        """Stop listening."""
        self._is_closing = True
        self._thread.join()
        self._socket.close()

    def _receive(self) -> None:
        last = -REQUEST_EVERY
        while not self._is_closing:
            now = time.monotonic()
            if now - max(last, self._asked_at) > REQUEST_EVERY:
                self._ask_phone(now)
            try:
                packet = self._socket.recv(MOST_BYTES + 1)
            except TimeoutError:
                continue
            except OSError:  # Windows tells here that the phone refused what it was asked
                time.sleep(LOOK_AROUND)
                continue
            last = time.monotonic()
            self.received += 1
            if len(packet) > MOST_BYTES:
                self.too_large += 1
                continue
            self._waiting.append((last, packet))
            if len(self._waiting) == 1:
                self._wake()

    def _ask_phone(self, now: float) -> None:
        """Ask the phone to send, if there is one to be asked."""
        self._asked_at = now
        phone, protocol = self._listening.phone, self._listening.protocol
        if phone and protocol.request:
            try:
                self._socket.sendto(protocol.request, (phone, protocol.port))
            except OSError:
                pass  # a network that is down may come back


def _bound_socket(listening: Listening) -> socket.socket:
    """A socket that listens; UserError where the system refuses."""
    address, port = listening.address, listening.chosen_port
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        opened.bind((address, port))
    except (OSError, OverflowError, UnicodeError) as error:
        opened.close()
        reason = getattr(error, "strerror", None) or str(error)
        raise UserError(
            f"cannot listen on {address}, port {port}: {reason}; close what listens there already, "
            f"choose another --port, or another --address ({LOOPBACK} for this computer alone, "
            f"{ANYWHERE} for its whole network)"
        ) from None
    return opened
