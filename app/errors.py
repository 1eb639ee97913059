"""Errors that users can correct: a message of one line, and exit code 2."""

from __future__ import annotations

import contextlib
import os
import sys
import traceback
from collections.abc import Iterator

import click

from .text import in_one_line


class UserError(Exception):
    """Input of the user that cannot be used; the text names fault, place and allowed values.

    trace: the traceback of another process that raised it, if any.
    """

    def __init__(self, text: str, trace: str = "") -> None:
        super().__init__(in_one_line(text))
        self.trace = trace


def traceback_of(error: BaseException) -> str:
    """Return the traceback of an error and of its causes; "" unless RISORIUS_DEBUG is set."""
    if os.environ.get("RISORIUS_DEBUG", "0") in ("", "0"):
        return ""
    one: BaseException | None = error
    while one is not None:
        one.__suppress_context__ = False  # this also shows `raise ... from None`
        one = one.__cause__ or one.__context__
    there = error.trace if isinstance(error, UserError) else ""
    return there + "".join(traceback.format_exception(error))


def line_for(error: Exception) -> str | None:
    """Return the message for an error that the user can correct; None for a defect."""
    from risorius import assets, render  # slow, and not needed without errors

    if isinstance(error, MemoryError):
        return "there is not enough memory for this; choose a smaller size"
    if isinstance(error, UserError | render.GLError | assets.AssetError | OSError):
        return in_one_line(error)
    return None


@contextlib.contextmanager
def report_user_errors() -> Iterator[None]:
    """Turn errors that the user can correct into one line on the error stream and exit code 2."""
    try:
        yield
    except (BrokenPipeError, click.ClickException):  # the reader is gone; click reports errors
        raise
    except Exception as error:
        line = line_for(error)
        if line is None:
            raise
        click.echo(traceback_of(error), err=True, nl=False)
        click.echo(f"risorius: {line}", err=True)
        sys.exit(2)
