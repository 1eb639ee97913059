"""The group of commands whose mistakes are told in one line."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import click

from ..errors import in_one_line, told_in_one_line


class OneLineGroup(click.Group):
    """A command whose mistakes, of usage and of all that it works on, are told in one line."""

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
            with told_in_one_line():
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
