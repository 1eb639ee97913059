"""Messages in one line: errors that users can mend, with exit code 2."""

from __future__ import annotations

import contextlib
import os
import re
import sys
import traceback
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import click


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
    """So many of something, in words: 1 key, 2 keys."""
    return f"1 {noun}" if number == 1 else f"{number} {noun}s"


class UserError(Exception):
    """Something the user gave cannot be used; the text says what, where, and the allowed values.

    trace: the traceback of the process in which it was raised, if that was another one.
    """

    def __init__(self, text: str, trace: str = "") -> None:
        super().__init__(in_one_line(text))
        self.trace = trace


def traceback_of(error: BaseException) -> str:
    """The traceback of an error and of all that led to it, if RISORIUS_DEBUG asks for it; or ""."""
    if os.environ.get("RISORIUS_DEBUG", "0") in ("", "0"):
        return ""
    one: BaseException | None = error
    while one is not None:
        one.__suppress_context__ = False  # which shows `raise ... from None`, too
        one = one.__cause__ or one.__context__
    there = error.trace if isinstance(error, UserError) else ""
    return there + "".join(traceback.format_exception(error))


def needed(module: str, what: str, extra: str, *, package: str | None = None) -> Any:
    """A library that not everybody has installed; UserError, with the cure, where it is missing.

    what: needs it ("--passes"). extra: of this distribution, which brings it. package: what brings
    the module, if it is called otherwise.
    """
    name = f"{what} needs {package or module}"
    try:
        return import_module(module)
    except ModuleNotFoundError:
        raise UserError(f"{name}; install it in the checkout: pip install '.[{extra}]'") from None
    except ImportError as error:  # a library of the system that it stands on, say
        raise UserError(f"{name}, which is installed but does not load: {error}") from None


def line_for(error: Exception) -> str | None:
    """The message for an error that the user can mend; None for a defect."""
    from risorius import assets, render  # slow, and not needed where all goes well

    if isinstance(error, MemoryError):
        return "there is not enough memory for this; take a smaller size"
    if isinstance(error, UserError | render.GLError | assets.AssetError | OSError):
        return in_one_line(error)
    return None


@contextlib.contextmanager
def report_user_errors() -> Iterator[None]:
    """Turn errors that the user can mend into one line on the error stream and exit code 2."""
    try:
        yield
    except (BrokenPipeError, click.ClickException):  # nobody reads on; click reports its own
        raise
    except Exception as error:
        line = line_for(error)
        if line is None:
            raise
        click.echo(traceback_of(error), err=True, nl=False)
        click.echo(f"risorius: {line}", err=True)
        sys.exit(2)
