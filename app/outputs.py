"""Files that are whole or not there: an output is written aside and renamed when complete."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import numpy.typing as npt
from PIL import Image

from .errors import UserError

FILM_SUFFIXES = (".mp4", ".mov", ".mkv")
Frame = npt.NDArray[np.uint8]  # (H, W, 3), top row first
FrameSink = Callable[[Frame], None]  # takes the frames of a film one after the other


@contextlib.contextmanager
def written_aside(target: Path) -> Iterator[Path]:
    """Yield a path beside `target`, renamed to it if the block ends without an error.

    A file takes the place of a file, a folder that of a folder; UserError where they would mix.
    """
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
    except OSError as error:
        raise UserError(f"{target}: cannot be written: {error}") from None
    try:
        part = aside / target.name
        yield part
        if target.is_dir() != part.is_dir() and target.exists():
            raise UserError(f"{target}: is there already, and of another kind; choose another name")
        if target.is_dir():  # a folder is not replaced in place: its old content leaves last
            os.replace(target, aside / "previous")
        os.replace(part, target)
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def refuse_folder(target: Path) -> None:
    """Raise UserError, before any work is done, where a file is to be and a folder is."""
    if target.is_dir():
        raise UserError(f"{target}: is a folder; choose another name for the file")


def check_picture(target: Path) -> None:
    """Raise UserError, before any work is done, where no picture can be written."""
    if target.suffix.lower() != ".png":
        raise UserError(f"{target}: pictures are written as .png; choose a name that ends so")
    refuse_folder(target)


def save_png(target: Path, frame: Frame) -> None:
    """Write one picture; UserError for another suffix and for a folder."""
    check_picture(target)
    with written_aside(target) as part:
        Image.fromarray(frame).save(part, format="PNG")


@contextlib.contextmanager
def film(target: Path, size: tuple[int, int], frames_per_second: float) -> Iterator[FrameSink]:
    """An H.264 film through ffmpeg: 4:2:0 as every player wants it, at a quality without blocks.

    Raises UserError where a film of this size cannot be written.
    """
    if size[0] % 2 or size[1] % 2:
        raise UserError(
            f"a film needs an even width and height, and --size is {size[0]}x{size[1]}; "
            f"take {size[0] + size[0] % 2}x{size[1] + size[1] % 2}, or write frames to a folder"
        )
    refuse_folder(target)
    with written_aside(target) as part:
        writer = imageio_ffmpeg.write_frames(
            str(part),
            size,
            fps=frames_per_second,
            codec="libx264",
            quality=None,
            macro_block_size=1,
            output_params=["-crf", "16", "-preset", "veryfast", "-movflags", "+faststart"],
        )
        writer.send(None)
        try:
            yield lambda frame: writer.send(np.ascontiguousarray(frame))
        finally:
            writer.close()


@contextlib.contextmanager
def folder(target: Path, *, overwrite: bool) -> Iterator[FrameSink]:
    """Numbered PNG files in a folder. Raises UserError if it holds something already."""
    if target.exists() and (not target.is_dir() or any(target.iterdir())) and not overwrite:
        raise UserError(
            f"{target}: is there and not empty; name another folder, or add --overwrite"
        )
    with written_aside(target) as part:
        part.mkdir()
        count = 0

        def add(frame: Frame) -> None:
            nonlocal count
            picture = part / f"frame_{count:05d}.png"
            Image.fromarray(frame).save(picture, compress_level=3)
            count += 1

        yield add
