"""The output of all commands of `risorius bench`: tables, targets, and the processor's name."""

from __future__ import annotations

import platform
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import click


def table(columns: str, rows: Iterable[Sequence[object]], *, indent: str = "") -> list[str]:
    """Lines of a table, with the titles first; None gives an empty cell.

    columns: "title:format" with the width first, as in "name:<9|ms:8.3f"; "<" aligns text left.
    """
    parts = [column.rsplit(":", 1) for column in columns.split("|")]
    titles, formats = zip(*parts, strict=True)
    sides = [re.findall(r"^[<>]?\d+", each)[0] for each in formats]
    sides = [side if side[0] in "<>" else f">{side}" for side in sides]
    headings = [f"{title:{side}}" for title, side in zip(titles, sides, strict=True)]
    lines = [" ".join(headings)]
    for row in rows:
        cells = [
            f"{'':{side}}" if value is None else f"{value:{style}}"
            for value, style, side in zip(row, formats, sides, strict=True)
        ]
        lines.append(" ".join(cells))
    return [(indent + line).rstrip() for line in lines]


class Target(NamedTuple):
    """A bound on a result, as text, and whether the result meets it."""

    text: str
    is_met: bool

    def __str__(self) -> str:
        return f"  {'met   ' if self.is_met else 'MISSED'}  {self.text}"


def at_most(name: str, value: float, most: float, unit: str = "") -> Target:
    """The target that `value` is at most `most`; NaN misses it."""
    return Target(f"{name}: {value:.4g}{unit}, at most {most:g}{unit}", value <= most)


def at_least(name: str, value: float, least: float, unit: str = "") -> Target:
    """The target that `value` is at least `least`; NaN misses it."""
    return Target(f"{name}: {value:.4g}{unit}, at least {least:g}{unit}", value >= least)


def conclude(text: str, targets: Iterable[Target]) -> None:
    """Print a report and its targets; end with exit code 1 if a target is missed."""
    targets = list(targets)
    click.echo("\n".join([text, "", *map(str, targets)]).rstrip())
    if not all(target.is_met for target in targets):
        sys.exit(1)


def print_progress(name: str) -> None:
    """Print the name of the current step to the error stream, if the stream is a terminal."""
    if sys.stderr.isatty():
        click.echo(f"... {name}", err=True)


def processor() -> str:
    """The name of this machine's processor."""
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
