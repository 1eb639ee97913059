"""Commands of `risorius bench` that compare skin with scans: `motion`, `reference`."""

from __future__ import annotations

from pathlib import Path

import click

from risorius.app.errors import in_one_line

from ..command_line import FOLDER, PATH, conclude, told


@click.command("motion")
@click.option(
    "--reference",
    type=FOLDER,
    required=True,
    help="a folder with face.npz: vertices, triangles, landmarks68, displacement fields",
)
def bench_motion(reference: Path) -> None:
    """Compare simulated with scanned skin motion, shape by shape."""
    from . import motion

    with told("--reference: "):
        rows, left_out, others = motion.measure(reference)
    conclude(motion.report(rows, left_out, others), motion.targets(rows, others))


@click.command("reference")
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


COMMANDS = (bench_motion, bench_reference)
