"""Protocols of live faces, by their names on the command line, and addresses of computers."""

from __future__ import annotations

import socket
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from ..errors import UserError
from ..extras import optional_import
from ..text import in_one_line

if TYPE_CHECKING:
    from .frame import LiveFrame

    Parser = Callable[[bytes], LiveFrame | None]  # see frame.py

LOOPBACK_ADDRESS = "127.0.0.1"
ANY_ADDRESS = "0.0.0.0"


@dataclass(frozen=True)
class Protocol:
    """A protocol that sends faces in packets.

    title: its usual name. port: the usual port of receivers. module: the module of this package
    that holds the parser. library: an optional library that the parser needs, "" for none.
    """

    title: str
    port: int
    module: str
    library: str = ""

    def check(self) -> None:
        """Raise UserError if the library is missing."""
        if self.library:
            optional_import(self.library, self.title, "live", package="python-osc")

    def parser(self) -> Parser:
        """Import the protocol's module, and return its function that reads a packet."""
        parse: Parser = import_module(f"{__package__}.{self.module}").parse
        return parse


PROTOCOLS: Mapping[str, Protocol] = {
    "livelink": Protocol("Live Link Face", 11111, "livelink"),
    "vmc": Protocol("VMC", 39539, "vmc", library="pythonosc"),
}


@dataclass(frozen=True)
class Listening:
    """Address and protocol of expected packets, and their first calibration.

    kind: a key of PROTOCOLS. address: address to listen on. port: None for the usual port of the
    protocol. gains: factors of channels, as "NAME=x". mirror: whether to swap left and right.
    """

    kind: str
    address: str = LOOPBACK_ADDRESS
    port: int | None = None
    gains: tuple[str, ...] = ()
    mirror: bool = False

    @property
    def protocol(self) -> Protocol:
        """The protocol of the packets."""
        return PROTOCOLS[self.kind]

    @property
    def chosen_port(self) -> int:
        """The port to listen on."""
        return self.protocol.port if self.port is None else self.port


def resolved(address: str) -> str:
    """Return the IPv4 address of a computer's name or address; raise UserError if it has none."""
    try:
        if not address or address.startswith("<"):  # the system takes these for all networks
            raise OSError("this is not a name")
        found = socket.getaddrinfo(address, None, socket.AF_INET, socket.SOCK_DGRAM)
        return str(found[0][4][0])
    except (OSError, TypeError, ValueError) as error:  # Python's errors for impossible names
        reason = getattr(error, "strerror", None) or error
        raise UserError(
            f"address {in_one_line(repr(address))}: {reason}; write a computer's name, or its "
            "address, such as 192.168.1.20"
        ) from None


def own_address() -> str:
    """Return this computer's address in the network, or "" if it has none; nothing is sent."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        try:
            documentation_address = "192.0.2.1"  # unused: reserved for documents (RFC 5737)
            asked.connect((documentation_address, 9))  # the system only chooses a route
            return str(asked.getsockname()[0])
        except OSError:
            return ""
