"""The formats for a clip in a table, and the choice of a format by the name of a file."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Container, Iterable, Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ..errors import UserError
from ..files import (
    cannot_be_written,
    check_file,
    check_folder,
    folder_atomically,
    written_atomically,
)
from ..stopping import cleaned_up_if_stopped
from ..text import counted

if TYPE_CHECKING:
    from risorius.assets.fitting import FittedHead

    from ..refining.presets import Refinement
    from ..script import Script
    from .clip import Clip


Item = TypeVar("Item")

FRAME_NAME = "frame_{:05d}"  # names of the files of a sequence, without suffix
SEQUENCE_FILES = re.compile(r"frame_\d{5,}\.obj|frame\.mtl|frame_skin\.png")  # files of a sequence


@dataclass(frozen=True)
class ExportRequest:
    """Options of an export besides the clip.

    refinement: refinement of the written skin; None: the simulated mesh is written.
    changes: whether each frame is refined separately, so that triangles change.
    overwrite: whether frames in a folder, and files beside the output, may be replaced.
    progress: whether a progress bar is shown.
    named_only: whether to write only ARKit's shapes as morph targets; errors are then millimetres.
    """

    refinement: Refinement | None = None
    changes: bool = False
    overwrite: bool = False
    progress: bool = True
    named_only: bool = False

    def counted(self, frames: Iterable[Item], count: int) -> Iterator[Item]:
        """Yield frames to write, with a progress bar."""
        from tqdm import tqdm

        hidden = not self.progress or None
        bar = tqdm(frames, "Writing", count, unit="frame", disable=hidden, leave=False)
        with cleaned_up_if_stopped(bar.close):
            yield from bar


# A writer writes the whole file or raises UserError. It returns a remark for the user, or None.
Writer = Callable[["Clip", Path, ExportRequest], str | None]


@dataclass(frozen=True)
class Format:
    """One file format.

    name: for `--as`. suffixes: suffixes of files; () for a folder with one file per frame.
    writer: "module:function" in this package, imported at its use. refines: whether the format can
    have a refined skin. changes: whether triangles may differ between frames. beside: ends of the
    names of further files beside the output.
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    writer: str
    refines: bool = True
    changes: bool = False
    beside: tuple[str, ...] = ()

    def outputs(self, output: Path) -> tuple[Path, ...]:
        """Return all written files; the output itself comes first."""
        return (output, *(output.with_name(output.stem + end) for end in self.beside))

    def load(self) -> Writer:
        """Import the function that writes this format."""
        module, _, name = self.writer.partition(":")
        writer: Writer = getattr(import_module(f"{__package__}.{module}"), name)
        return writer


MESH_FILES = (".obj", ".mtl", "_skin.png")  # mesh, materials and the skin's picture
MOTION_FORMATS = (
    Format("gltf", "glTF", (".glb",), "gltf:write_gltf"),
    Format("usd", "USD", (".usdz",), "usd:write_usd", changes=True),
    Format("pc2", "PC2 point cache", (".pc2",), "obj:write_pc2", beside=MESH_FILES),
    Format("obj", "OBJ sequence", (), "obj:write_obj", changes=True),
    Format("vtkhdf", "VTKHDF", (".vtkhdf", ".hdf"), "vtkhdf:write_vtkhdf", changes=True),
    Format("npz", "numpy arrays", (".npz",), "tables:write_npz"),
    Format("arkit", "ARKit shapes over time", (".csv",), "tables:write_arkit", refines=False),
)


def format_for(output: Path, name: str | None) -> Format:
    """Return the format of an output by its name or `--as`; raises UserError if there is none."""
    suffix = output.suffix.lower()
    known = dict.fromkeys(suffix for each in MOTION_FORMATS for suffix in each.suffixes)
    for each in MOTION_FORMATS:
        if each.name == name or (name is None and suffix in each.suffixes):
            _check_suffix(output, each, known)
            return each
    allowed = ", ".join(known)
    folders = " or ".join(f"--as {each.name}" for each in MOTION_FORMATS if not each.suffixes)
    wrong = f"unknown suffix '{suffix}'." if suffix else "has no suffix."
    raise UserError(f"{output}: {wrong} Allowed are {allowed}, and folders with {folders}")


