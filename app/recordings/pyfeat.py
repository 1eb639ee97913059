"""py-feat's CSV (1 and 2): action units 0 to 1, head pose, and in version 2 shapes of MediaPipe.

Versions differ in the head's angles: versions before 0.7 write degrees, with Pitch + up; later
versions write radians, with Pitch + down. Yaw + is to the subject's right. Roll + is to the
subject's left shoulder, in version 2 to the right shoulder. A comparison of angles with landmarks
in files of py-feat showed this; for version 2 it covered only yaw and roll. No version gives
times, only numbers of frames.

Version 2 measures most of the face twice. Its shapes have a side and a strength, its units only a
probability. So the shapes are used, and AU6 and AU9 in place of shapes that MediaPipe never sees.
"""

from __future__ import annotations

import re

import numpy as np

from risorius.geometry.arrays import Floats64

from .gaps import take_from_rows
from .names import shape_of
from .table import Table, one_face
from .take import Take, TakeRequest
from .timing import times_of
from .values import intensities, rows_without_face, shares, without_rows

UNIT_NAME = re.compile(r"au(\d\d)$")
POSE_ANGLES = ("pitch", "yaw", "roll")


def recognises(names: tuple[str, ...]) -> bool:
    """Whether these are columns of py-feat."""
    folded = {name.casefold() for name in names}
    box_columns = {"facerectx", "facerecty", "facerectwidth", "facerectheight", "facescore"}
    return bool(folded & box_columns) and any(UNIT_NAME.match(name) for name in folded)


def read(table: Table, request: TakeRequest) -> Take:
    """Return the take in the table."""
    table = one_face(table, request)
    notes: list[str] = []
    times, _ = times_of(table, request.rate, notes)
    places = table.places
    units = {f"AU{int(m[1])}": n for name, n in places.items() if (m := UNIT_NAME.match(name))}
    shapes = {shape: n for name, n in places.items() if (shape := shape_of(name))}
    unseen_shapes = (
        "cheekPuff",
        "cheekSquintLeft",
        "cheekSquintRight",
        "noseSneerLeft",
        "noseSneerRight",
    )
    if len(shapes) > len(unseen_shapes):
        shapes = {name: n for name, n in shapes.items() if name not in unseen_shapes}
        units_instead = ("AU6", "AU9")
        units = {name: n for name, n in units.items() if name in units_instead}
        notes.append(
            "Shapes and action units measure the same face: the shapes were used, and AU6 and AU9, "
            "for which the file has no shapes."
        )
    others = {name: places[name] for name in ("facescore", *POSE_ANGLES) if name in places}
    wanted = units | shapes | others
    numbers = table.numbers_of(wanted)
    channels = intensities({name: numbers[name] for name in units}, notes)
    channels |= shares({name: numbers[name] for name in shapes}, notes)
    channels |= _head(numbers, bool(shapes), notes)
    lost = rows_without_face(table.names, table.cells_of, len(table.lines))
    lost |= ~(numbers.get("facescore", np.ones(1)) > 0.0)
    channels = without_rows(channels, lost)
    return take_from_rows(
        "py-feat 2" if shapes else "py-feat 1",
        table.source,
        times,
        channels,
        notes=[*table.notes, *notes],
    )


def _head(numbers: dict[str, Floats64], is_second: bool, notes: list[str]) -> dict[str, Floats64]:
    """Convert the head's angles to degrees, from the units and signs of any version."""
    pose = {n: numbers[n] for n in POSE_ANGLES if n in numbers and np.isfinite(numbers[n]).any()}
    if not pose:
        return {}
    size = max(float(np.nanpercentile(np.abs(values), 90)) for values in pose.values())
    largest_radians = 1.6  # a visible head turns no further
    is_early = size > largest_radians
    notes.append(
        f"Angles of the head reach {size:.2g} and were read as "
        + ("degrees, pitch + up." if is_early else "radians, pitch + down.")
    )
    scale = 1.0 if is_early else 180.0 / np.pi
    signs = {"pitch": 1.0 if is_early else -1.0, "yaw": -1.0, "roll": -1.0 if is_second else 1.0}
    return {f"head_{name}": signs[name] * scale * values for name, values in pose.items()}
