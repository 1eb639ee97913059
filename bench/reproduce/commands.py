"""The group `risorius reproduce`: the paper's statements, table and figures made anew.

A command for each entry of the table of experiments, and one for all of them.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import click

from risorius.app.errors import in_one_line

from ..report import table
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
    from . import page

    page.check_folder(folder)
    results = []
    for experiment in EXPERIMENTS:
        click.echo(f"... {experiment.title}", err=True)
        results.append(experiment.run())
    page.write(folder, results)
    for result in results:
        click.echo(f"\n{result.experiment.title} ({result.experiment.place})")
        _say(result)
    click.echo(f"\n{in_one_line(folder / page.PAGE)}: written")
    _end(results)


def _command(experiment: Experiment) -> click.Command:
    """The command of an experiment: a picture goes into out/NAME.png unless told."""

    def make(output: Path | None = None, rounds: int | None = None) -> None:
        """Make it, write its picture, and say what came out."""
        from risorius.app.files import check_png, save_png

        if output is not None:
            check_png(output)
        result = experiment.run(rounds=rounds)
        if output is not None and result.outcome.picture is not None:
            save_png(output, result.outcome.picture)
            click.echo(f"{in_one_line(output)}: written")
        _say(result)
        _end([result])

    options: list[click.Parameter] = []
    if experiment.picture:
        default = Path(f"out/{experiment.name}.png")
        options.append(
            click.Option(["-o", "--output"], type=PATH, default=default, show_default=True)
        )
    if experiment.rounds is not None:
        rounds_type = click.IntRange(3, 10_000)
        options.append(
            click.Option(
                ["--rounds"], type=rounds_type, default=experiment.rounds, show_default=True
            )
        )
    return click.Command(experiment.name, params=options, callback=make, help=experiment.about)


for _each in EXPERIMENTS:
    reproduce.add_command(_command(_each))


def _say(result: Result) -> None:
    """Print what an experiment has to say."""
    for text in filter(None, (result.outcome.renderer, result.outcome.text)):
        click.echo(f"{text}\n")
    rows = [
        (each.verdict.value, each.claim.value, each.claim.paper, each.ours, each.allowed)
        for each in result.findings
    ]
    width = max(len(name) for _, name, *_ in rows)
    click.echo("\n".join(table(f":<7|:<{width}|paper:>14|here:>22|allowed:<1", rows)))


def _end(results: Iterable[Result]) -> None:
    """Say what is missed, and end with exit code 1 if anything is."""
    missed = [each for result in results for each in result.missed]
    for each in missed:
        text = f"{each.claim.value} is {each.ours}, allowed: {each.allowed}"
        click.echo(f"risorius: {each.verdict.value}: {text}", err=True)
    if missed:
        sys.exit(1)
