"""A recording as packets: what a phone sends, without one.

Protocols carry ARKit's shapes and angles. Action units of other recordings go along as the shapes
that look like them; what has no counterpart is named.
"""

from __future__ import annotations

import re
import socket
import time
from collections.abc import Callable, Iterator, Mapping

from ..errors import UserError, in_one_line
from ..recordings.names import ARKIT, EYE_ANGLES, HEAD_ANGLES
from ..recordings.take import Take
from .protocols import PROTOCOLS, resolved

SHAPES_OF_UNITS = {
    1: "browInnerUp", 2: "browOuterUp", 4: "browDown", 5: "eyeWide", 6: "cheekSquint",
    7: "eyeSquint", 9: "noseSneer", 10: "mouthUpperUp", 12: "mouthSmile", 14: "mouthDimple",
    15: "mouthFrown", 16: "mouthLowerDown", 17: "mouthShrugLower", 18: "mouthPucker",
    20: "mouthStretch", 22: "mouthFunnel", 24: "mouthPress", 26: "jawOpen", 43: "eyeBlink",
    45: "eyeBlink",
}  # fmt: skip
"""The shapes of ARKit that look like action units; those that have two sides without one."""

_UNIT = re.compile(r"AU([0-9]{1,2})(_left|_right)?")
_CARRIED = frozenset((*ARKIT, *HEAD_ANGLES, *EYE_ANGLES))


def carried(take: Take) -> tuple[dict[str, str], tuple[str, ...]]:
    """What of a take can be sent, channel sent -> channel of the take; and the names of the rest.

    Raises UserError where nothing can.
    """
    sources: dict[str, str] = {name: name for name in take.channels if name in _CARRIED}
    left_out = []
    for name in take.channels:
        if name in sources:
            continue
        shapes = _shapes_of(name)
        for shape in shapes:
            sources.setdefault(shape, name)
        if not shapes:
            left_out.append(name)
    if not sources:
        raise UserError(
            f"{in_one_line(take.source)}: {take.kind} has nothing that can be sent, which is "
            "ARKit's shapes, action units, and the turns of head and eyes"
        )
    return sources, tuple(left_out)


def _shapes_of(channel: str) -> tuple[str, ...]:
    """The shapes that look like an action unit, both sides where it does not name one."""
    written = _UNIT.fullmatch(channel)
    stem = SHAPES_OF_UNITS.get(int(written[1])) if written else None
    if stem is None or written is None:
        return ()
    side = (written[2] or "").removeprefix("_").capitalize()
    names = (stem, f"{stem}{side}") if side else (stem, f"{stem}Left", f"{stem}Right")
    return tuple(name for name in names if name in ARKIT)


def frames(take: Take) -> Iterator[tuple[float, Mapping[str, float]]]:
    """Time [s] and channels to send of each frame of a take."""
    sources, _ = carried(take)
    for index, at in enumerate(take.times):
        yield float(at), {name: float(take.channels[of][index]) for name, of in sources.items()}


class Sender:
    """Sends frames to one address in one protocol; a context manager."""

    def __init__(self, kind: str, address: str, port: int | None, subject: str) -> None:
        """kind: of PROTOCOLS. port: None for the protocol's own. UserError for no address."""
        self._protocol = PROTOCOLS[kind]
        self._protocol.check()
        self.port = self._protocol.port if port is None else port
        self._subject, self._sent = subject, 0
        self._target = resolved(address), self.port
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def __enter__(self) -> Sender:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def send(self, channels: Mapping[str, float]) -> float:
        """Send one frame; when it went out [s] by perf_counter. UserError if that cannot be."""
        packets = self._protocol.packets(channels, subject=self._subject, frame=self._sent)
        self._sent += 1
        began = time.perf_counter()
        for packet in packets:
            try:
                self._socket.sendto(packet, self._target)
            except OSError as error:
                raise UserError(
                    f"cannot send to {self._target[0]}, port {self.port}: {error.strerror}"
                ) from None
        return began

    def play(
        self,
        take: Take,
        *,
        is_looping: bool = False,
        clock: Callable[[], float] = time.perf_counter,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Send a take in its own time, once or for ever."""
        ready = list(frames(take))
        last_step = ready[-1][0] / max(len(ready) - 1, 1)
        begin = clock()
        while True:
            for at, channels in ready:
                sleep(max(begin + at - clock(), 0.0))
                self.send(channels)
            if not is_looping:
                return
            begin += ready[-1][0] + max(last_step, 1e-3)
