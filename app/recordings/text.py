"""The text of a recording, whatever program wrote it: its encoding is found from its bytes."""

from __future__ import annotations

import codecs
import re
from pathlib import Path

from ..errors import UserError
from ..files import read_bytes

LONGEST_FILE = 2**29  # [bytes]; ten minutes of py-feat's 2183 columns are about as long
BEGINNING = 2**16  # [bytes] that tell whether a file is a recording; a header of 2183 names fits
MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
NOT_IN_TEXT = re.compile("[\x00-\x08\x0e-\x1a\x1c-\x1f]")  # characters of no text and no table


def read_recording(path: Path) -> str:
    """The whole text of a file. UserError for what is not there, too long, or no text."""
    content = read_bytes(path, what="recording", longest=LONGEST_FILE)
    if not content.strip():
        raise UserError(f"{path}: is empty; a recording is a table (CSV) or JSON")
    text = decoded(content)
    if text is None:
        raise UserError(
            f"{path}: is not a text file; a recording of a face is a table (CSV) or JSON, no film"
        )
    return text


def read_beginning(path: Path) -> str:
    """The first lines of a file, '' for what is not there or no text."""
    try:
        content = read_bytes(path, what="recording", longest=LONGEST_FILE, first=BEGINNING)
    except UserError:
        return ""
    return decoded(content) or ""


def decoded(content: bytes) -> str | None:
    """The text in these bytes; None where they are no text. What is torn at the end is left out."""
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return _checked(content.decode(encoding, errors="ignore"))
    try:
        return _checked(codecs.getincrementaldecoder("utf-8")().decode(content))
    except UnicodeDecodeError:
        return _checked(content.decode("cp1252", errors="replace"))


def _checked(text: str) -> str | None:
    """The text with line ends of one kind, unless it holds what no text does."""
    if NOT_IN_TEXT.search(text, 0, BEGINNING):
        return None
    return text.replace("\r\n", "\n").replace("\r", "\n")
