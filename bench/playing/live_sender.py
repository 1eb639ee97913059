"""The other side of `risorius bench live`: a process that sends moving faces with numbers.

It imports no more than it needs, as it starts anew for each round.
"""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection

import numpy as np

from risorius.app.live import LOOPBACK
from risorius.app.live.sender import Sender
from risorius.app.recordings.names import ARKIT

RATE = 60.0  # frames a second
DEGREES = 0.01  # of head yaw that count as one frame
SETTLING = 0.5  # [s] at the start of a round that are not counted
STARTING = 60.0  # [s] that the process may take to begin


class Sent:
    """What the sending process tells: whether it has ended, and then when it sent which frame."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self.times: dict[int, float] = {}

    @property
    def is_over(self) -> bool:
        """Whether it has ended."""
        if not self.times and self._connection.poll():
            self.times = self._connection.recv()
        return bool(self.times)


@contextmanager
def sending(kind: str, port: int, seconds: float) -> Iterator[Sent]:
    """A process that sends for so long."""
    context = multiprocessing.get_context("spawn")
    ours, others = context.Pipe()
    process = context.Process(
        target=_send_numbered, args=(kind, port, seconds, others), daemon=True
    )
    process.start()
    try:
        if not ours.poll(STARTING):
            raise RuntimeError("the process that sends did not begin")
        ours.recv()
        yield Sent(ours)
    finally:
        process.terminate()
        process.join()


def _send_numbered(kind: str, port: int, seconds: float, connection: Connection) -> None:
    """Send moving faces with numbers, then tell when each was sent."""
    sent: dict[int, float] = {}
    with Sender(kind, LOOPBACK, port, "bench") as sender:
        connection.send("ready")
        begin = time.perf_counter()
        for number in range(1, round((seconds + SETTLING) * RATE)):
            time.sleep(max(begin + number / RATE - time.perf_counter(), 0.0))
            wave = 0.5 - 0.5 * np.cos(0.1 * number + np.arange(len(ARKIT)))
            channels = {name: float(value) for name, value in zip(ARKIT, wave, strict=True)}
            channels["head_yaw"] = DEGREES * number
            sent[number] = sender.send(channels)
    time.sleep(0.2)  # the last frames are on their way
    connection.send(sent)
