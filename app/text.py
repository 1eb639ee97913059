"""Names and numbers for messages: on one line, without control codes of a terminal."""

from __future__ import annotations

import re


def in_one_line(message: object) -> str:
    """Return a message on one line, in which all unprintable characters are escaped.

    Names come from files and command lines: a line end in a name must not begin a new line, and no
    code may control the terminal.
    """
    text = as_text(message)
    longest_line = 2000  # [characters] of a message; a longer one loses its middle
    if len(text) > longest_line:
        text = f"{text[: longest_line // 2]} ... {text[-longest_line // 2 :]}"
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


def as_text(name: object) -> str:
    """Return a name in a form that can be printed, and written as UTF-8.

    Names of files are bytes. If they are not UTF-8, for example from an old archive, Python reads
    them as characters that cannot be encoded. This function writes such a byte as \\xe4.
    """
    raw_byte = re.compile("[\udc80-\udcff]")  # in names that are not UTF-8
    text = raw_byte.sub(lambda found: f"\\x{ord(found[0]) - 0xDC00:02x}", str(name))
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: 1 key, 2 keys."""
    return f"1 {noun}" if number == 1 else f"{number} {noun}s"
