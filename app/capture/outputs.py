"""What takes the frames of a film: a file through ffmpeg, or a folder of numbered pictures."""

from __future__ import annotations

import contextlib
import re
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import numpy.typing as npt
import PIL.Image

from ..files import (
    QUICK,
    Image,
    cannot_be_written,
    check_file,
    folder_atomically,
    written_atomically,
)
from ..passes.labelled import ENDS, Labelled
from ..stopping import cleaned_up_if_stopped
from ..workers.child import share_of_cores
from .encoder import Encoder, Soundtrack, check_format, size_of_film

AROUND = 6  # halvings: colours reach 64 pixels, the largest block of a coder, beyond an edge
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
    weight: npt.NDArray[np.float32] = np.greater(image[..., 3:], 0).astype(np.float32)
    filled = image.copy()
    seen: npt.NDArray[np.float32] = (image[..., :3] * weight).astype(np.float32)
    around = _filled(seen, weight, AROUND)
    filled[..., :3] = np.where(weight > 0.0, image[..., :3], around + 0.5)
    return filled


def _filled(
    colours: npt.NDArray[np.float32], weight: npt.NDArray[np.float32], halvings: int
) -> npt.NDArray[np.float32]:
    """Colours (H, W, 3), 0 where the weight (H, W, 1) is, with means of those around there."""
    if not halvings:
        return colours
    height, width = weight.shape[:2]
    padding = ((0, height % 2), (0, width % 2), (0, 0))

    def halved(values: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Sums of two by two."""
        even = np.pad(values, padding)
        rows = even[::2] + even[1::2]
        summed: npt.NDArray[np.float32] = rows[:, ::2] + rows[:, 1::2]
        return summed

    count = halved(weight)
    means = np.divide(halved(colours), np.maximum(count, 1.0), dtype=np.float32)
    some: npt.NDArray[np.float32] = np.minimum(count, np.float32(1.0))
    coarse = _filled(means, some, halvings - 1)
    fine = coarse.repeat(2, axis=0).repeat(2, axis=1)[:height, :width]
    return np.where(weight > 0.0, colours, fine)
