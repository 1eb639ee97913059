"""Outputs for the frames of a film: a file through ffmpeg, or a folder of numbered pictures.

The suffix of its name decides the format of a film. ffmpeg is a separate process; its failure is
reported in one line. The writer of `imageio_ffmpeg` ignores ffmpeg's exit code, so a film that a
full disk cut short would count as complete.
"""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np
import PIL.Image

from risorius.geometry.arrays import Unsigned8

from ..errors import UserError
from ..files import (
    cannot_be_written,
    check_file,
    folder_atomically,
    written_atomically,
)
from ..passes.labels import FILE_ENDS, Labelled
from ..pictures import QUICK_LEVEL, Image
from ..sound.decoding import ffmpeg, sound_form, sound_input
from ..stopping import cleaned_up_if_stopped
from ..workers import share_of_cores

# AAC and Opus in forms that players need, at a quality that sounds like the source.
AAC_OPTIONS = "-acodec aac -b:a 192k"
OPUS_OPTIONS = "-acodec libopus -b:a 160k"
# H.264 in 4:2:0, which every player reads and which needs even sides, at a quality without blocks.
# The number of threads changes the bytes of the file and the memory. By default x264 starts 1.5
# threads for each core, which take 1 GB on 64 cores.
H264_OPTIONS = (
    "-vf crop=trunc(iw/2)*2:trunc(ih/2)*2 -vcodec libx264 -threads 3 -pix_fmt yuv420p -crf 16 "
    "-preset veryfast -movflags +faststart"
)
VP9_OPTIONS = (
    "-vcodec libvpx-vp9 -crf 18 -b:v 0 -deadline good -cpu-used 5 -row-mt 1 -pix_fmt yuv420p"
)
# Each frame has its own palette, so ffmpeg need not keep all frames of a long film.
GIF_OPTIONS = (
    "-filter_complex split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1"
)
WEBP_OPTIONS = "-vcodec libwebp_anim -quality 88 -compression_level 4 -pix_fmt yuv420p"


class FilmFormat(NamedTuple):
    """A film format: ffmpeg's options for pictures and for sound; None for a silent format."""

    coding: str
    sound: str | None = None
    fastest: float = 240.0  # [frames/s] that players show


FILM_FORMATS = {
    ".mp4": FilmFormat(H264_OPTIONS, AAC_OPTIONS),
    ".webm": FilmFormat(VP9_OPTIONS, OPUS_OPTIONS),
    # A GIF frame lasts whole hundredths of a second; players slow down frames shorter than two.
    ".gif": FilmFormat(f"{GIF_OPTIONS} -loop 0", fastest=50.0),
    ".webp": FilmFormat(f"{WEBP_OPTIONS} -loop 0"),
}
SOUND_FILM_SUFFIXES = tuple(suffix for suffix, each in FILM_FORMATS.items() if each.sound)


def format_of(target: Path) -> FilmFormat | None:
    """Return the film format for a file of this name, or None if it is not a film."""
    return FILM_FORMATS.get(target.suffix.lower())


def check_name(output: Path) -> None:
    """Raise UserError unless the name is that of a film, a picture or a folder."""
    suffix = output.suffix.lower()
    if suffix not in (*FILM_FORMATS, ".png", "") and not output.is_dir():
        raise UserError(
            f"{output}: unknown suffix '{suffix}'. Allowed are {', '.join(FILM_FORMATS)} (a film), "
            ".png (one picture) and a name without suffix (a folder of frames)"
        )


@dataclass(frozen=True)
class FilmSound:
    """The sound of a film: at most `seconds` [s] of a sound file, from `begin` [s] on."""

    file: Path
    seconds: float
    begin: float = 0.0

    def options(self, coding: str) -> list[str]:
        """Return ffmpeg's options for the sound; the frames must be the first input."""
        source = sound_input(self.file, self.seconds, self.begin)
        return [*source, "-map", "0:v", "-map", "1:a:0", *coding.split(), *sound_form()]


