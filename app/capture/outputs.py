"""What takes the frames of a film: a file through ffmpeg, or a folder of numbered pictures."""

from __future__ import annotations

import contextlib
import re
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import PIL.Image
import scipy

from ..files import (
    QUICK,
    Image,
    cannot_be_written,
    check_file,
    folder_atomically,
    written_atomically,
)
from ..passes.labels import ENDS, Labelled
from ..stopping import cleaned_up_if_stopped
from ..workers import share_of_cores
from .encoder import Encoder, Soundtrack, check_format, size_of_film

FRAME_NAME = re.compile(rf"frame_\d{{5,}}(\.png|{'|'.join(map(re.escape, ENDS))})")


FrameSink = Callable[..., None]  # takes pictures one after the other, and what lies beside each


@contextlib.contextmanager
def film(
    target: Path,
    size: tuple[int, int],
    frames_per_second: float,
    soundtrack: Soundtrack | None = None,
    *,
    is_transparent: bool = False,
) -> Iterator[FrameSink]:
    """A film through ffmpeg, as its name ends, with sound where there is some and it may be heard.

    size: of the frames. A kind that needs an even width and height has the last row or column
    twice. Raises UserError where no such film can be written.
    """
    check_format(target, frames_per_second, is_transparent=is_transparent)
    check_file(target)
    whole = size_of_film(target, size, is_transparent=is_transparent)
    more = (0, whole[1] - size[1]), (0, whole[0] - size[0]), (0, 0)
    with written_atomically(target) as part:
        encoder = Encoder(
            target, part, whole, frames_per_second, soundtrack, is_transparent=is_transparent
        )

        def add(image: Image, beside: Labelled | None = None) -> None:
            """Hand a frame over; nothing lies beside a film."""
            if is_transparent:
                image = with_colours_around(image)
            encoder.add(np.pad(image, more, mode="edge") if whole != size else image)

        with cleaned_up_if_stopped(encoder.stop):
            try:
                yield add
                encoder.finish()
            finally:
                encoder.stop()


@contextlib.contextmanager
def folder(target: Path, *, overwrite: bool) -> Iterator[FrameSink]:
    """Numbered PNG files in a folder. Raises UserError if it holds something already.

    overwrite: frames of an earlier film give way to these; whatever else is there stays.
    """
    count = 0
    waiting: deque[Future[None]] = deque()
    workers = share_of_cores()  # threads, for most of the time is spent in zlib

    def write(picture: Path, image: Image, beside: Labelled | None) -> None:
        """Write one frame, in a thread."""
        with cannot_be_written(target):
            PIL.Image.fromarray(image).save(picture, compress_level=QUICK)
            if beside is not None:
                beside.save(picture)

    with (
        folder_atomically(target, FRAME_NAME, overwrite=overwrite) as temporary,
        ThreadPoolExecutor(workers) as threads,
    ):

        def add(image: Image, beside: Labelled | None = None) -> None:
            """Have the next frame written; raises what went wrong with earlier ones."""
            nonlocal count
            picture = temporary / f"frame_{count:05d}.png"
            waiting.append(threads.submit(write, picture, image, beside))
            count += 1
            if len(waiting) > workers:
                waiting.popleft().result()

        yield add
        while waiting:
            waiting.popleft().result()


def with_colours_around(image: Image) -> Image:
    """The same picture, (H, W, 4), with colours of its edges where it is fully transparent.

    What codes blocks of pixels, or colours at half the size, mixes edges with what is around them;
    black there would be seen as a dark fringe.
    """
    is_clear = image[..., 3] == 0
    if is_clear.all():
        return image
    nearest = scipy.ndimage.distance_transform_edt(
        is_clear, return_distances=False, return_indices=True
    )
    filled = image.copy()
    filled[..., :3] = image[..., :3][tuple(nearest)]
    return filled