def _check_suffix(output: Path, chosen: Format, known: Container[str]) -> None:
    """Raise UserError if the name does not suit the format, or a folder has a file's suffix."""
    if not chosen.suffixes and output.suffix.lower() in known:
        raise UserError(
            f"{output}: {chosen.title} is a folder, and this is the name of a file; "
            f"leave out {output.suffix} or --as {chosen.name}"
        )
    if chosen.suffixes and output.suffix.lower() not in chosen.suffixes:
        raise UserError(
            f"{output}: {chosen.title} is written as {' or '.join(chosen.suffixes)}; "
            "choose a name that ends so"
        )


def check_request(output: Path, chosen: Format, request: ExportRequest) -> None:
    """Raise UserError, before any work, if the requested output is impossible."""
    if request.refinement is not None and not chosen.refines:
        names = ", ".join(each.name for each in MOTION_FORMATS if each.refines)
        raise UserError(f"--refined: cannot be written as {chosen.title}; allowed are {names}")
    if request.changes and request.refinement is None:
        raise UserError("--changing needs --refined; add it, or leave out --changing")
    if request.changes and not chosen.changes:
        names = ", ".join(each.name for each in MOTION_FORMATS if each.changes)
        raise UserError(f"--changing: cannot be written as {chosen.title}; allowed are {names}")
    if request.named_only and chosen.name != "gltf":
        raise UserError(f"--named-only: cannot be written as {chosen.title}; allowed is gltf")
    chosen.load()
    if not chosen.suffixes:
        check_folder(output, overwrite=request.overwrite)
        return
    check_file(output)
    if not output.exists() and not request.overwrite:  # otherwise an earlier export wrote them
        for other in chosen.outputs(output)[1:]:
            if os.path.lexists(other):
                raise UserError(
                    f"{other}: exists already, and {output.name} needs a file of this name; "
                    "choose another name, or add --overwrite"
                )


def write(clip: Clip, output: Path, chosen: Format, request: ExportRequest) -> str | None:
    """Write a clip completely or not at all; return a remark on the file for the user, or None.

    The rounding of long sums depends on the number of threads. So one thread computes, and bytes
    are equal in a batch and on machines with more cores.
    """
    from threadpoolctl import threadpool_limits

    writer = chosen.load()
    whole = (
        written_atomically(output)
        if chosen.suffixes
        else folder_atomically(output, SEQUENCE_FILES, overwrite=request.overwrite)
    )
    with cannot_be_written(output), whole as part, threadpool_limits(1):
        return writer(clip, part, request)


def export(
    script: Script,
    output: Path,
    chosen: Format,
    request: ExportRequest,
    *,
    head: FittedHead | None = None,
    frames_per_second: float = 30.0,
    span: tuple[float, float] | None = None,
) -> tuple[str, str | None]:
    """Play a script, or its `span` [s], and write the clip; return a line, and a remark or None."""
    from ..motion import scene_of
    from .clip import record
    from .refined import with_refined_skin

    progress = request.progress
    clip = record(script, scene_of(script, head), frames_per_second, span=span, progress=progress)
    line = f"{output}: {chosen.title}, {counted(clip.frame_count, 'frame')}"
    if request.refinement is None and chosen.refines:
        line = f"{line}, {counted(len(clip.skin.faces), 'triangle')}"
    if request.refinement is not None and not request.changes:
        refined = with_refined_skin(clip, request.refinement)
        line = f"{line}, {refined.words}"
        clip = refined.clip
        request = replace(request, refinement=None)
    remark = write(clip, output, chosen, request)
    return f"{line}, {_size_in_words(chosen.outputs(output))}", remark


def _size_in_words(outputs: Iterable[Path]) -> str:
    """Return the total size of files in words; a folder counts with its files."""
    files: list[Path] = []
    for output in outputs:
        files += output.iterdir() if output.is_dir() else [output]
    size = sum(path.stat().st_size for path in files if path.is_file())
    return f"{size / 1e6:.1f} MB" if size >= 1_000_000 else f"{max(size / 1e3, 1.0):.0f} kB"
