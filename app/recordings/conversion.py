"""Conversion of a take to a script: channels are calibrated, mapped, shifted in time and thinned.

Simulated muscles, eyes and head lag behind their controls by different delays. A converted script
sets each control earlier by its delay, so that the face is in time with the sound.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from risorius.geometry.arrays import Floats64

from ..control_names.limits import Limits
from ..playback import LEAD_TIME, Playback
from ..script import POSE_SECONDS, Channel, Pose, Script, rounded
from ..script.thinning import LINE_TOLERANCE, thinned
from ..text import in_one_line
from .calibration import calibration_for
from .mapping import controls_of
from .report import Report, report_of
from .take import Take


def script_of(take: Take, playback: Playback, limits: Limits) -> tuple[Script, Report]:
    """Return the script that plays a take on a face with these controls, and the report.

    Raises UserError for an impossible neutral or gain.
    """
    calibration = calibration_for(
        take, neutral=playback.neutral, gains=playback.gains, mirror=playback.mirror
    )
    controls = controls_of(calibration.apply(take.channels))
    curves = {
        name: limits.cut_off(values, limits.places((name,)))
        for name, values in controls.items()
        if name in limits
    }
    return _script(take, curves, playback.lead), report_of(take, calibration)


def _script(take: Take, curves: Mapping[str, Floats64], lead: float) -> Script:
    """Return a script with a track for each moving control, or with a pose for a single frame."""
    title = Path(take.source).stem
    preface = f"# Made of {in_one_line(Path(take.source).name)}, {take.kind}.\n"
    moved = {
        name: values for name, values in curves.items() if np.abs(values).max() > LINE_TOLERANCE
    }
    # The camera stands where the camera of the recording stood.
    script = Script(
        title,
        duration=rounded(take.duration),
        source=take.source,
        camera="front",
        sound=take.sound,
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
    """Return the lead of a control [s], in proportion to its lag; given the lead of muscles."""
    # Lag of eyes and head [s]; LEAD_TIME is the lag of muscles and skin. Measured at 60 Hz.
    lateness = {"gaze_": 0.008, "eyeLook": 0.008, "head_": 0.063}
    late = next((each for start, each in lateness.items() if control.startswith(start)), LEAD_TIME)
    return lead * late / LEAD_TIME


def _track(times: Floats64, values: Floats64, lead: float) -> Channel:
    """Return the keys of one control, earlier by `lead` [s]; keys before time 0 are left out."""
    at_beginning = np.interp(lead, times, values)
    least_step = 1e-3  # [s] between the first two keys
    later = times > lead + least_step
    return thinned(
        np.concatenate([[0.0], times[later] - lead]),
        np.concatenate([[at_beginning], values[later]]),
    )
