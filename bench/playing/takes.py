"""How long a long recording takes: to be read, to become a script, and to be played.

The recording is made up, as a phone would write it: 60 frames a second, 52 shapes and 9 angles,
which speak, blink, look about and tremble in their last digits.
"""

from __future__ import annotations

import io
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from risorius.app.performances import limits_of
from risorius.app.recordings import read_take
from risorius.app.recordings.conversion import script_of
from risorius.app.recordings.names import ARKIT
from risorius.app.recordings.playback import Playback

from ..report import table

RATE = 60  # frames a second
ROUNDS = 3
FRAMES_TIMED = 3000
TREMOR = (
    1.3e-3  # of a value, standard deviation; a quarter of the samples become keys, as a phone's
)
ANGLES = ("HeadYaw", "HeadPitch", "HeadRoll", "LeftEyeYaw", "LeftEyePitch", "LeftEyeRoll",
          "RightEyeYaw", "RightEyePitch", "RightEyeRoll")  # fmt: skip

Result = TypeVar("Result")


def report(minutes: float) -> str:
    """Measure a recording of so many minutes, and tell."""
    limits = limits_of("face")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "take.csv"
        path.write_text(made_up(minutes), encoding="utf-8")
        size = path.stat().st_size / 1e6
        script_of(read_take(path), Playback(), limits)  # compiles what there is to compile
        reading, converting = [], []
        for _ in range(ROUNDS):
            seconds, take = _timed(lambda: read_take(path))
            reading.append(seconds)
            seconds, (script, _) = _timed(lambda: script_of(take, Playback(), limits))  # noqa: B023
            converting.append(seconds)
    moments = np.linspace(0.0, script.duration, FRAMES_TIMED).tolist()
    playing = [_timed(lambda: script.at(moment))[0] for moment in moments]  # noqa: B023
    keys = sum(len(channel) for channel in script.tracks.values())
    both = np.median(np.add(reading, converting))
    rows = (
        ("read the file", np.median(reading)),
        ("calibrate, map, thin", np.median(converting)),
        ("both", both),
        ("values of one frame", np.median(playing)),
    )
    head = (
        f"{minutes:g} minutes: {len(take.times)} frames, {size:.0f} MB; a script of "
        f"{len(script.tracks)} tracks with {keys} keys"
    )
    return "\n".join([head, *table("stage:<22|median [s]:12.5f", rows, indent="  ")])


def made_up(minutes: float) -> str:
    """A recording in the layout of Live Link Face's CSV."""
    generator = np.random.default_rng(2003)
    times = np.arange(round(minutes * 60 * RATE)) / RATE
    columns = [_shape(name, times, generator) for name in ARKIT]
    for name in ANGLES:
        size = 0.0 if name.endswith("EyeRoll") else 0.12
        columns.append(size * np.sin(times * generator.uniform(0.3, 1.5) + generator.uniform(0, 6)))
    text = io.StringIO()
    header = [name[0].upper() + name[1:] for name in ARKIT]
    text.write(",".join(["Timecode", "BlendShapeCount", *header, *ANGLES]) + "\n")
    line = ",".join(["%.8f"] * len(columns))
    for index, row in enumerate(np.stack(columns, axis=1).tolist()):
        second, frame = divmod(index, RATE)
        hour, minute = second // 3600, second // 60 % 60
        timecode = f"{hour:02}:{minute:02}:{second % 60:02}:{frame:02}.000"
        text.write(f"{timecode},61,{line % tuple(row)}\n")
    return text.getvalue()


def _shape(
    name: str, times: npt.NDArray[np.float64], generator: np.random.Generator
) -> npt.NDArray[np.float64]:
    """Values of one shape: blinks every few seconds, all else coming and going."""
    if name.startswith("eyeBlink"):
        values = np.maximum(0.0, 1.0 - np.abs((times % 3.7) - 1.0) / 0.12) ** 0.5
    else:
        waves = generator.uniform(0.5, 9.0, 3)[:, None] * times + generator.uniform(0, 6, (3, 1))
        values = np.maximum(0.0, 0.25 * np.sin(waves).sum(axis=0))
    return np.clip(values + TREMOR * generator.standard_normal(len(times)), 0.0, 1.0)


def _timed(task: Callable[[], Result]) -> tuple[float, Result]:
    start = time.perf_counter()
    result = task()
    return time.perf_counter() - start, result
