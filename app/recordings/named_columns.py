"""Any table whose columns are shapes, action units, visemes or angles by name, in any spelling.

Live Link Face's is one of them; so is what scripts write that read a phone or a tracker. Angles
are in radians there, in others perhaps in degrees, and count down and to the subject's right.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from .gaps import whole_take
from .names import ACTION_UNIT, ARKIT, NONSENSE, angle_of, shape_of, viseme_of
from .table import FACE_COLUMNS, Table, one_face
from .take import Array, Request, Take
from .timing import times_of

HIGHEST = 6.0  # an intensity beyond is none
LARGEST_DEGREES = 360.0  # what is larger is no angle in any unit
LARGEST_RADIANS = 1.6  # no head that is seen turns further, nor an eye
# [degrees] by which the axes of eyeballs stand outwards where eyes look ahead, in the app's files
# and packets, as those of real eyes do.
OUTWARD = {"eye_yaw_left": 4.0, "eye_yaw_right": -4.0}
NEVER_AT_REST = ("browDownLeft", "browDownRight", "noseSneerLeft", "noseSneerRight",
                 "mouthShrugUpper")  # fmt: skip
OF_NO_USE = (
    "blendshapecount",
    "timecode",
    "index",
    "",
    "unnamed: 0",
    "lefteyeroll",
    "righteyeroll",
)


@dataclass
class Columns:
    """What the columns of a table hold: channel -> number of the column."""

    shapes: dict[str, int] = field(default_factory=dict)
    units: dict[str, int] = field(default_factory=dict)
    visemes: dict[str, int] = field(default_factory=dict)
    angles: dict[str, int] = field(default_factory=dict)
    unknown: list[int] = field(default_factory=list)
    repeated: list[int] = field(default_factory=list)

    @classmethod
    def of(cls, names: tuple[str, ...]) -> Columns:
        """Sort out the names of columns; the first of a channel counts."""
        found = cls()
        units = [match for name in names if (match := ACTION_UNIT.match(name.casefold()))]
        has_sides = any(match[2] in ("l", "left") for match in units)
        for number, name in enumerate(names):
            unit = ACTION_UNIT.match(name.casefold())
            known: dict[str, int] | None = None
            channel = ""
            if unit and unit[2] != "c":
                sides = {"l": "_left", "left": "_left", "right": "_right"}
                side = "_right" if unit[2] == "r" and has_sides else sides.get(unit[2] or "", "")
                known = found.units
                channel = f"AU{unit[1]}{side}"
            elif shape := shape_of(name):
                known = found.shapes
                channel = shape
            elif angle := angle_of(name):
                known = found.angles
                channel = angle
            elif name.casefold().startswith("viseme_") and (viseme := viseme_of(name)):
                known = found.visemes
                channel = viseme
            elif name.casefold() not in OF_NO_USE:
                found.unknown.append(number)
            if known is not None and known.setdefault(channel, number) != number:
                found.repeated.append(number)
        return found

    def notes_of(self, names: tuple[str, ...]) -> list[str]:
        """A sentence where two columns with different names hold one channel."""
        twice = [names[each] for each in self.repeated if names.index(names[each]) == each]
        if not twice:
            return []
        listed = ", ".join(f"'{name}'" for name in twice)
        return [f"Another column holds the same, and these were left out: {listed}."]

    @property
    def are_known(self) -> bool:
        """Whether there is anything that can be played."""
        return bool(self.shapes or self.units or self.visemes)


def recognises(names: tuple[str, ...]) -> bool:
    """Whether any column has a name that we know."""
    return Columns.of(names).are_known


def is_live_link(names: tuple[str, ...]) -> bool:
    """Whether these are the columns of Live Link Face, whose angles have but one way to count.

    Columns are found by name: writers disagree about their order, and one adds seven of emotions.
    """
    folded = {name.casefold() for name in names}
    return bool(folded & {"timecode", "blendshapecount"}) and recognises(names)


def read(table: Table, request: Request) -> Take:
    """The take in the table."""
    table = one_face(table, request)
    notes: list[str] = []
    columns = Columns.of(table.names)
    notes += columns.notes_of(table.names)
    times, used = times_of(table, request.rate, notes)
    wanted = columns.shapes | columns.units | columns.visemes | columns.angles
    numbers = table.numbers_of(wanted)
    shapes = shares({name: numbers[name] for name in columns.shapes}, notes)
    channels = shapes | intensities({name: numbers[name] for name in columns.units}, notes)
    channels |= {name: numbers[name] for name in columns.visemes}
    is_known = is_live_link(table.names)
    outward = OUTWARD if is_known else {}
    channels |= in_degrees({name: numbers[name] for name in columns.angles}, outward, notes)
    if columns.angles and not is_known:
        notes.append("Angles were taken to count down and to the subject's right, as ARKit's do.")
    unknown = [table.names[number] for number in columns.unknown]
    return whole_take(
        "Live Link Face" if is_known else "Table of named columns",
        table.source,
        times,
        channels,
        notes=[*table.notes, *notes],
        unknown=[name for name in unknown if name.casefold() not in {*used, *FACE_COLUMNS}],
        is_calibrated=is_calibrated(shapes, notes),
    )


def shares(shapes: dict[str, Array], notes: list[str]) -> dict[str, Array]:
    """ARKit's shapes; NaN where the value is none. Trackers overshoot a little, as notes tell."""
    found, far, beyond = {}, 0, 0
    for name, values in shapes.items():
        is_far = np.abs(values) > NONSENSE
        far += int(is_far.sum())
        found[name] = values = np.where(is_far, np.nan, values)
        beyond += int(np.sum((values < -0.001) | (values > 1.001)))
    if far:
        notes.append(f"{far} values of shapes are far from 0 to 1 and were left out.")
    if beyond:
        notes.append(f"{beyond} values of shapes were cut off at 0 and 1.")
    return found


