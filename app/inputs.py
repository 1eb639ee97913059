"""Files that a user gives, or that anybody may have changed: read whole, or refused in one line.

Only plain files are opened. A pipe nobody writes into would keep the program waiting for ever, a
device like /dev/zero has no end.
"""

from __future__ import annotations

import stat
from pathlib import Path

from .errors import UserError


def read_text(path: Path, *, what: str, longest: int) -> str:
    """The text in a file, UTF-8 with or without a byte order mark, of `longest` bytes at most.

    what: what the file is to be, for error texts ("script"). Raises UserError for what is there
    and of no use, FileNotFoundError where there is nothing.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            kind = "folder" if path.is_dir() else "pipe or a device"
            raise UserError(f"{path}: is a {kind}, not a file; a {what} is a plain file")
        with path.open("rb") as file:
            content = file.read(longest + 1)
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:  # a name that no file can have is a ValueError
        why = getattr(error, "strerror", None) or error
        raise UserError(f"{path}: cannot be read: {why}") from None
    if len(content) > longest:
        raise UserError(f"{path}: is longer than a {what} may be, {longest >> 20} MB")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: cannot be read as a text file: {error}") from None
