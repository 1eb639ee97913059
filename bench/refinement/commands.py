"""Commands of `risorius bench` that measure refinement: `refine`, `quality`."""

from __future__ import annotations

from collections.abc import Collection
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import click

from risorius.app.cli.parameters import FiniteRange
from risorius.app.errors import UserError, in_one_line

from ..command_line import FOLDER, conclude, json_option, json_writer, say_progress, told
from ..report import Target

if TYPE_CHECKING:
    from ..subjects import Subject

MESHES = ("face", "2k", "20k", "200k", "1M")


@click.command("refine")
@click.option(
    "--size",
    "sizes",
    type=click.Choice(MESHES),
    multiple=True,
    help="Only this mesh; may be given several times. Unless told: all but 2k.",
)
@click.option(
    "--seconds",
    type=FiniteRange(0.05, 600.0),
    default=7.0,
    show_default=True,
    help="How long each mesh is timed, at least five rounds.",
)
@json_option
def bench_refine(sizes: tuple[str, ...], seconds: float, json_file: Path | None) -> None:
    """Time refinement on the face and on meshes of up to a million triangles, beside peers."""
    from . import refine, refine_report

    save = json_writer(json_file)
    report = refine.measure(
        sizes=sizes or refine.SIZES, seconds=seconds, starts=not sizes, progress=say_progress
    )
    click.echo(refine_report.text(report))
    save(refine_report.figures(report))


@click.command("quality")
@click.option(
    "--reference",
    type=FOLDER,
    help="A folder with face.npz and coarse_2029.npz: scans and their decimation.",
)
@click.option(
    "--finer",
    type=click.Choice(["4", "16", "none"]),
    default="16",
    show_default=True,
    help="The built-in head with so many times its triangles as the truth.",
)
@click.option(
    "--expression", "expressions", multiple=True, help="Only this one; may be given several times."
)
def bench_quality(reference: Path | None, finer: str, expressions: tuple[str, ...]) -> None:
    """Measure how near every scheme comes to a dense face and its picture, for what it spends."""
    from . import quality, quality_report

    targets: list[Target] = []
    measured = _subjects(reference, finer, expressions)
    for _, members in groupby(measured, lambda subject: subject.group):
        together = list(members)
        scores = [
            score
            for subject in together
            for score in quality.measure(
                subject, expressions=expressions or None, progress=say_progress
            )
        ]
        click.echo(quality_report.text(together[0], scores) + "\n")
        targets += quality_report.targets(together[0].group, scores)
    conclude(quality_report.LEGEND, targets)


def _subjects(reference: Path | None, finer: str, expressions: Collection[str]) -> list[Subject]:
    """Whom to measure in these expressions, or in all; UserError where there is nobody."""
    from risorius import assets

    from .. import subjects

    found: list[Subject] = []
    if reference is not None:
        with told():
            found += subjects.scanned(reference)
    known = dict.fromkeys(name for subject in found for name in subject.poses)
    of_head = assets.load("head").expressions if finer != "none" else {}
    known |= dict.fromkeys(of_head)
    if not known:
        raise UserError("nothing to measure: give --reference FOLDER, or --finer 4 or 16")
    for name in expressions:
        if name not in known:
            raise UserError(f"--expression {in_one_line(name)}: there are {', '.join(known)}")
    asked = set(expressions or known)
    found = [subject for subject in found if asked & set(subject.poses)]
    if asked & set(of_head):  # building it takes ten seconds
        found.append(subjects.built_in({"4": 1, "16": 2}[finer]))
    return found


COMMANDS = (bench_refine, bench_quality)
