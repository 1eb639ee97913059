"""`risorius rig`: a head as an avatar with named shapes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from ..errors import UserError, counted, in_one_line
from .options import PATH, HeadName, option, packed


@dataclass(frozen=True)
class Rigging:
    """Options of rig alone."""

    landmarks: Path | None = option(type=PATH, help="The 68 iBug landmarks of HEAD, as JSON.")
    shapes: str = option(
        default="arkit",
        show_default=True,
        metavar="KIND,...",
        help="Kinds of shapes: arkit, units, visemes, expressions.",
    )
    eyes: str | None = option(
        type=click.Choice(["nodes", "targets"]),
        help="How eyeballs turn: as nodes of their own (default), or by the shapes.",
    )
    pieces: tuple[str, ...] = option(
        "--piece",
        multiple=True,
        metavar="NUMBER=ROLE",
        help="What a piece of the file is, where the printed line is wrong: 3=tongue, 4-20=hair.",
    )
    parts: bool = option(
        is_flag=True, help="Add built-in eyes, teeth, tongue and mouth where HEAD has none."
    )
    correctives: int = option(
        type=click.IntRange(0, 200),
        default=0,
        show_default=True,
        help="Shapes of pairs whose sums are farthest off, at most so many.",
    )
    quiet: bool = option(is_flag=True, help="Print nothing but errors.")


@click.command()
@click.argument("head", metavar="[HEAD]", type=HeadName(), required=False)
@click.option("-o", "--output", type=PATH, required=True, help="avatar.glb")
@packed(Rigging)
def rig(head: Path | int | str | None, output: Path, rigging: Rigging) -> None:
    """Make an avatar of HEAD: its own vertices, with named shapes.

    HEAD is a file, or the number or name of a person. Without it the built-in head is taken. Lines
    on the error stream report what each piece of the file was taken for, and how far sums of shapes
    are from the simulation.
    """
    from risorius.assets.identities import person_called

    from ..files import check_apart, check_file, written_atomically
    from ..rig.avatar import RigRequest, avatar_of, read_file_head
    from ..rig.writing import avatar_glb

    file_path = head if isinstance(head, Path) else None
    if (file_path is None) != (rigging.landmarks is None):
        raise UserError(
            "a file as HEAD and --landmarks LANDMARKS.json go together; "
            "`risorius view --head HEAD.obj` helps to mark the landmarks"
        )
    if output.suffix.lower() != ".glb":
        raise UserError(f"{output}: avatars are written as .glb; choose a name that ends so")
    check_apart((output,), (file_path, rigging.landmarks))
    check_file(output)
    request = RigRequest(
        tuple(rigging.shapes.split(",")),
        rigging.eyes,
        rigging.pieces,
        rigging.parts,
        rigging.correctives,
        not rigging.quiet,
    )

    def say(line: str) -> None:
        """Print a line on the head, unless nobody wants it."""
        if not rigging.quiet:
            click.echo(in_one_line(line), err=True)

    if file_path is not None and rigging.landmarks is not None:
        file = read_file_head(file_path, rigging.landmarks, request, say)
        avatar = avatar_of(file.head, request, say, file=file)
        title = file_path.stem
    else:
        person = None if head is None or isinstance(head, Path) else person_called(head)
        avatar = avatar_of(person, request, say)
        title = "head" if person is None else f"person {head}"
    with written_atomically(output) as part:
        part.write_bytes(avatar_glb(avatar, title))
    size = output.stat().st_size / 1e6
    click.echo(
        f"{in_one_line(output)}: {counted(len(avatar.names), 'shape')}, "
        f"{counted(len(avatar.shapes), 'mesh')}, {size:.1f} MB".replace("meshs", "meshes")
    )
