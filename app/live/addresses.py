"""Addresses of computers: what is typed, and what a phone must be told."""

from __future__ import annotations

import socket

from ..errors import UserError, in_one_line

LOOPBACK = "127.0.0.1"
ANYWHERE = "0.0.0.0"
_ELSEWHERE = "192.0.2.1"  # of nobody: kept free for documents (RFC 5737)


def resolved(address: str) -> str:
    """The IPv4 address of a computer, from its name or address. UserError if there is none."""
    try:
        if not address or address.startswith("<"):  # which the system takes for "all of them"
            raise OSError("that is no name")
        found = socket.getaddrinfo(address, None, socket.AF_INET, socket.SOCK_DGRAM)
        return str(found[0][4][0])
    except (OSError, TypeError, ValueError) as error:  # Python's own, of names too long or odd
        reason = getattr(error, "strerror", None) or error
        raise UserError(
            f"address {in_one_line(repr(address))}: {reason}; write a computer's name, or its "
            "address as 192.168.1.20"
        ) from None


def own_address() -> str:
    """What others in the network call this computer; "" without a network. Nothing is sent."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        try:
            asked.connect((_ELSEWHERE, 9))  # the system only chooses a way
            return str(asked.getsockname()[0])
        except OSError:
            return ""
