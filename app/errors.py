"""The one exception that means: tell the user in one line and stop with exit code 2."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import click

from .stopping import listen

LONGEST_LINE = 2000  # [characters] of a message; the middle of a longer one is left out


def in_one_line(words: object) -> str:
    """Words for the user, in which whatever a terminal would not show as a character is escaped.

    Names come from files and command lines: a line end in one must not begin a line of ours, nor
    may it steer the terminal.
    """
    text = str(words)
    if len(text) > LONGEST_LINE:
        text = f"{text[: LONGEST_LINE // 2]} ... {text[-LONGEST_LINE // 2 :]}"
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


class UserError(Exception):
    """Something the user gave cannot be used; the text says what, where, what is allowed."""

    def __init__(self, text: str) -> None:
        super().__init__(in_one_line(text))


@contextlib.contextmanager
def told_in_one_line() -> Iterator[None]:
    """Turn what the user can mend into one line on the error stream and exit code 2."""
    from risorius import assets, render

    try:
        yield
    except BrokenPipeError:  # nobody reads on: click ends the program without a word
        raise
    except MemoryError:
        click.echo("risorius: there is not enough memory for this; take a smaller size", err=True)
        sys.exit(2)
    except (UserError, render.GLError, assets.AssetError, OSError) as error:
        click.echo(f"risorius: {in_one_line(error)}", err=True)
        sys.exit(2)


def run_alone(main: Callable[[Sequence[str]], None]) -> None:
    """Run a program beside the command, like `risorius.app.sheet`, by the same rules."""
    listen()
    with told_in_one_line():
        main(sys.argv[1:])


class OneLineGroup(click.Group):
    """A command whose mistakes of usage are told in one line, as all others are."""

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the command; the exit code is 2 for what the user can mend."""
        try:
            code = super().main(args, prog_name, complete_var, standalone_mode=False, **extra)
        except click.exceptions.NoArgsIsHelpError as error:  # its message is the help
            click.echo(error.format_message(), err=True)
            sys.exit(2)
        except click.ClickException as error:
            line = in_one_line(" ".join(error.format_message().split()))
            context = getattr(error, "ctx", None)
            where = f"; see {context.command_path} --help" if context else ""
            click.echo(f"risorius: {line.rstrip('.')}{where}", err=True)
            sys.exit(2)
        if standalone_mode:
            sys.exit(code if isinstance(code, int) else 0)
        return code
