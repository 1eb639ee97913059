"""Frames -> a film: ffmpeg as a process of its own, and its failures in one line.

`imageio_ffmpeg` only finds the program. Its own writer takes no notice of how ffmpeg ends, so a
film that a full disk cut short would pass as whole.
"""

from __future__ import annotations

import contextlib
import re
import subprocess
import tempfile
import time
from fractions import Fraction
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import numpy.typing as npt

from .errors import UserError

PATIENCE = 1.0  # [s] for the end of a killed process
# H.264; 4:2:0 as every player wants it, at a quality without blocks.
CODING = "-an -vcodec libx264 -pix_fmt yuv420p -crf 16 -preset veryfast -movflags +faststart"


class Encoder:
    """An ffmpeg that takes frames and writes the file `part`; `target` names it in error texts."""

    def __init__(
        self, target: Path, part: Path, size: tuple[int, int], frames_per_second: float
    ) -> None:
        """Start it, for frames of `size` pixels; UserError where there is none."""
        self._target = target
        rate = Fraction(frames_per_second).limit_denominator()
        frames = f"-f rawvideo -pix_fmt rgb24 -s {size[0]}x{size[1]} -r {rate} -i -"
        program = _program()
        self._words = tempfile.TemporaryFile()
        try:  # in a session of its own: Ctrl-C is for us alone
            self._process = subprocess.Popen(
                [program, "-v", "error", *frames.split(), *CODING.split(), f"file:{part}"],
                stdin=subprocess.PIPE,
                stderr=self._words,
                start_new_session=True,
            )
        except OSError as error:
            raise UserError(f"no film without ffmpeg: {program}: {error.strerror}") from None
        assert self._process.stdin is not None
        self._frames = self._process.stdin

    def add(self, frame: npt.NDArray[np.uint8]) -> None:
        """Hand over a frame, (H, W, 3); UserError where ffmpeg has given up."""
        try:
            self._frames.write(np.ascontiguousarray(frame).data)
        except BrokenPipeError:
            raise self._failure() from None

    def finish(self) -> None:
        """Wait until the file is whole; UserError if it is not."""
        with contextlib.suppress(BrokenPipeError):
            self._frames.close()
        if self._ended():
            raise self._failure()

    def stop(self) -> None:
        """End the process, whatever it is doing; does nothing after `finish`."""
        self._process.kill()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE)
        self._words.close()
        with contextlib.suppress(BrokenPipeError):
            self._frames.close()

    def _ended(self) -> int:
        """Wait for the end of the process, and return its code.

        Not with `wait`: that holds a lock for which `stop`, called by a signal, would wait forever.
        """
        while (code := self._process.poll()) is None:
            time.sleep(0.01)
        return code

    def _failure(self) -> UserError:
        code = self._ended()
        self._words.seek(0)
        said = self._words.read().decode(errors="replace").strip().splitlines()
        # Without the part of ffmpeg that speaks: "[out#0/mp4 @ 0x55e9629d] ".
        why = re.sub(r"^(\[[^]]*\] )+", "", said[-1]) if said else f"it ended with code {code}"
        return UserError(f"{self._target}: cannot be written: ffmpeg: {why}")


def _program() -> str:
    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError:
        raise UserError(
            "no film without ffmpeg: install it, or write frames to a folder (-o NAME)"
        ) from None
