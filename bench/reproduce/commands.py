"""The group `risorius reproduce`: the paper's statements, table and figures made anew.

A command for each entry of the table of experiments, and one for all of them.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import click

from risorius.app.errors import in_one_line

from .experiments import EXPERIMENTS, Experiment, Result

PATH = click.Path(path_type=Path)


@click.group()
def reproduce() -> None:
    """Make what the paper shows and says anew.

    The exit code is 1 where a tolerance is missed.
    """


@reproduce.command("all")
@click.option(
    "-o", "--output", "folder", type=PATH, default=Path("out/reproduce"), show_default=True
)
def reproduce_all(folder: Path) -> None:
    """Make everything, and a page that shows it in the paper's order: index.html in a folder."""
    from .reproduction import PAGE, check_folder, reproduce

    check_folder(folder)
    results = reproduce(folder, progress=lambda title: click.echo(f"... {title}", err=True))
    for result in results:
        click.echo(f"\n{result.experiment.title} ({result.experiment.place})")
        _say(result)
    click.echo(f"\n{in_one_line(folder / PAGE)}: written")
    _end(results)


def _add(experiment: Experiment) -> None:
    """Add the command of an experiment: a picture goes into out/NAME.png unless told."""

    def make(output: Path | None = None, rounds: int | None = None) -> None:
        """Make it, write its picture, and say what came out."""
        from risorius.app.files import check_png, save_png

        if output is not None:
            check_png(output)
        result = experiment.run(rounds=rounds)
        if output is not None:
            save_png(output, result.outcome.pictures[experiment.name])
            click.echo(f"{in_one_line(output)}: written")
        _say(result)
        _end([result])

    options: list[click.Parameter] = []
    if experiment.has_picture:
        default = Path(f"out/{experiment.name}.png")
        options.append(
            click.Option(["-o", "--output"], type=PATH, default=default, show_default=True)
        )
    if experiment.rounds is not None:
        options.append(
            click.Option(
                ["--rounds"],
                type=click.IntRange(3, 10_000),
                default=experiment.rounds,
                show_default=True,
            )
        )
    command = click.Command(experiment.name, params=options, callback=make, help=experiment.about)
    reproduce.add_command(command)


for _each in EXPERIMENTS:
    _add(_each)


def _say(result: Result) -> None:
    """Print what an experiment has to say."""
    from ..report import table

    outcome = result.outcome
    if outcome.renderer:
        click.echo(f"{outcome.renderer}\n")
    if outcome.text:
        click.echo(f"{outcome.text}\n")
    rows = [
        (each.verdict.value, each.claim.value, each.claim.expected, each.ours, each.allowed)
        for each in result.findings
    ]
    width = max((len(name) for _, name, *_ in rows), default=0)
    for line in table(f":<7|:<{width}|paper:>14|here:>22|allowed:<1", rows) if rows else ():
        click.echo(line)


def _end(results: Iterable[Result]) -> None:
    """Say what is missed, and end with exit code 1 if anything is."""
    missed = [each for result in results for each in result.missed]
    for each in missed:
        text = f"{each.claim.value} is {each.ours}, allowed: {each.allowed}"
        click.echo(f"risorius: {each.verdict.value}: {text}", err=True)
    if missed:
        sys.exit(1)
