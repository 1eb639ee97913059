"""The protocols that faces are sent in, by the names that the command line has for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import needed
from . import livelink, vmc
from .addresses import LOOPBACK
from .frame import LiveFrame


@dataclass(frozen=True)
class Protocol:
    """How faces come in packets.

    title: as people call it. port: where receivers listen unless told. parse: see frame.py.
    packets: what a sender would send: (channels, subject=, frame=) -> packets.
    library: a module that not everybody has installed, "" for none.
    """

    title: str
    port: int
    parse: Callable[[bytes], LiveFrame | None]
    packets: Callable[..., list[bytes]]
    library: str = ""

    def check(self) -> None:
        """Raise UserError where the library is missing."""
        if self.library:
            needed(self.library, self.title, "live", package="python-osc")


PROTOCOLS: Mapping[str, Protocol] = {
    "livelink": Protocol("Live Link Face", livelink.PORT, livelink.parse, livelink.packets),
    "vmc": Protocol("VMC", vmc.PORT, vmc.parse, vmc.packets, library="pythonosc"),
}


@dataclass(frozen=True)
class Listening:
    """Where packets are expected, of which protocol, and how they are taken at first.

    kind: a key of PROTOCOLS. address: the only one that is listened on. port: None for the
    protocol's own. mapping: a table of one's own. gains: "NAME=x" each. mirror: left and right
    change places.
    """

    kind: str
    address: str = LOOPBACK
    port: int | None = None
    mapping: Path | None = None
    gains: tuple[str, ...] = ()
    mirror: bool = False

    @property
    def protocol(self) -> Protocol:
        """What comes there."""
        return PROTOCOLS[self.kind]

    @property
    def chosen_port(self) -> int:
        """The port that is listened on."""
        return self.protocol.port if self.port is None else self.port
