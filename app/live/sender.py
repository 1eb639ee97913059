"""Sending of a recording in packets of Live Link Face, as a phone sends them."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable, Mapping

from ..errors import UserError
from ..recordings.names import ARKIT_SHAPES, EYE_ANGLES, HEAD_ANGLES
from ..recordings.take import Take
from ..text import in_one_line
from .livelink import packet_of
from .protocols import PROTOCOLS, resolved

CARRIED_NAMES = frozenset((*ARKIT_SHAPES, *HEAD_ANGLES, *EYE_ANGLES))


class Sender:
    """Sends frames to one address; a context manager."""

    def __init__(self, address: str, port: int | None, subject: str) -> None:
        """port: None for the protocol's usual port. Raises UserError for an invalid address."""
        self.port = PROTOCOLS["livelink"].port if port is None else port
        self._subject = subject
        self._sent = 0
        self._target = (resolved(address), self.port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def __enter__(self) -> Sender:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def send(self, channels: Mapping[str, float]) -> None:
        """Send one frame; raise UserError if this fails."""
        packet = packet_of(channels, subject=self._subject, frame=self._sent)
        self._sent += 1
        try:
            self._socket.sendto(packet, self._target)
        except OSError as error:
            raise UserError(
                f"cannot send to {self._target[0]}, port {self.port}: {error.strerror}"
            ) from None

    def play(
        self,
        take: Take,
        *,
        is_looping: bool = False,
        clock: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Send a take at its own speed, once or forever.

        Raises UserError if the take has no channel that can be sent.
        """
        channels = {name: values for name, values in take.channels.items() if name in CARRIED_NAMES}
        if not channels:
            raise UserError(
                f"{in_one_line(take.source)}: {take.kind} has no values to send; Live Link "
                "Face sends ARKit's shapes, and the turns of head and eyes"
            )
        last_step = take.duration / max(len(take.times) - 1, 1)
        begin = clock()
        while True:
            for row, at in enumerate(take.times.tolist()):
                sleep(max(begin + at - clock(), 0.0))
                self.send({name: float(values[row]) for name, values in channels.items()})
            if not is_looping:
                return
            begin += take.duration + max(last_step, 1e-3)
