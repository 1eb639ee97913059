"""Draw the picture of docs/capture.md: `python docs/figures/capture.py [FOLDER]`.

The recording in it is made up here, in the layout of Live Link Face: as a phone does, it sees a
quarter of a frown in a face at rest.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import figures
import numpy as np
import numpy.typing as npt

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.files import Image
from risorius.app.performances import read_performance
from risorius.app.recordings.conversion import Playback
from risorius.app.recordings.names import ARKIT
from risorius.app.scenes import FaceScene

RATE = 60  # frames a second
SECONDS = 7.0
CELL = (260, 300)  # [pixels] of a frame
CAMERA = "0,0,0.95"
MOMENTS = {
    0.5: "at rest",
    1.2: "blink",
    2.1: "surprise",
    3.5: "smile",
    4.75: "kiss",
    6.1: "to the left",
}
ANGLES = ("HeadYaw", "HeadPitch", "HeadRoll", "LeftEyeYaw", "LeftEyePitch", "LeftEyeRoll",
          "RightEyeYaw", "RightEyePitch", "RightEyeRoll")  # fmt: skip
AT_REST = {  # what a phone reads in a face that does nothing
    "browDown": 0.28, "noseSneer": 0.16, "mouthShrugUpper": 0.16, "mouthStretch": 0.13,
    "mouthLowerDown": 0.1, "cheekSquint": 0.1, "jawForward": 0.09, "mouthDimple": 0.08,
    "mouthPress": 0.07, "eyeSquint": 0.06, "mouthFunnel": 0.06, "mouthUpperUp": 0.05,
}  # fmt: skip
# Shapes by the beginning of their names, how far, and when: rise, full, fall, rest [s].
PLAYED: tuple[tuple[tuple[str, ...], float, tuple[float, float, float, float]], ...] = (
    (("eyeBlink",), 0.9, (1.08, 1.16, 1.24, 1.38)),
    (("browInnerUp", "browOuterUp"), 0.9, (1.7, 1.95, 2.3, 2.7)),
    (("eyeWide",), 0.8, (1.7, 1.95, 2.3, 2.7)),
    (("jawOpen",), 0.35, (1.75, 2.0, 2.3, 2.6)),
    (("mouthSmile",), 0.85, (2.9, 3.3, 3.8, 4.2)),
    (("cheekSquint", "mouthUpperUp", "mouthDimple"), 0.3, (2.9, 3.3, 3.8, 4.2)),
    (("eyeBlink",), 0.85, (4.28, 4.36, 4.42, 4.54)),
    (("mouthPucker",), 0.8, (4.35, 4.65, 4.9, 5.2)),
    (("HeadYaw",), -0.35, (5.3, 5.8, 6.4, 6.9)),
    (("LeftEyeYaw", "RightEyeYaw"), -0.2, (5.2, 5.3, 6.2, 6.5)),
    (("eyeLookOutLeft", "eyeLookInRight"), 0.33, (5.2, 5.3, 6.2, 6.5)),
)


def written(path: Path) -> Path:
    """The recording, in a file."""
    times = np.arange(round(SECONDS * RATE) + 1) / RATE
    columns = [curve(name, times) for name in (*ARKIT, *ANGLES)]
    names = (name[0].upper() + name[1:] for name in ARKIT)
    lines = [",".join(["Timecode", "BlendShapeCount", *names, *ANGLES])]
    for index, row in enumerate(np.stack(columns, axis=1)):
        timecode = f"10:20:{30 + index // RATE}:{index % RATE:02}.000"
        lines.append(f"{timecode},61," + ",".join(f"{value:.6f}" for value in row))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def curve(name: str, times: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """One column: what it is at rest, and above that what is played."""
    rest = next((value for start, value in AT_REST.items() if name.startswith(start)), 0.0)
    values = np.full(len(times), rest)
    for starts, most, stops in PLAYED:
        if name.startswith(starts):
            share = np.interp(times, stops, (0.0, 1.0, 1.0, 0.0))
            values += (most - rest) * share * share * (3.0 - 2.0 * share)
    return values


def neutral() -> Image:
    """The same frames as they were recorded, and without the neutral face."""
    cells = []
    options = CaptureOptions(size=CELL, camera=CAMERA)
    with tempfile.TemporaryDirectory() as folder, Capture(FaceScene(), options) as capture:
        take = written(Path(folder) / "take.csv")
        for method, title in (("none", "as recorded"), (None, "calibrated")):
            script, _ = read_performance(take, Playback(neutral=method))
            last = iter(MOMENTS.items())
            moment, what = next(last)
            for now in capture.play(script, until=max(MOMENTS), progress=False):
                if abs(now - moment) < 0.5 / options.frames_per_second:
                    cells.append((f"{title}, {what}", capture.draw_image()))
                    moment, what = next(last, (np.inf, ""))
    return figures.sheet(cells, len(MOMENTS))


if __name__ == "__main__":
    figures.run(__doc__, {"capture_neutral": neutral})
