"""Sub-commands about refinement: `bench refine`, `quality`, the group `reproduce`, and `warm`.

Each is joined to its group in cli.py. What is slow to import is imported inside.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .errors import UserError, in_one_line, told_in_one_line
from .parameters import FiniteRange

if TYPE_CHECKING:
    from .outputs import Frame

SIZES = ("face", "2k", "20k", "200k", "200k shuffled", "1M", "1M shuffled")
Command = Callable[..., Any]


@click.command("refine")
@click.option(
    "--size",
    "sizes",
    type=click.Choice(SIZES),
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
@click.option("--json", "json_file", type=click.Path(path_type=Path), help="Figures for programs.")
def bench_refine(sizes: tuple[str, ...], seconds: float, json_file: Path | None) -> None:
    """Time refinement on the face and on sheets of up to a million triangles, beside peers."""
    from risorius.bench.refine import SIZES as ALL_SIZES
    from risorius.bench.refine import run

    from .outputs import check_file, save_text
    from .refine_report import refine_json, refine_text

    with told_in_one_line():
        if json_file is not None:
            check_file(json_file)
        report = run(sizes=sizes or ALL_SIZES, seconds=seconds, starts=not sizes, progress=progress)
        click.echo(refine_text(report))
        if json_file is not None:
            save_text(json_file, refine_json(report))
            click.echo(f"{in_one_line(json_file)}: written", err=True)


@click.command("quality")
@click.option(
    "--reference",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="A folder with face.npz and coarse_2029.npz: scans and their decimation.",
)
@click.option(
    "--finer",
    type=click.Choice(["4", "16", "none"]),
    default="16",
    show_default=True,
    help="The built-in head with so many times its triangles as the truth.",
)
@click.option("--apart", is_flag=True, help="Left and right halves of scans, each for itself.")
@click.option(
    "--curves",
    type=click.Path(path_type=Path),
    help="NAME.png: error over triangles, as NAME_SUBJECT_RULE.png.",
)
def bench_quality(reference: Path | None, finer: str, apart: bool, curves: Path | None) -> None:
    """Measure how near every scheme comes to a dense face, for the triangles it spends."""
    from risorius.bench import quality
    from risorius.bench.subjects import Subject, built_in, scanned

    from .outputs import check_picture, save_png
    from .quality_report import error_curves, quality_table, rules_table, targets_text

    with told_in_one_line():
        if curves is not None:
            check_picture(curves)
        subjects: list[Subject] = []
        try:
            if reference is not None:
                subjects.append(scanned(reference, apart=apart))
        except ValueError as error:
            raise UserError(str(error)) from None
        if finer != "none":
            subjects.append(built_in({"4": 1, "16": 2}[finer]))
        if not subjects:
            raise UserError("nothing to measure: give --reference FOLDER, or --finer 4 or 16")
        for subject in subjects:
            budgets = quality.CURVE_BUDGETS if curves is not None else quality.BUDGETS
            scores = quality.run(subject, budgets=budgets, progress=progress)
            title = (
                f"{subject.name}: {len(subject.coarse_faces)} triangles against "
                f"{len(subject.dense_faces)}"
            )
            click.echo(quality_table(title, scores) + "\n\n" + rules_table(scores) + "\n")
            click.echo(targets_text(scores) + "\n")
            if curves is None:
                continue
            for rule in quality.RULES:
                name = f"{curves.stem}_{subject.name}_{rule}".replace(" ", "_").replace(",", "")
                target = curves.with_stem(name)
                save_png(target, error_curves(f"{title}, split by {rule}", scores, rule))
                click.echo(f"{in_one_line(target)}: written", err=True)


@click.group()
def reproduce() -> None:
    """Make the paper's table and figures anew."""


@reproduce.command("table1")
@click.option("--rounds", type=click.IntRange(3, 10_000), default=60, show_default=True)
def table1(rounds: int) -> None:
    """Print Table 1 of the paper beside our own figures."""
    from .table1 import table_1, table_1_text

    with told_in_one_line():
        measured, renderer = table_1(rounds=rounds)
        click.echo(table_1_text(measured, renderer))


def picture_option(name: str) -> Callable[[Command], Command]:
    """Where a picture goes: out/NAME.png unless told."""
    return click.option(
        "-o",
        "--output",
        type=click.Path(path_type=Path),
        default=Path(f"out/{name}.png"),
        show_default=True,
    )


@reproduce.command("figure9")
@picture_option("figure9")
def figure9(output: Path) -> None:
    """Draw the plane: static and refined, flat and Gouraud shaded."""
    from .paper_figures import figure_9

    _draw(output, figure_9)


@reproduce.command("figure10")
@picture_option("figure10")
def figure10(output: Path) -> None:
    """Draw the region of the mouth: static and refined."""
    from .paper_figures import figure_10

    _draw(output, figure_10)


@reproduce.command("coherence")
@picture_option("coherence")
def coherence(output: Path) -> None:
    """Draw a film strip of a growing wave, with and without memory of the splits."""
    from .strip import coherence_strip

    _draw(output, coherence_strip)


def _draw(output: Path, picture: Callable[[], Frame]) -> None:
    from .outputs import check_picture, save_png

    with told_in_one_line():
        check_picture(output)
        save_png(output, picture())
        click.echo(f"{in_one_line(output)}: written")


def progress(name: str) -> None:
    """Say on the error stream what is at work, where a person looks on."""
    if sys.stderr.isatty():
        click.echo(f"... {name}", err=True)


@click.command()
@click.option("--quiet", is_flag=True, help="No progress bar.")
def warm(quiet: bool) -> None:
    """Compile everything once, so that no later start has to."""
    from .compiling import warm as compile_all

    with told_in_one_line():
        compile_all(quiet)
