"""`risorius export`: the motion of a script for other programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import UserError
from ..export.formats import MOTION_FORMATS, ExportRequest, check_request, format_for
from ..export.formats import export as write
from ..text import in_one_line
from .help import GroupedCommand
from .options import (
    SCENE_OPTION,
    SCRIPT_ARGUMENT,
    SETTINGS_OPTION,
    HeadOptions,
    option,
    packed,
    played,
)
from .value_types import PATH_TYPE, FiniteRange

if TYPE_CHECKING:
    from risorius.assets.fitting import FittedHead


@dataclass(frozen=True)
class Exporting:
    """Options that only `export` has."""

    name: str | None = option(
        "--as",
        type=click.Choice([each.name for each in MOTION_FORMATS]),
        help="The format, if the name of the output does not show it. obj is a folder with a file "
        "for each frame.",
    )
    fps: float = option(
        type=FiniteRange(1, 240),
        default=30.0,
        show_default=True,
        help="Frames per second, such as 25 or 30000/1001.",
    )
    refined: bool = option(
        is_flag=True,
        help="Write the refined skin, with the same triangles in all frames. --look, --refiner and "
        "--option refine it.",
    )
    changing: bool = option(
        is_flag=True,
        help="With --refined: give each frame its own triangles, as few as it needs (USD, OBJ, "
        "VTKHDF).",
    )
    simplified: bool = option(
        is_flag=True,
        help="For a head above 20000 triangles: write the simplified mesh that is simulated, in "
        "place of the file's mesh.",
    )
    named_only: bool = option(
        is_flag=True,
        help="Write glTF with only ARKit's shapes, without residual targets; errors are "
        "millimetres.",
    )
    overwrite: bool = option(
        is_flag=True, help="Replace the frames of a folder, or the files beside -o."
    )
    quiet: bool = option(is_flag=True, help="No progress bar.")


@click.command(cls=GroupedCommand)
@SCRIPT_ARGUMENT
@SETTINGS_OPTION
@click.option(
    "-o", "--output", type=PATH_TYPE, required=True, help="The file; with --as also a folder."
)
@SCENE_OPTION
@packed("exporting", Exporting)
@packed("subject", HeadOptions)
def export(
    script: Path | None,
    settings: tuple[str, ...],
    output: Path,
    scene: str | None,
    exporting: Exporting,
    subject: HeadOptions,
) -> None:
    """Write the motion of SCRIPT for other programs.

    SCRIPT is a .toml, or a recording of a face; `risorius convert` calibrates recordings. Without
    SCRIPT the built-in script of the scene is played, or --set joy holds a pose for a second.
    """
    from ..files import check_apart

    chosen = format_for(output, exporting.name)
    check_apart(chosen.outputs(output), (script, *subject.files))
    request = ExportRequest(
        subject.refinement() if exporting.refined else None,
        exporting.changing,
        exporting.overwrite,
        not exporting.quiet,
        exporting.named_only,
    )
    check_request(output, chosen, request)
    performance = played(script, scene, settings=settings, quiet=exporting.quiet)
    if request.refinement is not None:
        request.refinement.check(performance.scene)
    head = subject.fitted_head()
    if exporting.simplified:
        head = _simplified(head)
    line, remark = write(
        performance, output, chosen, request, head=head, frames_per_second=exporting.fps
    )
    click.echo(in_one_line(line))
    if remark is not None:
        click.echo(f"{in_one_line(output)}: {remark}", err=True)


def _simplified(head: FittedHead | None) -> FittedHead:
    """Return a head of the simplified mesh of a head; raise UserError if there is none."""
    from risorius.assets.fitting import simplified_head

    if head is None or head.simplified is None:
        raise UserError(
            "--simplified: this mesh is simulated as it is; leave it out, or give a --head of more "
            "than 20000 triangles"
        )
    return simplified_head(head)
