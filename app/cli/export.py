"""`risorius export`: the motion of a script for other programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import UserError
from ..export.formats import FORMATS, ExportRequest, check_request, format_for
from ..export.formats import export as write
from ..text import in_one_line
from .help import GroupedCommand
from .options import SCENE, SCRIPT, SETTINGS, Subject, option, packed, played
from .value_types import PATH, FiniteRange

if TYPE_CHECKING:
    from risorius.assets.fitting import FittedHead


@dataclass(frozen=True)
class Exporting:
    """Options of export alone."""

    name: str | None = option(
        "--as",
        type=click.Choice([each.name for each in FORMATS]),
        help="The format, where the name does not show it: obj is a folder of one file a frame.",
    )
    fps: float = option(
        type=FiniteRange(1, 240),
        default=30.0,
        show_default=True,
        help="Frames a second, as 25 or 30000/1001.",
    )
    refined: bool = option(
        is_flag=True,
        help="Write the refined skin, the same triangles in all frames, by --look, --refiner and "
        "--option.",
    )
    changing: bool = option(
        is_flag=True,
        help="With --refined: other triangles in each frame, as few as it needs (USD, OBJ, "
        "VTKHDF).",
    )
    simplified: bool = option(
        is_flag=True,
        help="Of a head above 20000 triangles: write the simplified mesh that is simulated, in "
        "place of the file's own.",
    )
    named_only: bool = option(
        is_flag=True,
        help="glTF without residual targets: ARKit's shapes alone, with errors of millimetres.",
    )
    overwrite: bool = option(is_flag=True, help="Replace frames in a folder, or files beside -o.")
    quiet: bool = option(is_flag=True, help="No progress bar.")


@click.command(cls=GroupedCommand)
@SCRIPT
@SETTINGS
@click.option("-o", "--output", type=PATH, required=True, help="A file, or a folder with --as.")
@SCENE
@packed(Exporting)
@packed(Subject)
def export(
    script: Path | None,
    settings: tuple[str, ...],
    output: Path,
    scene: str | None,
    exporting: Exporting,
    subject: Subject,
) -> None:
    """Write the motion of SCRIPT for other programs.

    A recording of a face is a SCRIPT, too; `risorius convert` calibrates it. Without SCRIPT the
    scene's own one is played, or a pose is held for a second: --set joy.
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
    """The simplified mesh of a head as a head; raises UserError if it has none."""
    from risorius.assets.fitting import simplified_head

    if head is None or head.simplified is None:
        raise UserError(
            "--simplified: this mesh is simulated as it is; leave it out, or give a --head of more "
            "than 20000 triangles"
        )
    return simplified_head(head)
