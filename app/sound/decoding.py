"""Decoding of sound files with ffmpeg: WAV, MP3, films and any other file with sound.

Films are written by the same ffmpeg, which `imageio_ffmpeg` includes.
"""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Floats64

from ..errors import UserError
from ..extras import optional_import
from ..files import read_bytes

if TYPE_CHECKING:
    from ..script import Script

SAMPLE_RATE = 48_000  # [samples/s] of sounds, also on devices and in films
FFMPEG_TIMEOUT = 300.0  # [s] for ffmpeg to read a file


@dataclass(frozen=True, eq=False)
class Sound:
    """A decoded sound.

    samples: (N, C) int16, where C is 1 or 2. rate: samples of each channel in a second.
    """

    file: Path
    samples: npt.NDArray[np.int16]
    rate: int = SAMPLE_RATE

    @property
    def duration(self) -> float:
        """The duration of the sound [s]."""
        return len(self.samples) / self.rate


class Peaks:
    """Lowest and highest values of a sound over all channels, stored for a waveform at any zoom."""

    BLOCK = 512  # samples that share a stored lowest and highest value

    def __init__(self, sound: Sound) -> None:
        self._rate = sound.rate
        low = sound.samples.min(axis=1)
        high = sound.samples.max(axis=1)
        starts = np.arange(0, len(low), self.BLOCK)
        low_blocks = np.minimum.reduceat(low, starts)
        high_blocks = np.maximum.reduceat(high, starts)
        self._levels = {self.BLOCK: (low_blocks, high_blocks), 1: (low, high)}
        self._loudest = max(-int(low_blocks.min()), int(high_blocks.max()), 1)

    def between(self, start: float, end: float, count: int) -> tuple[Floats64, Floats64]:
        """Return the lowest and highest value in each of `count` equal intervals of a time [s].

        Both have shape (count,). They are scaled to the sound's largest value, 1, so that a quiet
        recording is visible too, and are 0 where there is no sound. start: not below 0.
        """
        edges = np.linspace(start, end, count + 1) * self._rate
        # Intervals of four or more blocks read whole blocks, shorter intervals read samples.
        length = self.BLOCK if edges[-1] - edges[0] >= count * 4 * self.BLOCK else 1
        low, high = self._levels[length]
        indices = np.floor(edges / length).astype(np.int64)
        begins = indices[:-1]
        begins = begins[begins < len(low)]
        filled = len(begins)
        lowest = np.zeros(count)
        highest = np.zeros(count)
        if filled:
            first = int(begins[0])
            last = min(int(indices[filled]), len(low))
            last = max(last, int(begins[-1]) + 1)
            lowest[:filled] = np.minimum.reduceat(low[first:last], begins - first)
            highest[:filled] = np.maximum.reduceat(high[first:last], begins - first)
        return lowest / self._loudest, highest / self._loudest


def ffmpeg() -> str:
    """Return the path of ffmpeg; raise UserError if it is missing."""
    imageio_ffmpeg = optional_import(
        "imageio_ffmpeg", "film or sound", "films", package="imageio-ffmpeg"
    )
    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError:
        raise UserError(
            "no film without ffmpeg: install it, or write frames to a folder (-o NAME)"
        ) from None


def sound_form() -> tuple[str, ...]:
    """Return ffmpeg's options for a sound at `SAMPLE_RATE`, in stereo if it has two channels.

    If the sound begins late in its file, as it may in a film, the samples begin equally late.
    """
    form = f"aformat=sample_rates={SAMPLE_RATE}:channel_layouts=mono|stereo"
    return "-af", f"aresample=async=1:first_pts=0,{form}"


def sound_input(file: Path, seconds: float, begin: float = 0.0) -> tuple[str, ...]:
    """Return ffmpeg's options to read `seconds` of sound from a file, and from no network."""
    skipped = ("-ss", f"{begin:.6f}") if begin else ()
    return "-protocol_whitelist", "file", *skipped, "-t", f"{seconds:.6f}", "-i", f"file:{file}"


def load_sound(file: Path) -> Sound:
    """Read a sound file, or the sound of a film; raises UserError with the reason of a failure."""
    read_bytes(file, what="sound file", longest=2**40, first=0)
    name = ffmpeg()
    longest = 3600.0  # [s], which take 690 MB of memory in stereo
    source = sound_input(Path(os.path.abspath(file)), longest + 1.0)
    form = ["-map", "0:a:0", *sound_form(), "-f", "wav", "-c", "pcm_s16le"]
    try:
        heard = subprocess.run(
            [name, "-v", "error", "-nostdin", *source, *form, "-"],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=FFMPEG_TIMEOUT,
        )
    except OSError as error:
        raise UserError(f"no sound without ffmpeg: {name}: {error.strerror}") from None
    except subprocess.TimeoutExpired:
        raise UserError(f"{file}: ffmpeg did not read it within {FFMPEG_TIMEOUT:g} s") from None
    samples = _samples(heard.stdout)
    if not samples.size:
        raise UserError(
            f"{file}: holds no sound that ffmpeg can read; give a WAV, MP3, FLAC, M4A, "
            "or a film with sound"
        )
    sound = Sound(file, samples)
    if sound.duration > longest:
        raise UserError(f"{file}: is too long; a sound may have {longest / 60:g} minutes")
    return sound


def _samples(wav: bytes) -> npt.NDArray[np.int16]:
    """Return the samples, (N, C), in a 16-bit WAV that ffmpeg writes into a pipe."""
    channels = int.from_bytes(wav[22:24], "little") or 1
    begin = wav.find(b"data") + 8  # after the chunk's name, and a length that is wrong in a pipe
    count = (len(wav) - begin) // (2 * channels)
    if len(wav) < begin or count <= 0:
        return np.zeros((0, channels), np.int16)
    samples = np.frombuffer(wav, "<i2", count * channels, begin)
    return samples.reshape(-1, channels)


def with_sound(script: Script, file: Path | None) -> Script:
    """Return the script with another sound file, or unchanged for None.

    Raises UserError for an unusable file.
    """
    if file is None:
        return script
    load_sound(file)
    return replace(script, sound=Path(os.path.abspath(file)))
