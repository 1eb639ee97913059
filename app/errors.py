"""Errors that users can mend: a message of one line, and exit code 2."""

from __future__ import annotations

import contextlib
import os
import sys
import traceback
from collections.abc import Iterator

import click

from .text import in_one_line


class UserError(Exception):
    """An input of the user cannot be used; the text names fault, place and allowed values.

    trace: the traceback of the process in which it was raised, if that was another one.
    """

    def __init__(self, text: str, trace: str = "") -> None:
        super().__init__(in_one_line(text))
        self.trace = trace


def traceback_of(error: BaseException) -> str:
    """The traceback of an error and of its causes, if RISORIUS_DEBUG is set; else ""."""
    if os.environ.get("RISORIUS_DEBUG", "0") in ("", "0"):
        return ""
    one: BaseException | None = error
    while one is not None:
        one.__suppress_context__ = False  # which shows `raise ... from None`, too
        one = one.__cause__ or one.__context__
    there = error.trace if isinstance(error, UserError) else ""
    return there + "".join(traceback.format_exception(error))


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
