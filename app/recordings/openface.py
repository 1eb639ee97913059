"""OpenFace's CSV (1 and 2): action units 0 to 5, head pose, and gaze in the camera's axes.

Source: OpenFace's wiki, "Output Format". The camera's x points to the subject's left, y points
down. Positive pose_Rx is down, pose_Ry to the subject's right, pose_Rz to the subject's left
shoulder; positive gaze x is to the subject's left, y down. All angles are in radians. Left and
right muscles have one value.
"""

from __future__ import annotations

import re

import numpy as np

from risorius.geometry.arrays import Floats64

from .gaps import take_from_rows
from .names import EYE_ANGLES
from .table import Table, one_face
from .take import Take, TakeRequest
from .timing import times_of
from .values import intensities, rows_without_face, without_rows

INTENSITY_NAME = re.compile(r"au(\d\d)_r$")
PRESENCE_NAME = re.compile(r"au(\d\d)_c$")
GAZE_ANGLES = ("gaze_angle_x", "gaze_angle_y")
GAZE_VECTORS = ("gaze_0_x", "gaze_0_y", "gaze_0_z", "gaze_1_x", "gaze_1_y", "gaze_1_z")


def recognises(names: tuple[str, ...]) -> bool:
    """Whether these are columns of OpenFace; many tools keep only some of them."""
    folded = {name.casefold() for name in names}
    units = [name for name in folded if INTENSITY_NAME.match(name) or PRESENCE_NAME.match(name)]
    own = folded & {"success", "confidence", "pose_rx", *GAZE_ANGLES, *GAZE_VECTORS}
    has_sides = any(re.match(r"au\d\d_l(eft)?$", name) for name in folded)
    return bool(units) and not has_sides and (bool(own) or len(units) > 1)


def read(table: Table, request: TakeRequest) -> Take:
    """Return the take in the table."""
    table = one_face(table, request)
    notes: list[str] = []
    times, _ = times_of(table, request.rate, notes)
    places = table.places
    found = {f"AU{int(m[1])}": n for name, n in places.items() if (m := INTENSITY_NAME.match(name))}
    presences = {
        f"AU{int(m[1])}": n for name, n in places.items() if (m := PRESENCE_NAME.match(name))
    }
    only_present = {name: n for name, n in presences.items() if name not in found}
    pose_columns = {
        "pose_rx": ("head_pitch", -1.0),
        "pose_ry": ("head_yaw", -1.0),
        "pose_rz": ("head_roll", 1.0),
    }
    others = [n for n in (*pose_columns, *GAZE_ANGLES, *GAZE_VECTORS) if n in places]
    wanted = found | only_present | {name: places[name] for name in others}
    numbers = table.numbers_of(wanted)

    lost = rows_without_face(table.names, table.cells_of, len(times))
    units = without_rows({name: numbers[name] for name in found}, lost)
    scaling: list[str] = []
    channels = intensities(units, scaling)
    if any("divided by 5." in note for note in scaling):  # as usual in OpenFace, so no note
        scaling.clear()
    elif not scaling and units:
        scaling.append("Action units are at most 1, and were read as 0 to 1, not as 0 to 5.")
    notes += scaling
    channels |= {name: numbers[name] for name in only_present}
    if only_present:
        notes.append(f"{', '.join(sorted(only_present))}: only present or absent, 0 or 1.")
    for column, (name, sign) in pose_columns.items():
        if column in numbers:
            channels[name] = sign * np.degrees(numbers[column])
    channels |= _eyes(numbers, channels, notes)
    channels = without_rows(channels, lost)
    version = 2 if "face_id" in places or "gaze_angle_x" in places else 1
    return take_from_rows(
        f"OpenFace {version}",
        table.source,
        times,
        channels,
        notes=[*table.notes, *notes],
    )


def _eyes(
    numbers: dict[str, Floats64], head: dict[str, Floats64], notes: list[str]
) -> dict[str, Floats64]:
    """Return the eyes' angles in the head: gaze in the camera's axes, minus the head's turn.

    The median is subtracted: people look at a screen below the camera, so the gaze is never 0.
    """
    if set(GAZE_ANGLES) <= numbers.keys():
        across = numbers[GAZE_ANGLES[0]]
        down = numbers[GAZE_ANGLES[1]]
    elif set(GAZE_VECTORS) <= numbers.keys():
        x, y, z = (numbers[f"gaze_0_{each}"] + numbers[f"gaze_1_{each}"] for each in "xyz")
        across = np.arctan2(x, -z)
        down = np.arctan2(y, -z)
    else:
        return {}
    if not (np.nan_to_num(across).any() or np.nan_to_num(down).any()):
        return {}
    notes.append(
        "Gaze is relative to the camera: the head's rotation was subtracted, and the median gaze "
        "of the take is straight ahead."
    )
    yaw = np.degrees(across) - head.get("head_yaw", 0.0)
    pitch = -np.degrees(down) - head.get("head_pitch", 0.0)
    yaw = yaw - np.nanmedian(yaw)
    pitch = pitch - np.nanmedian(pitch)
    return {name: yaw if "yaw" in name else pitch for name in EYE_ANGLES}