def intensities(units: dict[str, Array], notes: list[str]) -> dict[str, Array]:
    """Action units as intensities 0 to 1; FACS' 0 to 5 (A to E) are divided."""
    units = {name: np.where(np.abs(v) > HIGHEST, np.nan, v) for name, v in units.items()}
    highest = max((float(np.nanmax(values, initial=0.0)) for values in units.values()), default=0.0)
    if highest > 1.0:
        notes.append("Action units go from 0 to 5 and were divided by 5.")
        units = {name: values / 5.0 for name, values in units.items()}
    return units


def in_degrees(
    angles: Mapping[str, Array], outward: Mapping[str, float], notes: list[str]
) -> dict[str, Array]:
    """Angles in degrees, + to the subject's left, up, to the left shoulder.

    angles: name of ours -> as the file has it, shape (T,), NaN where nothing is known. outward: by
    how much the axes of eyeballs are off [degrees].
    """
    moving = {}
    for name, values in angles.items():
        values = np.where(np.abs(values) > LARGEST_DEGREES, np.nan, values)
        if np.nan_to_num(values).any():
            moving[name] = values
    if len(moving) < len(angles):
        still = ", ".join(name for name in angles if name not in moving)
        notes.append(f"Always 0, as if switched off, and left out: {still}.")
    if not moving:
        return {}
    size = max(float(np.nanpercentile(np.abs(values), 99)) for values in moving.values())
    is_radians = size <= LARGEST_RADIANS
    unit = "radians" if is_radians else "degrees"
    notes.append(f"Angles reach {size:.2g} and were taken for {unit}.")
    scale = -180.0 / math.pi if is_radians else -1.0
    return {name: scale * values - outward.get(name, 0.0) for name, values in moving.items()}


def is_calibrated(shapes: dict[str, Array], notes: list[str]) -> bool:
    """Whether the neutral face was taken away: then shapes that never rest are often at 0."""
    resting = [shapes[name] for name in NEVER_AT_REST if name in shapes]
    calibrated = sum(bool(np.mean(values <= 1e-6) > 0.2) for values in resting) >= 3
    if calibrated and len(shapes) == len(ARKIT):
        notes.append("The take is calibrated: its neutral face is at 0.")
    return calibrated
