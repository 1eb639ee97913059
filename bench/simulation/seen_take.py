"""A film of a recorded face, read back by a face tracker: does it see what was recorded?

The recording is played on the built-in head as `risorius capture` plays it, each frame and its
mirror image are shown to the tracker, and each shape that it scores is compared with the
calibrated recording at that time:

    moves   standard deviation of the recording; what moves less than MOVES is left out
    r       correlation over time; "-" where the tracker always answers the same

Shapes of a pair stand in one row, by their sides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.errors import UserError
from risorius.app.files import save_png
from risorius.app.recordings import read_take
from risorius.app.recordings.calibration import calibration_for
from risorius.app.recordings.conversion import script_of
from risorius.app.recordings.playback import Playback
from risorius.app.scenes import FaceScene

from ..report import table
from .face_tracker import FaceTracker, Scores, in_mirror, mean_of
from .seen import SIZE, bases

Array = npt.NDArray[np.float64]

MOVES = 0.02  # standard deviation of a channel
ANSWERS = 0.001  # standard deviation of a score
RATE = 30.0  # frames a second
VIEW = "front"


@dataclass(frozen=True)
class Channel:
    """How well one shape, or pair of shapes, is read back; None where there is nothing to say."""

    name: str
    moves: float
    left: float | None  # correlation; of a shape without side, too
    right: float | None = None


def measure(
    tracker: FaceTracker, recording: Path, pictures: Path | None = None
) -> tuple[list[Channel], int, int]:
    """Play a recording before the tracker.

    pictures: a folder for all frames. Returns the channels that move, how many frames there were,
    and in how many of them the tracker found no face. Raises UserError for what is no recording of
    ARKit's shapes.
    """
    take = read_take(recording)
    told = {
        name: values
        for name, values in calibration_for(take).apply(take.channels).items()
        if any(name in names for _, names in bases())
    }
    if not told:
        raise UserError(f"{recording}: {take.kind}: has none of ARKit's shapes to compare with")
    scene = FaceScene()
    script, _ = script_of(take, Playback(), scene.limits)
    options = CaptureOptions(size=SIZE, frames_per_second=RATE, camera=VIEW)
    times, seen, frames = [], [], 0
    with Capture(scene, options) as film:
        for number, time in enumerate(film.play(script)):
            image = film.draw_image()
            if pictures is not None:
                save_png(pictures / f"frame_{number:05d}.png", image)
            both = tracker.scores(image), in_mirror(tracker.scores(image[:, ::-1]))
            scores = mean_of(both)
            frames += 1
            if scores:
                times.append(time)
                seen.append(scores)
    if not seen:
        raise UserError(f"{recording}: the tracker finds no face in the film of it")
    at_frames = {name: np.interp(times, take.times, values) for name, values in told.items()}
    return compared(at_frames, seen), frames, frames - len(seen)


def compared(told: Mapping[str, Array], seen: Sequence[Scores]) -> list[Channel]:
    """Correlations of what was recorded, (T,) each, and the scores of T frames."""
    channels = []
    for name, names in bases():
        there = [each for each in names if each in told and np.std(told[each]) >= MOVES]
        if not there:
            continue
        found = [
            correlation(told[each], np.array([scores.get(each, 0.0) for scores in seen]))
            if each in there
            else None
            for each in names
        ]
        moves = max(float(np.std(told[each])) for each in there)
        channels.append(Channel(name, moves, *found))
    return channels


def correlation(told: Array, seen: Array) -> float | None:
    """Pearson's correlation; None where the tracker always answers the same."""
    if np.std(seen) < ANSWERS:
        return None
    return float(np.corrcoef(told, seen)[0, 1])


def report(channels: Sequence[Channel], frames: int, lost: int) -> str:
    """The text to print."""
    return "\n".join(
        [
            f"A film of the recording, {frames} frames at {RATE:g} a second, read back: how each",
            "shape that moves (its standard deviation) correlates with the recording, left and",
            "right, or both at once. What the tracker always scores alike has no correlation.",
            f"It found no face in {lost} frames.",
            "",
            *table("shape:<17|moves:6.2f|left:6.2f|right:6.2f", map(astuple, channels), empty="-"),
        ]
    )
