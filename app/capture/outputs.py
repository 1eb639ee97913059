"""What takes the frames of a film: a file through ffmpeg, or a folder of numbered pictures."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import PIL.Image

from risorius.assets.staging import is_staging_folder

from ..errors import UserError
from ..files import (
    Image,
    cannot_be_written,
    check_file,
    real_path,
    temporary_folder,
    written_atomically,
)
from ..passes.files import ENDS, Labelled
from ..stopping import cleaned_up_if_stopped, done_whole
from .ffmpeg import Encoder, Soundtrack

FILM_SUFFIXES = (".mp4", ".mov", ".mkv")
FRAME_NAME = re.compile(rf"frame_\d{{5,}}(\.png|{'|'.join(map(re.escape, ENDS))})")


class FrameSink(Protocol):
    """Takes the frames of a film one after the other, with what is to lie beside each."""

    def __call__(self, image: Image, beside: Labelled | None = None) -> None: ...


@contextlib.contextmanager
def film(
    target: Path,
    size: tuple[int, int],
    frames_per_second: float,
    soundtrack: Soundtrack | None = None,
) -> Iterator[FrameSink]:
    """An H.264 film through ffmpeg, with sound where there is some.

    Raises UserError where a film of this size cannot be written.
    """
    if size[0] % 2 or size[1] % 2:
        raise UserError(
            f"a film needs an even width and height, and --size is {size[0]}x{size[1]}; "
            f"take {size[0] + size[0] % 2}x{size[1] + size[1] % 2}, or write frames to a folder"
        )
    check_file(target)
    with written_atomically(target) as part:
        encoder = Encoder(target, part, size, frames_per_second, soundtrack)
        with cleaned_up_if_stopped(encoder.stop):
            try:
                yield lambda image, beside=None: encoder.add(image)  # nothing lies beside a film
                encoder.finish()
            finally:
                encoder.stop()


@contextlib.contextmanager
def folder(target: Path, *, overwrite: bool) -> Iterator[FrameSink]:
    """Numbered PNG files in a folder. Raises UserError if it holds something already.

    overwrite: frames of an earlier film give way to these; whatever else is there stays.
    """
    real_path(target)
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
    with temporary_folder(target, target) as temporary:

        def add(image: Image, beside: Labelled | None = None) -> None:
            """Write the next frame."""
            nonlocal count
            picture = temporary / f"frame_{count:05d}.png"
            with cannot_be_written(target):
                PIL.Image.fromarray(image).save(picture, compress_level=3)
                if beside is not None:
                    beside.save(picture)
            count += 1

        yield add
        with done_whole(), cannot_be_written(target):  # neither film may be lost between the two
            for old in target.iterdir():
                if FRAME_NAME.fullmatch(old.name):
                    old.unlink()
            for new in temporary.iterdir():
                os.replace(new, target / new.name)
