"""`risorius rig`: a head as an avatar with named shapes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import UserError
from ..text import counted, in_one_line
from .help import RenewedCommand
from .options import option, packed
from .value_types import PATH_TYPE, HeadName

if TYPE_CHECKING:
    from ..script import Script


@dataclass(frozen=True)
class Rigging:
    """Options that only `rig` has."""

    landmarks: Path | None = option(
        type=PATH_TYPE,
        help="The 68 iBug landmarks of HEAD, as JSON. Heads of MakeHuman, ICT-FaceKit and "
        "MediaPipe need none.",
    )
    name: str = option(
        "--as",
        type=click.Choice(["glb", "obj"]),
        default="glb",
        show_default=True,
        help="The format. obj is a folder with a file for each shape.",
    )
    shapes: str = option(
        default="arkit",
        show_default=True,
        metavar="KIND,...",
        help="Kinds of shapes to write: arkit, units, visemes, expressions.",
    )
    eyes: str | None = option(
        type=click.Choice(["nodes", "targets"]),
        help="How eyeballs turn: as nodes (default), or by the shapes.",
    )
    pieces: tuple[str, ...] = option(
        "--piece",
        multiple=True,
        metavar="PIECE=ROLE",
        help="Correct the printed role of pieces of the file: 3=tongue, 4-20=hair, Cap=hidden.",
    )
    parts: bool = option(
        is_flag=True, help="Add built-in eyes, teeth, tongue and mouth where HEAD has none."
    )
    correctives: int = option(
        type=click.IntRange(0, 200),
        default=0,
        show_default=True,
        help="Add at most this many shapes, each of which corrects the sum of two shapes.",
    )
    take: Path | None = option(
        type=PATH_TYPE,
        help="A recording or script on which sums of shapes are compared with the simulation, and "
        "for which --correctives are chosen; by default a few built-in words.",
    )
    quiet: bool = option(is_flag=True, help="Print nothing but errors.")


@click.command(cls=RenewedCommand)
@click.argument("head", metavar="[HEAD]", type=HeadName(), required=False)
@click.option(
    "-o",
    "--output",
    type=PATH_TYPE,
    required=True,
    help="The file avatar.glb; with --as obj a folder.",
)
@packed("rigging", Rigging)
def rig(head: Path | int | str | None, output: Path, rigging: Rigging) -> None:
    """Make an avatar of HEAD: a mesh with the same vertices, and with named shapes.

    HEAD is a file, or the number or name of a person; by default it is the built-in head. Lines on
    the error stream report the role of each piece of the file, and how far sums of shapes differ
    from the simulation.
    """
    from ..rig.avatar import RigRequest, avatar_of
    from ..rig.writing import write_avatar
    from ..scenes import called_head, fit_users_head

    file_path = head if isinstance(head, Path) else None
    if file_path is None and rigging.landmarks is not None:
        raise UserError(f"--landmarks {rigging.landmarks}: needs a file as HEAD; add the mesh")
    is_folder = rigging.name == "obj"
    _check_output(output, (file_path, rigging.landmarks, rigging.take), is_folder=is_folder)
    kinds = tuple(rigging.shapes.split(","))
    request = RigRequest(
        kinds=kinds,
        eyes=rigging.eyes,
        corrections=rigging.pieces,
        adds_parts=rigging.parts,
        correctives=rigging.correctives,
        progress=not rigging.quiet,
        take=_take_of(rigging, kinds),
        chooses_by_take=rigging.take is not None,
    )

    def print_line(line: str) -> None:
        """Print a line about the head, unless --quiet is set."""
        if not rigging.quiet:
            click.echo(in_one_line(line), err=True)

    fitted = None
    title = "head"
    if file_path is not None:
        fitted = fit_users_head(file_path, rigging.landmarks)
        title = file_path.stem
    elif head is not None and not isinstance(head, Path):
        fitted = called_head(head)
        title = f"head {head}"
    avatar = avatar_of(fitted, request, print_line)
    size, meshes = write_avatar(avatar, output, title, is_folder=is_folder)
    in_meshes = "1 mesh" if meshes == 1 else f"{meshes} meshes"
    shapes = counted(len(avatar.names), "shape")
    click.echo(f"{in_one_line(output)}: {shapes}, {in_meshes}, {size / 1e6:.1f} MB")


def _take_of(rigging: Rigging, kinds: tuple[str, ...]) -> Script | None:
    """Return the take on which sums of shapes are compared; None if there is no comparison."""
    from ..performances import built_in_words, read_performance

    if "arkit" not in kinds:
        if rigging.take is not None:
            raise UserError("--take needs the shapes of ARKit; add arkit to --shapes")
        return None
    if rigging.quiet and (rigging.take is None or not rigging.correctives):
        return None
    if rigging.take is None:
        return built_in_words()
    script, _ = read_performance(rigging.take)
    if script.scene != "face":
        raise UserError(f"{rigging.take}: is for the scene '{script.scene}'; choose one for a face")
    return script


def _check_output(output: Path, inputs: tuple[Path | None, ...], *, is_folder: bool) -> None:
    """Raise UserError, before any work is done, if the output cannot be written."""
    from ..files import check_apart, check_file, check_folder

    if not is_folder and output.suffix.lower() != ".glb":
        raise UserError(
            f"{output}: avatars are written as .glb, or as a folder with --as obj; "
            "choose a name that ends so"
        )
    check_apart((output,), inputs)
    if is_folder:
        check_folder(output, overwrite=False)
    else:
        check_file(output)
