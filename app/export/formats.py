"""The formats that a clip can be written in: one row each, and which of them a file name means."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import UserError
from ..files import check_file, written_atomically

if TYPE_CHECKING:
    from ..looks import Refinement
    from .clip import Clip


RIGS = {"arkit": "ARKit shapes", "units": "Action units"}  # titles of layers, by what --rig says


@dataclass(frozen=True)
class Request:
    """What is asked for beside the clip.

    refinement: the refined skin is to be written, and not the mesh that is simulated.
    rig: targets by name that can be posed anew, and not the motion of the script alone: one of
        RIGS, or None.
    """

    refinement: Refinement | None = None
    rig: str | None = None


# Writes the whole file, or raises UserError; returns what there is to say of it, if anything.
Writer = Callable[["Clip", Path, Request], str | None]


@dataclass(frozen=True)
class Format:
    """One kind of file.

    name: what `--as` calls it. suffixes: of its files; () for a folder of one file a frame.
    writer: "module:function" in this room, imported when it is used. refines, rigs: whether it can
    carry what `Request` asks for.
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    writer: str
    refines: bool = False
    rigs: bool = False

    def load(self) -> Writer:
        """The function that writes it."""
        module, _, name = self.writer.partition(":")
        writer: Writer = getattr(import_module(f"{__package__}.{module}"), name)
        return writer


FORMATS = (
    Format("gltf", "glTF", (".glb",), "gltf:write_gltf", rigs=True),
    Format("npz", "numpy arrays", (".npz",), "arrays:write_npz"),
)


def format_for(output: Path, name: str | None) -> Format:
    """The format that an output's name means, or that `--as` names; UserError where there is none.

    Of two formats with one suffix, the first is meant.
    """
    suffix = output.suffix.lower()
    for each in FORMATS:
        if each.name == name or (name is None and suffix in each.suffixes and suffix):
            _check_suffix(output, each)
            return each
    allowed = ", ".join(suffix for each in FORMATS for suffix in each.suffixes)
    raise UserError(f"{output}: what is '{suffix}'? Allowed are {allowed}")


def _check_suffix(output: Path, chosen: Format) -> None:
    """UserError where a file of this format cannot be called so."""
    if chosen.suffixes and output.suffix.lower() not in chosen.suffixes:
        raise UserError(
            f"{output}: {chosen.title} is written as {' or '.join(chosen.suffixes)}; "
            "choose a name that ends so"
        )


def check_request(output: Path, chosen: Format, request: Request) -> None:
    """UserError, before any work is done, where the output cannot be as it is asked for."""
    for asked, can, option in (
        (request.refinement is not None, [f for f in FORMATS if f.refines], "--refined"),
        (request.rig is not None, [f for f in FORMATS if f.rigs], "--rig"),
    ):
        if asked and chosen not in can:
            names = ", ".join(each.name for each in can)
            raise UserError(f"{option} does not go with {chosen.title}; it goes with {names}")
    if chosen.suffixes:
        check_file(output)


def write(clip: Clip, output: Path, chosen: Format, request: Request) -> str | None:
    """Write a clip, whole or not at all; return what there is to say of the file, if anything."""
    writer = chosen.load()
    with written_atomically(output) as part:
        return writer(clip, part, request)


def names() -> Sequence[str]:
    """What `--as` may say."""
    return [each.name for each in FORMATS]
