"""The one exception that means: tell the user in one line and stop with exit code 2."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator

import click


class UserError(Exception):
    """Something the user gave cannot be used; the text says what, where, what is allowed."""


@contextlib.contextmanager
def told_in_one_line() -> Iterator[None]:
    """Turn what the user can mend into one line on the error stream and exit code 2."""
    import assets
    import render

    try:
        yield
    except (UserError, render.GLError, assets.AssetError, OSError) as error:
        click.echo(f"risorius: {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        click.echo("risorius: stopped", err=True)
        sys.exit(130)
