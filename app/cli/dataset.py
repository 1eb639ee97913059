"""`risorius dataset`: pictures of faces with exact labels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..errors import UserError
from ..text import counted, in_one_line
from .options import SILENT_OPTION, printing
from .value_types import PATH_TYPE, Size


@click.command()
@click.option(
    "--count",
    type=click.IntRange(1, 10**6),
    required=True,
    help="How many samples to make; their names have six digits.",
)
@click.option(
    "--first",
    type=click.IntRange(0, 10**6 - 1),
    default=0,
    show_default=True,
    help="Number of the first sample.",
)
@click.option("-o", "--output", type=PATH_TYPE, required=True, help="The folder of the set.")
@click.option(
    "--sample",
    type=PATH_TYPE,
    help="A table of expressions and poses, in place of the one that --sample-table prints.",
)
@click.option(
    "--seed",
    type=click.IntRange(0, 2**32 - 1),
    default=0,
    show_default=True,
    help="Seed of the random numbers; another seed makes other samples.",
)
@click.option(
    "--passes",
    default="segmentation",
    metavar="NAME,...",
    show_default=True,
    help="Files to write beside each picture: depth, normal, triangle, splits, segmentation. "
    "Landmarks are always written.",
)
@click.option(
    "--size", type=Size(), default=(512, 512), help="Size of pictures [pixels]; by default 512x512."
)
@click.option("--refiner", metavar="NAME", help="A refiner in place of the default, as in capture.")
@click.option(
    "--background",
    metavar="COLOUR|FOLDER",
    help="A colour, such as '#8090a0' or grey, or a folder of pictures; by default soft colours.",
)
@click.option(
    "--light",
    type=PATH_TYPE,
    help="A light map (.hdr or .exr), or a folder of light maps; by default the lights of the "
    "table.",
)
@click.option(
    "--degrade",
    is_flag=True,
    help="Add blur, noise and JPEG to the pictures, by the table's random amounts.",
)
@click.option(
    "--shards",
    type=click.IntRange(1, 10**6),
    metavar="SAMPLES",
    help="Write tar files of WebDataset with this many samples each.",
)
@click.option("--jobs", type=click.IntRange(1, 256), help="Number of processes; by default one.")
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Address of a Dask cluster that makes the samples: tcp://host:8786.",
)
@click.option("--resume", is_flag=True, help="Continue a set, or make it larger.")
@SILENT_OPTION
@printing(
    "--sample-table",
    "risorius.app.dataset",
    "aus.toml",
    "Print the built-in table of expressions and poses, and end.",
)
def dataset(
    count: int,
    first: int,
    output: Path,
    passes: str,
    jobs: int | None,
    scheduler: str | None,
    resume: bool,
    quiet: bool,
    **drawn: Any,
) -> None:
    """Make pictures of faces with exact labels.

    Labels are action units, landmarks, head pose, gaze, camera, and the passes that you choose. A
    sample depends only on --seed and its number, not on the process that makes it.
    """
    from ..dataset.making import make_set
    from ..dataset.request import request_of

    if jobs is not None and scheduler is not None:
        raise UserError(
            "--jobs and --scheduler exclude each other: the cluster has its own workers"
        )
    if first + count > 10**6:
        raise UserError(
            f"--first {first} --count {count}: ends at sample {first + count - 1}, the last can be "
            f"999999; give --count {10**6 - first} or less"
        )
    request = request_of(output, passes=passes.split(","), **drawn)
    made = make_set(
        request,
        count,
        first=first,
        jobs=jobs or 1,
        scheduler=scheduler,
        resume=resume,
        progress=not quiet,
    )
    click.echo(
        f"{in_one_line(output)}: {counted(made.samples, 'sample')}, {made.new} of them new, "
        f"{made.size / 1e6:.1f} MB"
    )
