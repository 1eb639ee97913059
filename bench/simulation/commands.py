"""Commands of `risorius bench` that measure the simulated face.

`seen`, `gaps`, `soak`, `tearing`.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from risorius.app.cli.parameters import FiniteRange

from ..command_line import FILE, FOLDER, PATH, conclude, json_option, json_writer, told


@click.command("seen")
@click.option(
    "--model",
    type=FILE,
    required=True,
    help="face_landmarker.task, the model of MediaPipe's face landmarker.",
)
@click.option(
    "--reference", type=FOLDER, help="A folder with face.npz: scans, to be shown as well."
)
@click.option("--pictures", type=PATH, help="A folder for all that the tracker is shown.")
def bench_seen(model: Path, reference: Path | None, pictures: Path | None) -> None:
    """Show every shape of ARKit to a face tracker: is it seen under its own name?"""
    from . import seen
    from .face_tracker import FaceTracker

    with FaceTracker(model) as tracker, told("--reference: "):
        click.echo(seen.report(seen.measure(tracker, pictures, reference)))


@click.command("gaps")
@json_option
def bench_gaps(json_file: Path | None) -> None:
    """Look through lips and lids that ought to be shut, in every action unit."""
    from . import gaps

    save = json_writer(json_file)
    poses = gaps.measure()
    save([asdict(pose) for pose in poses])
    conclude(gaps.report(poses), gaps.targets(poses))


@click.command("soak")
@click.option(
    "--minutes", type=FiniteRange(0.01, 1e4), default=60.0, show_default=True, help="Simulated."
)
def bench_soak(minutes: float) -> None:
    """Drive the face with random input for a simulated hour: does it stay sound, and come back."""
    from . import soak

    found = soak.measure(minutes=minutes)
    conclude(soak.report(found), soak.targets(found))


@click.command("tearing")
@click.option("--mixtures", type=click.IntRange(0, 100_000), default=500, show_default=True)
def bench_tearing(mixtures: int) -> None:
    """Look for torn skin and for contacts that fail, in all expressions and random mixtures."""
    from . import tearing

    poses = tearing.measure(mixtures=mixtures)
    conclude(tearing.report(poses, mixtures), tearing.targets(poses))


COMMANDS = (bench_seen, bench_gaps, bench_soak, bench_tearing)
