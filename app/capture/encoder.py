"""Frames -> a film: ffmpeg as a process of its own, and its failures in one line.

The writer of `imageio_ffmpeg` takes no notice of how ffmpeg ends, so a film that a full disk cut
short would pass as whole, and waits for ever for one that hangs.
"""

from __future__ import annotations

import contextlib
import os
import re
import select
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..errors import UserError
from ..ffmpeg import program, sound_form, sound_input
from .formats import FORMATS

PATIENCE = 60.0  # [s] without a sign of life, until ffmpeg is given up
TICK = 0.01  # [s] between two looks at it
DYING = 1.0  # [s] for the end of a killed process


@dataclass(frozen=True)
class Soundtrack:
    """What is heard in a film: a sound file from `begin` [s] on, for so many seconds at most."""

    file: Path
    seconds: float
    begin: float = 0.0

    def options(self, coding: str) -> list[str]:
        """Of ffmpeg, which has the frames as its first input."""
        source = sound_input(self.file, self.seconds, self.begin)
        return [*source, "-map", "0:v", "-map", "1:a:0", *coding.split(), *sound_form()]


class Encoder:
    """An ffmpeg that takes frames and writes the file `part`; `target` names it in error texts."""

    def __init__(
        self,
        target: Path,
        part: Path,
        size: tuple[int, int],
        frames_per_second: float,
        soundtrack: Soundtrack | None = None,
        *,
        is_transparent: bool = False,
    ) -> None:
        """Start it, for frames of `size` pixels; UserError where there is none."""
        form = FORMATS[target.suffix.lower()]
        coding = form.transparent if is_transparent else form.coding
        assert coding is not None
        self._target, self._part = target, part
        rate = Fraction(frames_per_second).limit_denominator()
        pixels = "rgba" if is_transparent else "rgb24"
        frames = f"-f rawvideo -pix_fmt {pixels} -s {size[0]}x{size[1]} -r {rate} -i -"
        sound = ["-an"]
        if soundtrack is not None and form.sound is not None:
            sound = soundtrack.options(form.sound)
        name = program()
        self._messages = tempfile.TemporaryFile()
        try:  # in a session of its own: Ctrl-C is for us alone
            self._process = subprocess.Popen(
                [name, "-v", "error", *frames.split(), *sound, *coding.split(), f"file:{part}"],
                stdin=subprocess.PIPE,
                stderr=self._messages,
                bufsize=0,
                start_new_session=True,
            )
        except OSError as error:
            raise UserError(f"no film without ffmpeg: {name}: {error.strerror}") from None
        assert self._process.stdin is not None
        self._frames = self._process.stdin
        if sys.platform != "win32":  # there a pipe cannot be waited for
            os.set_blocking(self._frames.fileno(), False)

    def add(self, image: npt.NDArray[np.uint8]) -> None:
        """Hand over a frame, (H, W, 3 or 4); UserError where ffmpeg has given up, or hangs."""
        left = np.ascontiguousarray(image).data.cast("B")
        try:
            while left:
                self._wait_until(self._takes_more)
                left = left[self._frames.write(left) or 0 :]
        except BrokenPipeError:
            raise self._failure() from None

    def finish(self) -> None:
        """Wait until the file is whole; UserError if it is not."""
        self._frames.close()
        if self._end_code():
            raise self._failure()

    def stop(self) -> None:
        """End the process and those that it began, whatever they do; nothing after `finish`."""
        if sys.platform == "win32":
            self._process.kill()
        else:
            with contextlib.suppress(OSError):  # none of them is left
                os.killpg(self._process.pid, signal.SIGKILL)  # its session is its group
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(DYING)
        self._messages.close()
        self._frames.close()

    def _takes_more(self) -> bool:
        if sys.platform == "win32":
            return True
        return bool(select.select([], [self._frames], [], TICK)[1])

    def _end_code(self) -> int:
        """Wait for the end of the process, and return its code.

        Not with `wait`: that holds a lock for which `stop`, called by a signal, would wait forever.
        """

        def has_ended() -> bool:
            time.sleep(TICK)
            return self._process.poll() is not None

        self._wait_until(has_ended)
        return int(self._process.returncode)

    def _wait_until(self, is_over: Callable[[], bool]) -> None:
        """Wait; UserError where nothing happens for so long that nothing will.

        A film that grows is a sign of life: to write its last frames, and then to move the index
        of a long one to its front, may take minutes. Ticks are counted, not seconds, so that no
        time passes while this process is stopped itself.
        """
        idle, seen = 0, self._state_of_film()
        while not is_over():
            now = self._state_of_film()
            idle, seen = (idle + 1 if now == seen else 0), now
            if idle * TICK > PATIENCE:
                raise UserError(
                    f"{self._target}: cannot be written: ffmpeg hangs, it did nothing for "
                    f"{PATIENCE:g} s; try again, or write frames to a folder (-o NAME)"
                )

    def _state_of_film(self) -> object:
        try:
            found = self._part.stat()
        except OSError:
            return None
        return found.st_size, found.st_mtime_ns

    def _failure(self) -> UserError:
        code = self._end_code()
        self._messages.seek(0)
        said = self._messages.read().decode(errors="replace").strip().splitlines()
        # Without the part of ffmpeg that speaks: "[out#0/mp4 @ 0x55e9629d] ".
        why = re.sub(r"^(\[[^]]*\] )+", "", said[-1]) if said else f"it ended with code {code}"
        return UserError(f"{self._target}: cannot be written: ffmpeg: {why}")
