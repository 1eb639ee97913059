"""Files that are whole or not there: an output is written aside and moved when complete."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

from risorius.assets.staging import StagingFolder, is_staging_folder

from .errors import UserError
from .ffmpeg import Encoder
from .stopping import cleaned_up_if_stopped, done_whole

FILM_SUFFIXES = (".mp4", ".mov", ".mkv")
FRAME_NAME = re.compile(r"frame_\d{5,}\.png")
Frame = npt.NDArray[np.uint8]  # (H, W, 3), top row first
FrameSink = Callable[[Frame], None]  # takes the frames of a film one after the other


@contextlib.contextmanager
def written_aside(target: Path) -> Iterator[Path]:
    """Yield a path beside `target`, renamed to it if the block ends without an error.

    A link stays one: what it points to is written. UserError where that cannot be.
    """
    whole = _behind_links(target)
    with cannot_be_written(target):
        whole.parent.mkdir(parents=True, exist_ok=True)
    with _folder_aside(target, whole.parent) as aside:
        part = aside / whole.name
        yield part
        with cannot_be_written(target):
            os.replace(part, whole)


@contextlib.contextmanager
def _folder_aside(target: Path, parent: Path) -> Iterator[Path]:
    """A folder in `parent` that is gone after the block, however it ends."""
    aside = StagingFolder(parent)
    with cleaned_up_if_stopped(aside.remove), contextlib.ExitStack() as stack:
        with cannot_be_written(target):
            folder = stack.enter_context(aside)
        yield folder


@contextlib.contextmanager
def cannot_be_written(target: Path) -> Iterator[None]:
    """Turn what the system says against writing `target` into a UserError that names it."""
    try:
        yield
    except OSError as error:
        raise UserError(f"{target}: cannot be written: {error.strerror or error}") from None


def _behind_links(target: Path) -> Path:
    """The file that `target` stands for; UserError where its links go round in a circle."""
    whole = Path(os.path.realpath(target))
    with cannot_be_written(target):
        if whole.is_symlink():
            raise UserError(f"{target}: is a link that leads back to itself; choose another name")
    return whole


def check_file(target: Path) -> None:
    """Raise UserError, before any work is done, where no file of this name can be written."""
    whole = _behind_links(target)
    with cannot_be_written(target):
        if whole.is_dir():
            raise UserError(f"{target}: is a folder; choose another name for the file")
        if whole.exists() and not whole.is_file():
            raise UserError(f"{target}: is a device, not a file; choose another name")
        folder = next(parent for parent in whole.parents if os.path.lexists(parent))
        with _folder_aside(target, folder) as aside:
            (aside / whole.name).touch()


def check_picture(target: Path) -> None:
    """Raise UserError, before any work is done, where no picture can be written."""
    if target.suffix.lower() != ".png":
        raise UserError(f"{target}: pictures are written as .png; choose a name that ends so")
    check_file(target)


def save_text(target: Path, text: str) -> None:
    """Write a text file, UTF-8; UserError where it cannot be written."""
    check_file(target)
    with written_aside(target) as part, cannot_be_written(target):
        part.write_text(text, encoding="utf-8")


def save_png(target: Path, frame: Frame) -> None:
    """Write one picture; UserError for another suffix, and where it cannot be written."""
    check_picture(target)
    with written_aside(target) as part, cannot_be_written(target):
        Image.fromarray(frame).save(part, format="PNG")


@contextlib.contextmanager
def film(target: Path, size: tuple[int, int], frames_per_second: float) -> Iterator[FrameSink]:
    """An H.264 film through ffmpeg.

    Raises UserError where a film of this size cannot be written.
    """
    if size[0] % 2 or size[1] % 2:
        raise UserError(
            f"a film needs an even width and height, and --size is {size[0]}x{size[1]}; "
            f"take {size[0] + size[0] % 2}x{size[1] + size[1] % 2}, or write frames to a folder"
        )
    check_file(target)
    with written_aside(target) as part:
        encoder = Encoder(target, part, size, frames_per_second)
        with cleaned_up_if_stopped(encoder.stop):
            try:
                yield encoder.add
                encoder.finish()
            finally:
                encoder.stop()


@contextlib.contextmanager
def folder(target: Path, *, overwrite: bool) -> Iterator[FrameSink]:
    """Numbered PNG files in a folder. Raises UserError if it holds something already.

    overwrite: frames of an earlier film give way to these; whatever else is there stays.
    """
    _behind_links(target)
    is_new = not target.exists()
    with cannot_be_written(target):
        is_empty = is_new or all(is_staging_folder(item) for item in target.iterdir())
        if not is_empty and not overwrite:
            raise UserError(
                f"{target}: is there and not empty; name another folder, or add --overwrite"
            )
    if not is_new:
        with _frames(target) as add:
            yield add
        return

    def give_up() -> None:
        with contextlib.suppress(OSError):  # it has its frames
            target.rmdir()

    with cleaned_up_if_stopped(give_up):
        try:
            with cannot_be_written(target):
                target.mkdir(parents=True)
            with _frames(target) as add:
                yield add
        finally:
            give_up()


@contextlib.contextmanager
def _frames(target: Path) -> Iterator[FrameSink]:
    """Numbered PNG files that come into the folder `target` all at once."""
    count = 0
    with _folder_aside(target, target) as aside:

        def add(frame: Frame) -> None:
            nonlocal count
            with cannot_be_written(target):
                Image.fromarray(frame).save(aside / f"frame_{count:05d}.png", compress_level=3)
            count += 1

        yield add
        with done_whole(), cannot_be_written(target):  # neither film may be lost between the two
            for old in target.iterdir():
                if FRAME_NAME.fullmatch(old.name):
                    old.unlink()
            for new in aside.iterdir():
                os.replace(new, target / new.name)
