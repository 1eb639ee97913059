"""A take -> a script that plays it: smoothed if asked, calibrated, mapped, read ahead, thinned.

Muscles, eyes and head follow their controls late, each in its own time. A script that is made of a
recording therefore asks for everything earlier by just that, so that the face is on time, as is its
sound.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..errors import in_one_line
from ..script import POSE_SECONDS, TOLERANCE, Channel, Limits, Pose, Script, rounded, thinned
from .calibration import ANGLES, calibration_for, note_of_neutral
from .mapping import load_mapping
from .report import Report, report_of
from .take import Array, Take

LEAD = 0.047  # [s] that muscles and the skin on them follow late
LEAST_STEP = 1e-3  # [s] between the first two keys
STILL = 1.5  # [Hz] that pass while nothing moves
OPENING = 3.0  # [Hz] more for each unit a second; a blink has five, and passes
SPEED = 1.0  # [Hz] that pass of the speed itself
DEGREES = 30.0  # of an angle that count as one unit
CAMERA = "front"  # from where recorded faces were seen
# How late eyes and head follow [s], where muscles and skin do by LEAD; all measured at 60 Hz.
_LATE = {"gaze_": 0.008, "eyeLook": 0.008, "head_": 0.063}


@dataclass(frozen=True)
class Playback:
    """How a recording becomes a script; what is not said is as suits the kind of file.

    neutral: "first:SECONDS", "percentile" or "none". gains: "NAME=x" each. mirror: left and right
    change places. smooth: whether channels go through the one-euro filter. lead: how far muscles
    are asked ahead of the recording [s]; eyes and head in proportion. mapping: a table of one's
    own. face, rate: see `read_take`.
    """

    neutral: str | None = None
    gains: tuple[str, ...] = ()
    mirror: bool = False
    smooth: bool = False
    lead: float = LEAD
    mapping: Path | None = None
    face: str | None = None
    rate: float | None = None


def script_of(take: Take, playback: Playback, limits: Limits) -> tuple[Script, Report]:
    """The script that plays a take on a face with these controls, and what there is to say.

    Raises UserError for a neutral, a gain or a mapping that cannot be.
    """
    mapping = load_mapping(playback.mapping)
    mapping.check(limits)
    calibration = calibration_for(
        take, neutral=playback.neutral, gains=playback.gains, mirror=playback.mirror
    )
    smooth = smoothed(take) if playback.smooth else take
    controls = mapping.controls(calibration.apply(smooth.channels))
    curves = {
        name: np.clip(values, *limits[name]) for name, values in controls.items() if name in limits
    }
    take = replace(take, notes=(*note_of_neutral(take, playback.neutral), *take.notes))
    report = report_of(take, calibration, mapping, controls, limits)
    script = _script(take, curves, playback.lead)
    return script, report


def _script(take: Take, curves: Mapping[str, Array], lead: float) -> Script:
    """Tracks of what moves; of a single frame a pose."""
    title = Path(take.source).stem
    preface = f"# Made of {in_one_line(Path(take.source).name)}, {take.kind}.\n"
    moved = {name: values for name, values in curves.items() if np.abs(values).max() > TOLERANCE}
    script = Script(
        title,
        duration=rounded(take.duration),
        source=take.source,
        camera=CAMERA,
        poses=(Pose(0.0),),
        preface=preface,
        is_converted=True,
    )
    if len(take.times) == 1:
        pose = Pose(0.0, {name: rounded(values[0]) for name, values in moved.items()})
        return replace(script, duration=POSE_SECONDS, poses=(pose,))
    tracks = {
        name: _track(take.times, values, lead_of(name, lead)) for name, values in moved.items()
    }
    return replace(script, poses=(), tracks=tracks) if tracks else script


def lead_of(control: str, lead: float) -> float:
    """How much earlier a control is asked for [s], if muscles are by `lead`."""
    late = next((each for start, each in _LATE.items() if control.startswith(start)), LEAD)
    return lead * late / LEAD


def _track(times: Array, values: Array, lead: float) -> Channel:
    """The keys of one control, so much earlier [s]; what comes before the beginning is left out."""
    at_beginning = np.interp(lead, times, values)
    later = times > lead + LEAST_STEP
    return thinned(
        np.concatenate([[0.0], times[later] - lead]),
        np.concatenate([[at_beginning], values[later]]),
    )


def smoothed(take: Take) -> Take:
    """The take with each channel through a one-euro filter, slow where a face is still.

    Off unless asked for, since muscles filter by themselves. It costs time and height: a channel
    comes 15 to 45 ms later, and a short peak loses up to 14 % (measured on a phone's take).
    Source: Casiez, Roussel, Vogel 2012, "1 Euro Filter".
    """
    units = np.array([DEGREES if name in ANGLES else 1.0 for name in take.channels])
    rows = np.stack(list(take.channels.values()), axis=1)  # (T, channels)
    speeds = np.zeros(len(units))
    steps = np.diff(take.times).tolist()
    for (before, row), seconds in zip(pairwise(rows), steps, strict=True):
        moved = row - before
        speeds += _share(SPEED, seconds) * (moved / units / seconds - speeds)
        row[:] = before + _share(STILL + OPENING * np.abs(speeds), seconds) * moved
    return replace(take, channels=dict(zip(take.channels, rows.T.copy(), strict=True)))


def _share(cut_off: float | Array, seconds: float) -> Array:
    """How far a low-pass filter goes towards the new value in a frame."""
    turn = 2.0 * math.pi * seconds * np.asarray(cut_off)
    return turn / (turn + 1.0)
