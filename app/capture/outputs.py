"""What takes the frames of a film: a file through ffmpeg, or a folder of numbered pictures."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import PIL.Image

from ..errors import UserError
from ..files import (
    Image,
    cannot_be_written,
    check_file,
    folder_atomically,
    written_atomically,
)
from ..stopping import cleaned_up_if_stopped
from .ffmpeg import Encoder, Soundtrack

FILM_SUFFIXES = (".mp4", ".mov", ".mkv")
FRAME_NAME = re.compile(r"frame_\d{5,}\.png")
FrameSink = Callable[[Image], None]  # takes the frames of a film one after the other


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
                yield encoder.add
                encoder.finish()
            finally:
                encoder.stop()


@contextlib.contextmanager
def folder(target: Path, *, overwrite: bool) -> Iterator[FrameSink]:
    """Numbered PNG files in a folder. Raises UserError if it holds something already.

    overwrite: frames of an earlier film give way to these; whatever else is there stays.
    """
    count = 0
    with folder_atomically(target, FRAME_NAME, overwrite=overwrite) as temporary:

        def add(image: Image) -> None:
            """Write the next frame."""
            nonlocal count
            with cannot_be_written(target):
                PIL.Image.fromarray(image).save(
                    temporary / f"frame_{count:05d}.png", compress_level=3
                )
            count += 1

        yield add
