"""Draw the pictures of docs/capture.md: `xvfb-run -a python docs/figures/capture.py [FOLDER]`.

The recordings in them are made up here, in the layout of Live Link Face: as a phone does, it sees a
quarter of a frown in a face at rest. So is the voice of the one that speaks.
"""

from __future__ import annotations

import tempfile
import threading
import wave
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import figures
import numpy as np
import numpy.typing as npt
from imgui_bundle import imgui

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.captions import contact_sheet
from risorius.app.files import Image
from risorius.app.live import LOOPBACK, Listening
from risorius.app.live.sender import Sender
from risorius.app.performances import read_performance, script_for
from risorius.app.recordings.conversion import Playback
from risorius.app.recordings.names import ARKIT
from risorius.app.recordings.reading import read_take
from risorius.app.scenes import FaceScene
from risorius.app.script.keyframes import places_of
from risorius.app.viewer import Viewer
from risorius.bench.canvas import without_noise

Part = tuple[tuple[str, ...], float, tuple[float, float, float, float]]  # see PLAYED

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
TALL_WINDOW = (1160, 760)
SMILING = 0.7  # of a smile, live
ANGLES = ("HeadYaw", "HeadPitch", "HeadRoll", "LeftEyeYaw", "LeftEyePitch", "LeftEyeRoll",
          "RightEyeYaw", "RightEyePitch", "RightEyeRoll")  # fmt: skip
