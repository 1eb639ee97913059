"""A sound file -> its samples. Any file that ffmpeg hears something in: WAV, MP3, a film."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..errors import UserError
from ..ffmpeg import RATE, program, sound_form, sound_input
from ..files import read_bytes
from ..script import Script

LONGEST = 3600.0  # [s]; all of it is held in memory, 690 MB for so long in stereo
PATIENCE = 300.0  # [s] for ffmpeg to read a file


@dataclass(frozen=True, eq=False)
class Sound:
    """Samples over time.

    samples: (N, C) int16, where C is 1 or 2. rate: of each channel [samples/s].
    """

    file: Path
    samples: npt.NDArray[np.int16]
    rate: int = RATE

    @property
    def duration(self) -> float:
        """Of all of it [s]."""
        return len(self.samples) / self.rate


def load_sound(file: Path) -> Sound:
    """Read a sound file, or the sound of a film; UserError says why there is none in it."""
    read_bytes(file, what="sound file", longest=2**40, first=0)
    name = program()
    source = sound_input(Path(os.path.abspath(file)), LONGEST + 1.0)
    form = ["-map", "0:a:0", *sound_form(), "-f", "wav", "-c", "pcm_s16le"]
    try:
        heard = subprocess.run(
            [name, "-v", "error", "-nostdin", *source, *form, "-"],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=PATIENCE,
        )
    except OSError as error:
        raise UserError(f"no sound without ffmpeg: {name}: {error.strerror}") from None
    except subprocess.TimeoutExpired:
        raise UserError(f"{file}: ffmpeg did not read it within {PATIENCE:g} s") from None
    samples = _samples(heard.stdout)
    if not samples.size:
        raise UserError(
            f"{file}: there is no sound in it that ffmpeg can read; give a WAV, MP3, FLAC, M4A, "
            "or a film that is heard"
        )
    sound = Sound(file, samples)
    if sound.duration > LONGEST:
        raise UserError(f"{file}: is longer than a sound may be, {LONGEST / 60:g} minutes")
    return sound


def _samples(wav: bytes) -> npt.NDArray[np.int16]:
    """The samples in a WAV of 16 bits as ffmpeg writes it into a pipe, (N, C)."""
    channels = int.from_bytes(wav[22:24], "little") or 1
    begin = wav.find(b"data") + 8  # behind the chunk's name and its length, which no pipe knows
    count = (len(wav) - begin) // (2 * channels)
    if len(wav) < begin or count <= 0:
        return np.zeros((0, channels), np.int16)
    samples = np.frombuffer(wav, "<i2", count * channels, begin)
    return samples.reshape(-1, channels)


def with_sound(script: Script, file: Path | None) -> Script:
    """The script with this sound file beside it; None leaves what it has. UserError for no file."""
    if file is None:
        return script
    load_sound(file)
    return replace(script, sound=Path(os.path.abspath(file)))
