"""The user's files: read whole, but only regular files up to a limit.

A path may lead to an endless pipe, to a device, or to gigabytes, and text may have any encoding.
Readers in other libraries do not check for this, so these functions check first.
"""

import codecs
import os
import stat
import unicodedata
from pathlib import Path, PureWindowsPath

from .errors import AssetError

MOST_FILE_VERTICES = 500_000  # of a mesh, and as many triangles: far more than can be simulated
# Readers split lines and words at more characters than the formats do, and guess encodings. All
# content of the formats is ASCII; other characters only occur in names and remarks.
CONTROL_BYTES = bytes(code for code in (*range(0x20), 0x7F) if code not in b"\t\n\r")
_NO_CONTROLS = bytes.maketrans(
    CONTROL_BYTES, bytes(ord(" " if code in b"\v\f" else "?") for code in CONTROL_BYTES)
)
ASCII_BYTES = bytes(code if code < 0x80 else ord("?") for code in range(256))


def named(path: str | Path) -> str:
    """Return the path as one line of printable characters."""
    text = str(path)
    return text if text.isprintable() else ascii(text)[1:-1]


def path_beside(folder: Path, name: str) -> Path:
    """The path of a file in a folder; raises AssetError for a name that leads out of the folder.

    Letters with marks may be written in two ways (NFC, NFD); the folder's way is used.
    """
    relative = PureWindowsPath(name).as_posix()
    path = folder / relative
    if not name.isascii() and not path.exists():
        paths = [folder / unicodedata.normalize(form, relative) for form in ("NFC", "NFD")]
        path = next((way for way in paths if way.exists()), path)
    is_inside = path.resolve().is_relative_to(folder.resolve())
    if not is_inside or PureWindowsPath(name).is_absolute():
        raise AssetError(f"names the file '{named(name)}'; it must lie in the mesh's folder")
    return path


def read_file(path: str | Path, *, kind: str, most: int) -> bytes:
    """The content of a file, at most `most` megabytes of it.

    kind: the expected kind, for messages ("mesh"). Raises AssetError for a file that is missing,
    empty or too long, and for a device or another thing that is not a regular file.
    """
    try:
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            found = "a folder" if stat.S_ISDIR(status.st_mode) else "a pipe or a device"
            raise AssetError(f"is {found}; it must be a {kind} file")
        megabyte = 1_000_000
        if status.st_size > most * megabyte:
            raise AssetError(
                f"has {status.st_size / megabyte:.3g} MB; a {kind} file may have {most} MB: reduce "
                "it, and keep only the needed part"
            )
        content = Path(path).read_bytes()
    except FileNotFoundError:
        raise AssetError(f"no such {kind} file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise AssetError(f"cannot be read: {reason}; choose another {kind} file") from None
    if not content:
        raise AssetError(f"is empty; it must be a {kind} file")
    if content.startswith((b"\x1f\x8b", b"PK\3\4")):
        raise AssetError(f"is compressed (gzip or zip); unpack the {kind} file that is in it")
    return content


def plain_text(content: bytes) -> bytes:
    r"""Text of any encoding as ASCII, with lines that end in \n; other characters become '?'.

    Raises AssetError for binary data.
    """
    return text_with_names(content).translate(ASCII_BYTES)


def text_with_names(content: bytes) -> bytes:
    r"""Decode UTF-16 (with its mark), UTF-8 or else Latin-1; return UTF-8 with line ends \n.

    Raises AssetError for binary data.
    """
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        content = content.decode("utf-16", "replace").encode()
    content = content.removeprefix(codecs.BOM_UTF8)
    if b"\0" in content:
        raise AssetError("holds binary data where its format has text; save it anew, as text UTF-8")
    try:
        content.decode()
    except UnicodeDecodeError:
        content = content.decode("latin-1").encode()
    return content.translate(_NO_CONTROLS).replace(b"\r\n", b"\n").replace(b"\r", b"\n")
