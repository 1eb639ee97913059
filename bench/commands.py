"""The group `risorius bench`: measurements.

What is slow to import is imported inside.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Callable, Collection, Iterator
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import click

from risorius.app.cli.parameters import FiniteRange, Size
from risorius.app.errors import UserError, in_one_line

if TYPE_CHECKING:
    from .subjects import Subject

MESHES = ("face", "2k", "20k", "200k", "200k shuffled", "1M", "1M shuffled")
PATH = click.Path(path_type=Path)
FOLDER = click.Path(exists=True, file_okay=False, path_type=Path)
FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
json_option = click.option("--json", "json_file", type=PATH, help="Figures for programs.")


@click.group()
def bench() -> None:
    """Measure; each command prints its figures and how they were taken."""


@bench.command("refine")
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

    save = _json(json_file)
    report = refine.measure(
        sizes=sizes or refine.SIZES, seconds=seconds, starts=not sizes, progress=_progress
    )
    click.echo(refine_report.text(report))
    save(refine_report.figures(report))


@bench.command("quality")
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
@click.option("--apart", is_flag=True, help="Left and right halves of scans, each for itself.")
@click.option(
    "--expression", "expressions", multiple=True, help="Only this one; may be given several times."
)
@click.option(
    "--curves", type=PATH, help="NAME.png: errors over triangles, as NAME_SUBJECT_MEASURE.png."
)
def bench_quality(
    reference: Path | None,
    finer: str,
    apart: bool,
    expressions: tuple[str, ...],
    curves: Path | None,
) -> None:
    """Measure how near every scheme comes to a dense face and its picture, for what it spends."""
    from risorius.app.files import check_png, save_png

    from . import quality, quality_report

    if curves is not None:
        check_png(curves)
    measured = _subjects(reference, finer, apart, expressions)
    budgets = quality.BUDGETS if curves is None else quality.CURVE_BUDGETS
    found: dict[str, list[quality.Score]] = {}
    for group, members in groupby(measured, lambda subject: subject.group):
        together = list(members)
        scores = found[group] = [
            score
            for subject in together
            for score in quality.measure(
                subject, budgets=budgets, expressions=expressions or None, progress=_progress
            )
        ]
        click.echo(quality_report.text(together, scores) + "\n")
        if curves is None:
            continue
        for what, _, _ in quality_report.MEASURED:
            target = curves.with_stem(f"{curves.stem}_{group}_{what}".replace(" ", "_"))
            save_png(target, quality_report.error_curves(together[0], scores, what))
            click.echo(f"{in_one_line(target)}: written", err=True)
    click.echo(f"{quality_report.LEGEND}\n")
    click.echo(quality_report.targets_text(found))


def _subjects(
    reference: Path | None, finer: str, apart: bool, expressions: Collection[str]
) -> list[Subject]:
    """Whom to measure in these expressions, or in all; UserError where there is nobody."""
    from risorius import assets

    from . import subjects

    found: list[Subject] = []
    if reference is not None:
        with _told():
            found += subjects.scanned(reference, apart=apart)
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


@bench.command("simulate")
@click.option("--rounds", type=click.IntRange(1, 100_000), default=100, show_default=True)
def bench_simulate(rounds: int) -> None:
    """Time a 60 Hz frame of the simulation: the head, and plain meshes up to 100k vertices."""
    from . import simulate

    click.echo(simulate.report(simulate.measure(rounds=rounds), rounds))


@bench.command("motion")
@click.option(
    "--reference",
    type=FOLDER,
    required=True,
    help="a folder with face.npz: vertices, triangles, landmarks68, displacement fields",
)
def bench_motion(reference: Path) -> None:
    """Compare simulated with scanned skin motion, shape by shape."""
    from . import motion

    with _told("--reference: "):
        click.echo(motion.report(*motion.measure(reference)))


@bench.command("seen")
@click.option(
    "--model",
    type=FILE,
    required=True,
    help="face_landmarker.task, the model of MediaPipe's face landmarker.",
)
@click.option(
    "--reference", type=FOLDER, help="A folder with face.npz: scans, to be shown as well."
)
@click.option(
    "--take", type=FILE, help="A recorded face, to be played and read back instead of the shapes."
)
@click.option("--pictures", type=PATH, help="A folder for all that the tracker is shown.")
def bench_seen(
    model: Path, reference: Path | None, take: Path | None, pictures: Path | None
) -> None:
    """Show every shape of ARKit to a face tracker: is it seen under its own name?"""
    from . import seen, seen_take
    from .face_tracker import FaceTracker

    if take is not None and reference is not None:
        raise UserError("--reference goes with the shapes, not with --take")
    with FaceTracker(model) as tracker, _told("--reference: "):
        if take is None:
            click.echo(seen.report(seen.measure(tracker, pictures, reference)))
        else:
            click.echo(seen_take.report(*seen_take.measure(tracker, take, pictures)))


@bench.command("reference")
@click.argument("checkout", type=FOLDER)
@click.option("-o", "--output", "folder", type=PATH, required=True, help="A folder.")
@click.option(
    "--landmarks", type=PATH, help="The 68 landmarks, where CHECKOUT's README does not name them."
)
def bench_reference(checkout: Path, folder: Path, landmarks: Path | None) -> None:
    """Make the folder that --reference takes from CHECKOUT, a checkout of ICT-FaceKit."""
    from . import reference

    for line in reference.make(checkout, folder, landmarks):
        click.echo(in_one_line(line))


@bench.command("soak")
@click.option(
    "--minutes", type=FiniteRange(0.01, 1e4), default=60.0, show_default=True, help="Simulated."
)
def bench_soak(minutes: float) -> None:
    """Drive the face with random input for a simulated hour: does it stay sound, and come back."""
    from . import soak

    click.echo(soak.report(soak.measure(minutes=minutes)))


@bench.command("gaps")
@json_option
def bench_gaps(json_file: Path | None) -> None:
    """Look through lips and lids that ought to be shut, in every action unit."""
    from . import gaps

    save = _json(json_file)
    poses = gaps.measure()
    click.echo(gaps.report(poses))
    save([asdict(pose) for pose in poses])


@bench.command("outlines")
def bench_outlines() -> None:
    """Count pixels around opened mouths that are not as those of a head 16 times as dense."""
    from . import outlines

    for title, chosen in (
        ("poses that `border` was tuned on", outlines.CHOSEN_BY),
        ("poses and views that were kept for the end", outlines.OTHERS),
    ):
        click.echo(outlines.report(title, outlines.measure(*chosen, progress=_progress)) + "\n")


@bench.command("tearing")
@click.option("--mixtures", type=click.IntRange(0, 100_000), default=500, show_default=True)
def bench_tearing(mixtures: int) -> None:
    """Look for torn skin and for contacts that fail, in all expressions and random mixtures."""
    from . import tearing

    click.echo(tearing.report(tearing.measure(mixtures=mixtures), mixtures))


@bench.command("meshes")
@click.argument("folder", type=FOLDER)
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=2003, show_default=True)
@click.option(
    "--seconds", type=FiniteRange(0.1, 3600.0), default=20.0, show_default=True, help="Of a mesh."
)
@click.option(
    "--most",
    type=click.IntRange(1, 10_000_000),
    default=200_000,
    show_default=True,
    help="Triangles; larger meshes are left out.",
)
def bench_meshes(folder: Path, seed: int, seconds: float, most: int) -> None:
    """Refine every mesh in FOLDER and below, in noisy poses, and look for cracks: 1 if any."""
    from . import meshes

    with _told():
        results = meshes.measure(
            folder, seed=seed, seconds=seconds, most_triangles=most, progress=_progress
        )
    click.echo(meshes.report(results))
    sys.exit(1 if any(each.broken for each in results) else 0)


@bench.command("take")
@click.option(
    "--minutes", type=FiniteRange(0.05, 120), default=10.0, show_default=True, help="Recorded."
)
def bench_take(minutes: float) -> None:
    """Time a long recording of a face: reading it, making a script of it, playing that."""
    from . import takes

    click.echo(takes.report(minutes))


@bench.command("window")
@click.option("--size", type=Size(), default=(1280, 720), show_default="1280x720")
@click.option(
    "--seconds", type=FiniteRange(0.3, 600.0), default=5.0, show_default=True, help="Of each case."
)
def bench_window(size: tuple[int, int], seconds: float) -> None:
    """Time the window while a smile plays, and while nothing happens; needs a screen."""
    from . import window

    click.echo(window.report(seconds, size))


@bench.command("live")
@click.option(
    "--seconds", type=FiniteRange(1.0, 600.0), default=12.0, show_default=True, help="Of each."
)
@click.option("--window", is_flag=True, help="Also in the window; needs a screen.")
def bench_live(seconds: float, window: bool) -> None:
    """Time a live face from its packet to the skin, for each protocol."""
    from . import live

    click.echo(live.report(seconds, with_window=window))


@bench.command("script")
@click.option("--size", type=Size(), default=(1280, 720), show_default="1280x720")
def bench_script(size: tuple[int, int]) -> None:
    """Time a script that is a take of ten minutes; with a screen, in the window, too."""
    from . import script

    has_screen = sys.platform in ("win32", "darwin") or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
    click.echo(script.report(size, has_screen=has_screen))


def _json(target: Path | None) -> Callable[[object], None]:
    """What writes figures for programs into `target`, if it was given; checked before any work."""
    from risorius.app.files import check_file, save_text

    def save(figures: object) -> None:
        if target is not None:
            save_text(target, json.dumps(figures, indent=1) + "\n")
            click.echo(f"{in_one_line(target)}: written", err=True)

    if target is not None:
        check_file(target)
    return save


@contextlib.contextmanager
def _told(before: str = "") -> Iterator[None]:
    """Tell the user of a ValueError, with some text before its own."""
    try:
        yield
    except ValueError as error:
        raise UserError(f"{before}{error}") from None


def _progress(name: str) -> None:
    """Say on the error stream what is at work, where a person looks on."""
    if sys.stderr.isatty():
        click.echo(f"... {name}", err=True)
