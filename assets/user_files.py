"""Files that somebody brings: read whole, but only if they are files and no longer than allowed.

A path may lead to a pipe that never ends, to a device, or to gigabytes; and text may come in any
encoding. Nothing of that may reach a reader that trusts its file.
"""

import codecs
import os
import stat
from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType

import numpy as np

from .errors import AssetError

# Of text: numbers take five times as much memory while they are read. The largest head as text STL,
# the longest there is, has a quarter of it.
MOST_TEXT = 50_000_000  # [bytes]
MOST_LINES = 2_000_000
LONGEST_LINE = 2**20  # [bytes]: a polygon of a hundred thousand corners
MOST_VERTICES = 500_000  # of a mesh, and as many triangles: far beyond what can be simulated
NO_FILES: tuple[tuple[Callable[[int], bool], str], ...] = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
)
PACKED = MappingProxyType(  # how the content begins -> what it is
    {
        b"\x1f\x8b": "gzip",
        b"PK\x03\x04": "zip",
        b"BZh": "bzip2",
        b"\xfd7zXZ\x00": "xz",
        b"7z\xbc\xaf\x27\x1c": "7z",
        b"(\xb5/\xfd": "zstd",
    }
)
# Readers split lines and words at more characters than the formats do, and guess at encodings.
# All that the formats mean is ASCII; anything else is in names and remarks, which are not read.
_PLAIN = bytes(
    code if 0x20 <= code < 0x7F or code in b"\t\n\r" else ord(" " if code in b"\v\f" else "?")
    for code in range(256)
)


def named(path: str | Path) -> str:
    """The path as one line that any screen can show."""
    text = str(path)
    return text if text.isprintable() else ascii(text)[1:-1]


def read_file(path: str | Path, *, kind: str, most_bytes: int, cure: str) -> bytes:
    """The content of a file, at most `most_bytes` of it.

    kind: what it is to be, for messages ("mesh"); cure: what to do if it is too long. Raises
    AssetError for a file that is missing, empty, too long, packed, or no file but a device, say.
    """
    try:
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            found = next((text for is_it, text in NO_FILES if is_it(status.st_mode)), "a device")
            raise AssetError(f"is {found}; it must be a {kind} file")
        length = status.st_size
        if length <= most_bytes:
            with open(path, "rb") as file:
                content = file.read(most_bytes + 1)
            length = len(content)
    except FileNotFoundError:
        raise AssetError(f"no such {kind} file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise AssetError(f"cannot be read: {reason}; choose another {kind} file") from None
    if length > most_bytes:
        raise AssetError(
            f"has {size_text(length)}; a {kind} file may have {size_text(most_bytes)}: {cure}"
        )
    if not content:
        raise AssetError(f"is empty; it must be a {kind} file")
    for beginning, packer in PACKED.items():
        if content.startswith(beginning):
            raise AssetError(f"is packed ({packer}); unpack it and give the {kind} file in it")
    return content


def size_text(count: int) -> str:
    """A number of bytes to read: 12 kB, 3.4 MB."""
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size:
            return f"{count / size:.3g} {unit}" if count < 1000 * size else f"{count / size:.0f} GB"
    return f"{count} bytes"


def plain_text(content: bytes) -> bytes:
    r"""Text of any encoding as ASCII whose lines end in \n; what is not ASCII becomes '?'.

    Raises AssetError for binary data, and for too much of text, too many or too long lines.
    """
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        content = content.decode("utf-16", "replace").encode("ascii", "replace")
    content = content.removeprefix(codecs.BOM_UTF8)
    if b"\0" in content:
        raise AssetError("holds binary data where its format has text; save it anew, as text UTF-8")
    content = content.translate(_PLAIN).replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    ends = np.flatnonzero(np.frombuffer(content, np.uint8) == ord("\n"))
    lengths = np.diff(ends, prepend=-1, append=len(content)) - 1
    for what, found, most in (
        ("bytes of text", len(content), MOST_TEXT),
        ("lines", len(ends), MOST_LINES),
        (f"bytes in line {lengths.argmax() + 1}", int(lengths.max()), LONGEST_LINE),
    ):
        if found > most:
            raise AssetError(
                f"has {found} {what}; allowed are {most}: reduce it in a modelling program, or cut "
                "its polygons into triangles"
            )
    return content
