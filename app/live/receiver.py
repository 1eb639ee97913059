"""Incoming frames: a thread reads packets from the socket, and wakes waiting threads.

A window sleeps until an event. A frame must be such an event, because periodic checks would delay
it. A part of a frame, a frame without a face, and an unusable packet wake no thread.
"""

from __future__ import annotations

import socket
import threading
import time
from collections import deque
from collections.abc import Callable

from ..errors import UserError
from .frame import MOST_BYTES, LiveFrame
from .protocols import ANY_ADDRESS, LOOPBACK_ADDRESS, Listening, resolved


class Receiver:
    """A socket and its thread; `close` ends both.

    listening: address and protocol. received: number of packets so far. unusable: number of
        packets outside the protocol.
    has_frame: whether a frame is waiting.
    """

    LOOK_AROUND = 0.1  # [s] after which the thread checks for `close`

    def __init__(
        self,
        listening: Listening,
        wake: Callable[[], None] = lambda: None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Start to listen. wake: function that the thread calls when a first frame is waiting.

        Raises UserError if the system refuses the address or port.
        """
        self.listening = listening
        self._wake = wake
        self._clock = clock
        self._parse = listening.protocol.parser()
        most_waiting = 256  # frames or parts of them; the oldest of more are dropped
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
        """The address to listen on."""
        return str(self._socket.getsockname()[0])

    @property
    def port(self) -> int:
        """The port to listen on."""
        return int(self._socket.getsockname()[1])

    def new_frames(self) -> list[tuple[float, LiveFrame]]:
        """Return the frames since the last call, oldest first, and their times [s of the clock]."""
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
            except OSError:  # a network may recover
                time.sleep(self.LOOK_AROUND)
                continue
            self._read(packet, self._clock())

    def _read(self, packet: bytes, at: float) -> None:
        """Keep a packet's content, wake waiting threads, and count the packet."""
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
    """Open a socket that listens; raise UserError if the system refuses."""
    address = resolved(listening.address)
    port = listening.chosen_port
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        opened.bind((address, port))
    except OSError as error:
        opened.close()
        raise UserError(
            f"cannot listen on {address}, port {port}: {error.strerror}; close the program that "
            f"listens there, choose another --port, or another --address ({LOOPBACK_ADDRESS} for "
            f"this computer only, {ANY_ADDRESS} for its whole network)"
        ) from None
    return opened