AT_REST = {  # what a phone reads in a face that does nothing
    "browDown": 0.28, "noseSneer": 0.16, "mouthShrugUpper": 0.16, "mouthStretch": 0.13,
    "mouthLowerDown": 0.1, "cheekSquint": 0.1, "jawForward": 0.09, "mouthDimple": 0.08,
    "mouthPress": 0.07, "eyeSquint": 0.06, "mouthFunnel": 0.06, "mouthUpperUp": 0.05,
}  # fmt: skip
PLAYED: tuple[
    Part, ...
] = (  # shapes by the beginning of their names, and when: rise, full, fall, rest [s]
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
SMILED: tuple[Part, ...] = (  # from some time on, so that slow machines see it, too
    (("mouthSmile",), 0.85, (2.9, 3.3, 29.0, 30.0)),
    (("cheekSquint", "mouthUpperUp", "mouthDimple"), 0.3, (2.9, 3.3, 29.0, 30.0)),
)
SYLLABLES = (0.5, 0.68, 0.9, 1.05, 1.3, 1.9, 2.1, 2.26, 2.5, 2.66, 2.9, 3.6, 3.8, 4.05, 4.2, 4.4,
             4.62, 5.3, 5.5, 5.7, 5.95)  # fmt: skip
SPOKEN: tuple[
    Part, ...
] = (  # the mouth for each syllable that begins there [s]: open, every third one rounded, shut
    *((("jawOpen",), 0.25 + at % 0.3, (at, at + 0.06, at + 0.1, at + 0.2)) for at in SYLLABLES),
    *((("mouthPucker",), 0.6, (at - 0.1, at, at + 0.12, at + 0.25)) for at in SYLLABLES[::3]),
    *((("mouthSmile",), 0.3, (at - 0.1, at + 0.02, at + 0.1, at + 0.3)) for at in SYLLABLES[1::4]),
    *((("eyeBlink",), 0.9, (at, at + 0.08, at + 0.12, at + 0.26)) for at in (1.55, 3.2, 5.0)),
    (("browInnerUp",), 0.5, (1.7, 1.95, 2.3, 2.9)),
    (("HeadYaw",), 0.15, (1.0, 2.0, 3.0, 4.5)),
    (("HeadPitch",), -0.12, (3.3, 3.7, 4.3, 5.2)),
)
PITCH, SOUND_RATE = 120.0, 16_000  # of the voice [Hz], [samples/s]
TRACKS_WINDOW = (1160, 820)


def written(path: Path, played: Sequence[Part] = PLAYED, seconds: float = SECONDS) -> Path:
    """The recording, in a file."""
    times = np.arange(round(seconds * RATE) + 1) / RATE
    columns = [curve(name, times, played) for name in (*ARKIT, *ANGLES)]
    header = [
        "Timecode",
        "BlendShapeCount",
        *(name[0].upper() + name[1:] for name in ARKIT),
        *ANGLES,
    ]
    lines = [",".join(header)]
    for index, row in enumerate(np.stack(columns, axis=1)):
        timecode = f"10:20:{30 + index // RATE}:{index % RATE:02}.000"
        lines.append(f"{timecode},61," + ",".join(f"{value:.6f}" for value in row))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def voice(path: Path) -> Path:
    """A hum that is as loud as the jaw is open, in a sound file."""
    times = np.arange(round(SECONDS * SOUND_RATE)) / SOUND_RATE
    loudness = curve("jawOpen", times, SPOKEN)
    samples = 1.8 * loudness * (2.0 * (PITCH * times % 1.0) - 1.0)
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(SOUND_RATE)
        file.writeframes(np.round(32_000 * samples.clip(-1.0, 1.0)).astype("<i2").tobytes())
    return path


def curve(
    name: str, times: npt.NDArray[np.float64], played: Sequence[Part]
) -> npt.NDArray[np.float64]:
    """One column: what it is at rest, and above that what is played."""
    rest = next((value for start, value in AT_REST.items() if name.startswith(start)), 0.0)
    values = np.full(len(times), rest)
    for starts, most, stops in played:
        if name.startswith(starts):
            share = np.interp(times, stops, (0.0, 1.0, 1.0, 0.0))
            values += (most - rest) * share * share * (3.0 - 2.0 * share)
    return values


def neutral(take: Path) -> Image:
    """The same frames as they were recorded, and without the neutral face."""
    rows = []
    options = CaptureOptions(size=CELL, camera=CAMERA)
    with Capture(FaceScene(), options) as capture:
        for method, title in (("none", "as recorded"), (None, "calibrated")):
            script, _ = read_performance(take, Playback(neutral=method))
            last = iter(MOMENTS.items())
            moment, what = next(last)
            for now in capture.play(script, until=max(MOMENTS), progress=False):
                if abs(now - moment) < 0.5 / options.frames_per_second:
                    rows.append((f"{title}, {what}", capture.draw_image()))
                    moment, what = next(last, (np.inf, ""))
    sheet = contact_sheet(rows, columns=len(MOMENTS), cell_width=CELL[0])
    return without_noise(sheet)


def tracks(folder: Path) -> Image:
    """A window with a recording that speaks: its sound, and its tracks unfolded."""
    take, sound = written(folder / "speech.csv", SPOKEN), voice(folder / "speech.wav")
    with Viewer(script_for(None, "face"), TRACKS_WINDOW) as viewer:
        imgui.get_io().config_flags |= imgui.ConfigFlags_.no_mouse
        viewer.messages.attempt(lambda: viewer.scripts.open(take))
        viewer.messages.attempt(lambda: viewer.scripts.set_sound(sound))
        viewer.settings.folds["Tracks"] = True
        viewer.session.seek(2.14)
        viewer.frame()
        viewer.selection.places = places_of(viewer.session.script).between(3.55, 4.4)
        for _ in range(90):
            viewer.messages.seconds_left = 0.0
            viewer.frame()
        return without_noise(viewer.surface.read())


def live(folder: Path) -> Image:
    """A window that follows a recording, sent by another thread as a phone does."""
    take = written(folder / "live.csv", SMILED, 25.0)
    with Viewer(script_for(None, "face"), TALL_WINDOW) as viewer:
        imgui.get_io().config_flags |= imgui.ConfigFlags_.no_mouse
        viewer.refresh = 0.0  # panels in every frame
        viewer.live.start(Listening("livelink"))
        with Sender("livelink", LOOPBACK, None, "my phone") as sender:
            thread = threading.Thread(target=sender.play, args=(read_take(take),))
            thread.start()
            while not viewer.live.can_calibrate:
                viewer.frame()
            viewer.live.calibrate()
            while viewer.session.current["mouthSmileLeft"] < SMILING:
                viewer.frame()
            for _ in range(8):  # muscles follow
                viewer.frame()
            picture = without_noise(viewer.surface.read())
            thread.join()
    return picture


def main(arguments: Sequence[str]) -> None:
    """Draw the pictures into the folder given."""
    given = figures.parse(arguments, __doc__)
    with tempfile.TemporaryDirectory() as folder:
        take = written(Path(folder) / "take.csv")
        every = {
            "capture_neutral": partial(neutral, take),
            "capture_tracks": partial(tracks, Path(folder)),
            "capture_live": partial(live, Path(folder)),
        }
        figures.draw(given.folder, figures.chosen(every, given.only))


if __name__ == "__main__":
    figures.run(main)
