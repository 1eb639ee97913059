"""Frames as they come: a thread reads packets from the socket and wakes the threads that wait.

A window sleeps until something happens, and a frame must be such a thing: asking for it once in a
while would let it lie. Nobody is woken for a part of a frame, for one without a face, or for what
is none.
"""

from __future__ import annotations

import socket
import threading
import time
from collections import deque
from collections.abc import Callable

from ..errors import UserError
from .frame import MOST_BYTES, LiveFrame
from .protocols import ANYWHERE, LOOPBACK, Listening, resolved


class Receiver:
    """A socket and its thread; `close` ends both.

    listening: where. received, unusable: packets so far, and those that are none of the protocol.
    has_frame: whether a frame waits that somebody was woken for.
    """

    LOOK_AROUND = 0.1  # [s] after which the thread sees that it is to end

    def __init__(
        self,
        listening: Listening,
        wake: Callable[[], None] = lambda: None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Listen at once. wake: called from the thread when a frame waits and none did before.

        Raises UserError if that cannot be.
        """
        self.listening = listening
        self._wake = wake
        self._clock = clock
        self._parse = listening.protocol.parser()
        most_waiting = 256  # frames or parts of them; of more, the oldest are dropped
        self._waiting: deque[tuple[float, LiveFrame]] = deque(maxlen=most_waiting)
        self.received = self.unusable = 0
        self.has_frame = False
        self._socket = _bound_socket(listening)
        self._socket.settimeout(self.LOOK_AROUND)
        self._is_closing = False
        self._thread = threading.Thread(target=self._receive, name="live face", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """The address that is listened on."""
        return str(self._socket.getsockname()[0])

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return int(self._socket.getsockname()[1])

    def take(self) -> list[tuple[float, LiveFrame]]:
        """The frames since the last call, oldest first, each with its time [s of the clock]."""
        self.has_frame = False
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

    def close(self) -> None:
        """Stop listening."""
        self._is_closing = True
        self._thread.join()
        self._socket.close()

    def _receive(self) -> None:
        while not self._is_closing:
            try:
                packet = self._socket.recv(MOST_BYTES + 1)
            except TimeoutError:
                continue
            except OSError:  # a network that is down may come back
                time.sleep(self.LOOK_AROUND)
                continue
            self._read(packet, self._clock())

    def _read(self, packet: bytes, at: float) -> None:
        """Keep a packet's content, wake the threads that wait, and count the packet as done."""
        frame = self._parse(packet) if len(packet) <= MOST_BYTES else None
        if frame is None:
            self.unusable += 1
        else:
            self._waiting.append((at, frame))
            if frame.is_complete and frame.has_face and not self.has_frame:
                self.has_frame = True
                self._wake()
        self.received += 1


def _bound_socket(listening: Listening) -> socket.socket:
    """A socket that listens; raises UserError if the system refuses."""
    address = resolved(listening.address)
    port = listening.chosen_port
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        opened.bind((address, port))
    except OSError as error:
        opened.close()
        raise UserError(
            f"cannot listen on {address}, port {port}: {error.strerror}; close the program that "
            f"listens there, choose another --port, or another --address ({LOOPBACK} for this "
            f"computer alone, {ANYWHERE} for its whole network)"
        ) from None
    return opened
