"""What the commands of `risorius bench` have in common: files, figures for programs, errors."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import click

from risorius.app.errors import UserError, in_one_line

from .report import Target

PATH = click.Path(path_type=Path)
FOLDER = click.Path(exists=True, file_okay=False, path_type=Path)
FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
json_option = click.option("--json", "json_file", type=PATH, help="Figures for programs.")


def json_writer(target: Path | None) -> Callable[[object], None]:
    """What writes figures for programs into `target`, if it was given; checked before any work."""
    from risorius.app.files import check_file, save_text

    def save(figures: object) -> None:
        if target is not None:
            save_text(target, json.dumps(figures, indent=1) + "\n")
            click.echo(f"{in_one_line(target)}: written", err=True)

    if target is not None:
        check_file(target)
    return save


def conclude(text: str, targets: Iterable[Target]) -> None:
    """Print a report and what it is held to; end with exit code 1 where a target is missed."""
    targets = list(targets)
    click.echo("\n".join([text, "", *map(str, targets)]))
    if not all(target.is_met for target in targets):
        sys.exit(1)


@contextlib.contextmanager
def told(before: str = "") -> Iterator[None]:
    """Tell the user of a ValueError, with some text before its own."""
    try:
        yield
    except ValueError as error:
        raise UserError(f"{before}{error}") from None


def say_progress(name: str) -> None:
    """Say on the error stream what is at work, where a person looks on."""
    if sys.stderr.isatty():
        click.echo(f"... {name}", err=True)
