"""The `risorius` command; its sub-commands are in commands.py, one short function for each."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Any

import click

from risorius import __version__

from ..compiling_note import announce_compiling
from ..errors import report_user_errors
from ..text import in_one_line
from . import commands


class OneLineGroup(click.Group):
    """A command group that reports each error of the user in one line."""

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the command; the exit code is 2 for an error that the user can correct."""
        try:
            with report_user_errors():
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


@click.group(cls=OneLineGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="risorius")
def main() -> None:
    """Physics-based facial animation with dynamically refined triangle meshes."""
    if sys.stderr is None:  # closed by the parent process; progress bars need it
        sys.stderr = open(os.devnull, "w")
    announce_compiling()


for command in commands.ALL_COMMANDS:
    main.add_command(command)
