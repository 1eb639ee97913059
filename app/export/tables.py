"""Writes tables: a clip as numpy arrays [mm], or ARKit's shapes as Live Link Face's CSV.

The CSV describes the visible face. Muscles, eyes and head follow their controls with different
delays, so the CSV has the delayed values of controls.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np

from ..control_names.angles import FULL_ANGLES
from ..recordings.named_columns import OUTWARD_ANGLES
from ..recordings.names import ARKIT_SHAPES
from ..rig.curves import as_seen, shape_curves
from ..rig.surface import RefinedSurface
from .clip import Clip
from .formats import ExportRequest


def write_npz(clip: Clip, part: Path, _: ExportRequest) -> None:
    """Write the arrays of a clip; docs/export.md lists their names."""
    arrays: dict[str, Any] = {"times": clip.times, "frames_per_second": clip.frames_per_second}
    for surface in clip.surfaces:
        is_skin = surface is clip.skin
        start = "" if is_skin else f"parts/{surface.name}/"
        arrays[f"{start}rest_positions"] = surface.rest
        for name in ("faces", "uv", "face_uv", "colours", "matrices", "shapes"):
            if (array := getattr(surface, name)) is not None:
                arrays["positions" if is_skin and name == "shapes" else f"{start}{name}"] = array
    if isinstance(clip.skin, RefinedSurface):
        arrays["source"] = clip.skin.source
    for kind in ("bones", "controls", "activations"):
        for name, values in getattr(clip, kind).items():
            arrays[f"{kind}/{name}"] = values
    with part.open("wb") as file:
        np.savez_compressed(file, **arrays)


def write_arkit(clip: Clip, part: Path, _: ExportRequest) -> None:
    """Write the 52 shapes and the angles of head and eyes, in Live Link Face's columns."""
    curves = shape_curves(clip.scene, clip.times, clip.activations, clip.controls)
    shapes = dict(zip(ARKIT_SHAPES, curves.T, strict=True))
    lowest = as_seen(clip.times, clip.activations)
    other_order = {  # Live Link Face has ARKit's order, except for these
        "jawLeft": "jawRight",
        "jawRight": "jawLeft",
        "mouthLeft": "mouthRight",
        "mouthRight": "mouthLeft",
    }
    names = [other_order.get(name, name) for name in ARKIT_SHAPES]
    still = np.zeros(clip.frame_count)
    # Live Link Face begins names with a capital: JawOpen.
    columns = {name[0].upper() + name[1:]: shapes[name] for name in names}
    # ARKit's angles [rad] are positive to the subject's right and down, and our controls to the
    # left and up. ARKit's roll is positive to the right shoulder, and the axes of eyes that look
    # straight ahead point outward.
    angle_columns = {
        "HeadYaw": "head_yaw",
        "HeadPitch": "head_pitch",
        "HeadRoll": "head_roll",
        "LeftEyeYaw": "gaze_horizontal_left",
        "LeftEyePitch": "gaze_vertical_left",
        "LeftEyeRoll": "",
        "RightEyeYaw": "gaze_horizontal_right",
        "RightEyePitch": "gaze_vertical_right",
        "RightEyeRoll": "",
    }
    for name, control in angle_columns.items():
        radians = -math.radians(FULL_ANGLES.get(control, 0.0))
        outward = math.radians(
            OUTWARD_ANGLES.get(control.replace("gaze_horizontal", "eye_yaw"), 0.0)
        )
        columns[name] = radians * lowest.get(control, still) - outward
    with part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["Timecode", "BlendShapeCount", *columns])
        decimals = 6  # with zeros at the end left out; saves a quarter of a table's size
        for time, *values in zip(clip.times, *columns.values(), strict=True):
            numbers = np.round(values, decimals) + 0.0  # -0 is 0
            texts = (np.format_float_positional(number, trim="-") for number in numbers)
            writer.writerow([_timecode(time), len(columns), *texts])


def _timecode(time: float) -> str:
    """Format a time [s] as HH:MM:SS:FF.fff, with frames and their fraction."""
    timecode_rate = 60  # Live Link Face counts this many frames a second at any camera rate
    thousandths = round(time * timecode_rate * 1000.0)
    frames, fraction = divmod(thousandths, 1000)
    seconds, frame = divmod(frames, timecode_rate)
    minutes, second = divmod(seconds, 60)
    return f"{minutes // 60:02}:{minutes % 60:02}:{second:02}:{frame:02}.{fraction:03}"
