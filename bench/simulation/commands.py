"""Commands of `risorius bench` that measure the simulated face, and what they compare it with.

`simulate`, `motion`, `left-out`, `seen`, `gaps`, `soak`, `tearing`, `reference`.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from risorius.app.cli.parameters import FiniteRange
from risorius.app.errors import UserError, in_one_line

from ..command_line import FILE, FOLDER, PATH, json_option, json_writer, told


@click.command("simulate")
@click.option("--rounds", type=click.IntRange(1, 100_000), default=100, show_default=True)
def bench_simulate(rounds: int) -> None:
    """Time a 60 Hz frame of the simulation: the head, and plain meshes up to 100k vertices."""
    from . import simulate

    click.echo(simulate.report(simulate.measure(rounds=rounds), rounds))


@click.command("motion")
@click.option(
    "--reference",
    type=FOLDER,
    required=True,
    help="a folder with face.npz: vertices, triangles, landmarks68, displacement fields",
)
def bench_motion(reference: Path) -> None:
    """Compare simulated with scanned skin motion, shape by shape."""
    from ..scans import motion

    with told("--reference: "):
        click.echo(motion.report(*motion.measure(reference)))


@click.command("left-out")
@click.option("--reference", type=FOLDER, required=True, help="A folder as `motion` takes it.")
def bench_left_out(reference: Path) -> None:
    """Fit muscles from anatomy to all scanned shapes but one, in turn. Takes ten minutes."""
    from ..scans import left_out

    with told("--reference: "):
        click.echo(left_out.report(left_out.measure(reference)))


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
    with FaceTracker(model) as tracker, told("--reference: "):
        if take is None:
            click.echo(seen.report(seen.measure(tracker, pictures, reference)))
        else:
            click.echo(seen_take.report(*seen_take.measure(tracker, take, pictures)))


@click.command("gaps")
@json_option
def bench_gaps(json_file: Path | None) -> None:
    """Look through lips and lids that ought to be shut, in every action unit."""
    from . import gaps

    save = json_writer(json_file)
    poses = gaps.measure()
    click.echo(gaps.report(poses))
    save([asdict(pose) for pose in poses])


@click.command("soak")
@click.option(
    "--minutes", type=FiniteRange(0.01, 1e4), default=60.0, show_default=True, help="Simulated."
)
def bench_soak(minutes: float) -> None:
    """Drive the face with random input for a simulated hour: does it stay sound, and come back."""
    from . import soak

    click.echo(soak.report(soak.measure(minutes=minutes)))


@click.command("tearing")
@click.option("--mixtures", type=click.IntRange(0, 100_000), default=500, show_default=True)
def bench_tearing(mixtures: int) -> None:
    """Look for torn skin and for contacts that fail, in all expressions and random mixtures."""
    from . import tearing

    click.echo(tearing.report(tearing.measure(mixtures=mixtures), mixtures))


@click.command("reference")
@click.argument("checkout", type=FOLDER)
@click.option("-o", "--output", "folder", type=PATH, required=True, help="A folder.")
@click.option(
    "--landmarks", type=PATH, help="The 68 landmarks, where CHECKOUT's README does not name them."
)
def bench_reference(checkout: Path, folder: Path, landmarks: Path | None) -> None:
    """Make the folder that --reference takes from CHECKOUT, a checkout of ICT-FaceKit."""
    from ..scans import reference

    for line in reference.make(checkout, folder, landmarks):
        click.echo(in_one_line(line))


COMMANDS = (
    bench_simulate,
    bench_motion,
    bench_left_out,
    bench_seen,
    bench_gaps,
    bench_soak,
    bench_tearing,
    bench_reference,
)