class Encoder:
    """An ffmpeg process that encodes frames into the file `part`; errors name `target`."""

    ENDING_TIME = 1.0  # [s] to wait for the end of a killed or failed process

    def __init__(
        self,
        target: Path,
        part: Path,
        size: tuple[int, int],
        frames_per_second: float,
        soundtrack: FilmSound | None = None,
    ) -> None:
        """Start ffmpeg, for frames of `size` pixels; raises UserError if it is missing."""
        form = FILM_FORMATS[target.suffix.lower()]
        self._target = target
        self._part = part
        rate = Fraction(frames_per_second).limit_denominator()
        frames = f"-f rawvideo -pix_fmt rgb24 -s {size[0]}x{size[1]} -r {rate} -i -"
        sound = ["-an"]
        if soundtrack is not None and form.sound is not None:
            sound = soundtrack.options(form.sound)
        name = ffmpeg()
        coding = form.coding.split()
        self._messages = tempfile.TemporaryFile()
        try:  # in its own session, so Ctrl-C reaches only us
            self._process = subprocess.Popen(
                [name, "-v", "error", *frames.split(), *sound, *coding, f"file:{part}"],
                stdin=subprocess.PIPE,
                stderr=self._messages,
                bufsize=0,
                start_new_session=True,
            )
        except OSError as error:
            raise UserError(f"no film without ffmpeg: {name}: {error.strerror}") from None
        assert self._process.stdin is not None
        self._frames = self._process.stdin

    def add(self, image: Unsigned8) -> None:
        """Pass a frame, (H, W, 3), to ffmpeg; raises UserError if ffmpeg has ended."""
        left = np.ascontiguousarray(image).data.cast("B")
        try:
            while left:
                left = left[self._frames.write(left) or 0 :]
        except BrokenPipeError:
            raise self._failure() from None

    def finish(self) -> None:
        """Wait until the file is complete; raise UserError if ffmpeg fails."""
        self._frames.close()
        if self._process.wait():
            raise self._failure()

    def stop(self) -> None:
        """End the process and its children; this does nothing after `finish`."""
        if sys.platform == "win32":
            self._process.kill()
        else:
            with contextlib.suppress(OSError):  # all processes have ended
                os.killpg(self._process.pid, signal.SIGKILL)  # its session is also its group
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(self.ENDING_TIME)
        self._messages.close()
        self._frames.close()

    def _failure(self) -> UserError:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(self.ENDING_TIME)
        self._messages.seek(0)
        messages = self._messages.read().decode(errors="replace").strip().splitlines()
        # ffmpeg's prefix is removed, as in "[out#0/mp4 @ 0x55e9629d] ".
        why = (
            re.sub(r"^(\[[^]]*\] )+", "", messages[-1])
            if messages
            else f"it ended with code {self._process.returncode}"
        )
        return UserError(f"{self._target}: cannot be written: ffmpeg: {why}")


FrameSink = Callable[..., None]  # takes pictures one by one, with labels and passes


@contextlib.contextmanager
def film(
    target: Path,
    size: tuple[int, int],
    frames_per_second: float,
    soundtrack: FilmSound | None = None,
) -> Iterator[FrameSink]:
    """Encode a film with ffmpeg, in the format of its suffix, with sound if the format allows it.

    size: width and height of the frames [pixels]; H.264 leaves out the last row or column of an
    odd side. Raises UserError if the film cannot be written.
    """
    fastest = FILM_FORMATS[target.suffix.lower()].fastest
    if frames_per_second > fastest:
        raise UserError(
            f"{target}: can have at most {fastest:g} frames a second, but --fps is "
            f"{frames_per_second:g}; lower --fps, or write another kind of film"
        )
    check_file(target)
    with written_atomically(target) as part:
        encoder = Encoder(target, part, size, frames_per_second, soundtrack)

        def add(image: Image, _: Labelled | None = None) -> None:
            """Pass a frame to ffmpeg; a film has no labels or passes."""
            encoder.add(image)

        with cleaned_up_if_stopped(encoder.stop):
            try:
                yield add
                encoder.finish()
            finally:
                encoder.stop()


@contextlib.contextmanager
def folder(target: Path, *, overwrite: bool) -> Iterator[FrameSink]:
    """Write frames as numbered PNG files; raise UserError if the folder is not empty.

    overwrite: replace the frames of an earlier film in the folder; other files stay.
    """
    count = 0
    waiting: deque[Future[None]] = deque()
    workers = share_of_cores()  # threads suffice: zlib takes most of the time

    def write(picture: Path, image: Image, beside: Labelled | None) -> None:
        """Write one frame, in a thread."""
        with cannot_be_written(target):
            PIL.Image.fromarray(image).save(picture, compress_level=QUICK_LEVEL)
            if beside is not None:
                beside.save(picture)

    frame_name = re.compile(rf"frame_\d{{5,}}(\.png|{'|'.join(map(re.escape, FILE_ENDS))})")
    with (
        folder_atomically(target, frame_name, overwrite=overwrite) as temporary,
        ThreadPoolExecutor(workers) as threads,
    ):

        def add(image: Image, beside: Labelled | None = None) -> None:
            """Write the next frame in a thread; raise errors of threads with earlier frames."""
            nonlocal count
            picture = temporary / f"frame_{count:05d}.png"
            waiting.append(threads.submit(write, picture, image, beside))
            count += 1
            if len(waiting) > workers:
                waiting.popleft().result()

        yield add
        while waiting:
            waiting.popleft().result()
