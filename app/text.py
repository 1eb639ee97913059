"""Names and numbers as messages show them: on one line, without codes that steer a terminal."""

from __future__ import annotations

import re


def in_one_line(message: object) -> str:
    """A message, with every code escaped that a terminal does not show as a character.

    Names come from files and command lines: a line end in one must not begin a line of ours, nor
    may it steer the terminal.
    """
    text = as_text(message)
    longest_line = 2000  # [characters] of a message; the middle of a longer one is left out
    if len(text) > longest_line:
        text = f"{text[: longest_line // 2]} ... {text[-longest_line // 2 :]}"
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


def as_text(name: object) -> str:
    """A name as it can be printed, and written into a file of UTF-8.

    Names of files are bytes: one that is no UTF-8, from an old archive say, is read as characters
    that no encoding has. Such bytes become \\xe4.
    """
    raw_byte = re.compile("[\udc80-\udcff]")  # of a name that is no UTF-8, as Python reads it
    text = raw_byte.sub(lambda found: f"\\x{ord(found[0]) - 0xDC00:02x}", str(name))
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def counted(number: int, noun: str) -> str:
    """This many of something, in words: 1 key, 2 keys."""
    return f"1 {noun}" if number == 1 else f"{number} {noun}s"
