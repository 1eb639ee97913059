"""`risorius reproduce`: repeat the paper's table and figures on a page."""

from __future__ import annotations

import datetime
import os
import platform
import sys
from collections.abc import Sequence
from html import escape
from pathlib import Path

import click

from risorius import __version__
from risorius.app.text import in_one_line

from ..report import print_progress, processor, table
from .experiments import EXPERIMENTS, ExperimentResult

PATH_TYPE = click.Path(path_type=Path)


@click.command()
@click.argument(
    "names",
    nargs=-1,
    required=True,
    type=click.Choice(["all", *(experiment.name for experiment in EXPERIMENTS)]),
)
@click.option(
    "-o",
    "--output",
    "folder",
    type=PATH_TYPE,
    default=Path("out/reproduce"),
    show_default=True,
    help="The folder to write.",
)
@click.option("--rounds", type=click.IntRange(3, 10_000), help="Rounds of timing; by default 60.")
def reproduce(names: tuple[str, ...], folder: Path, rounds: int | None) -> None:
    """Repeat the paper's figures and table, all or some, in a folder.

    The names are figure8, figure9, figure10, coarse and table1. index.html in the folder shows the
    results in the paper's order. The exit code is 1 if a tolerance is missed.
    """
    from risorius.app.files import check_file, save_text
    from risorius.app.pictures import save_png

    chosen = [each for each in EXPERIMENTS if each.name in names or "all" in names]
    page = "index.html"
    for name in (page, *(f"{each.name}.png" for each in chosen if each.picture)):
        check_file(folder / name)
    results = []
    for experiment in chosen:
        print_progress(experiment.title)
        results.append(experiment.run(rounds=rounds))
    for result in results:
        if result.outcome.picture is not None:
            save_png(folder / f"{result.experiment.name}.png", result.outcome.picture)
        click.echo(f"\n{result.experiment.title} ({result.experiment.place})\n{_text(result)}")
    save_text(folder / page, _page(results))
    click.echo(f"\n{in_one_line(folder / page)}: written")
    missed = [each for result in results for each in result.missed]
    for claim, measured in missed:
        text = f"{claim.value} is {claim.ours(measured)}, allowed: {claim.allowed}"
        click.echo(f"risorius: MISSED: {text}", err=True)
    if missed:
        sys.exit(1)


def _text(result: ExperimentResult) -> str:
    """The report of an experiment."""
    rows = [
        (claim.verdict(x), claim.value, claim.paper, claim.ours(x), claim.allowed)
        for claim, x in result.findings
    ]
    width = max(len(name) for _, name, *_ in rows)
    columns = f":<7|:<{width}|paper:>14|here:>9|allowed:<1"
    reasons = [
        f"{claim.value} differs: {claim.differs}" for claim, _ in result.findings if claim.differs
    ]
    above = [result.outcome.text] if result.outcome.text else []
    return "\n".join([*above, *table(columns, rows), *reasons])


def _page(results: Sequence[ExperimentResult]) -> str:
    """All results on one HTML page; it loads the pictures from its own folder."""
    findings = [finding for result in results for finding in result.findings]
    met = sum(claim.verdict(measured) == "met" for claim, measured in findings)
    made = (
        f"Risorius {__version__}, Python {platform.python_version()}, "
        f"{datetime.datetime.now().astimezone():%Y-%m-%d %H:%M %Z}, "
        f"{os.cpu_count()} cores of {processor()}, {platform.system()} {platform.machine()}"
    )
    title = "Dynamically refined animated triangle meshes, repeated"
    about = """\
Kähler, Haber, Seidel 2003 (doi 10.1007/s00371-002-0185-8), in the order of the paper: its numbers,
and those that this program measures. Times are medians. Met: the number lies within the tolerance;
where the paper gives no number, the tolerance is ours. Differs: the number differs from the paper,
and the reason is below the table. MISSED: the number lies outside. A level is 1/255 of the
brightness of a channel. docs/the_paper_in_code.md has file and function of each statement of
section 4."""
    style = (
        "body { max-width: 80rem; margin: auto } img { max-width: 100% } pre { overflow-x: auto }"
    )
    lines = [
        f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>{title}</title>',
        f"<style>{style}</style><h1>{title}</h1><p>{escape(about)}</p>",
        f"<p>{met} of {len(findings)} statements are met. {escape(made)}</p>",
    ]
    for result in results:
        each = result.experiment
        lines.append(f"<h2>{escape(each.title)} ({each.place})</h2>")
        lines += [
            f"<p>{escape(claim.value)}: {escape(claim.statement)}</p>" for claim in each.claims
        ]
        if result.outcome.picture is not None:
            lines.append(f'<img src="{each.name}.png" alt="{escape(each.title)}">')
        lines.append(f"<pre>{escape(_text(result))}\n\nrisorius reproduce {each.name}</pre>")
    return "\n".join([*lines, ""])
