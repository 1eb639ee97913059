"""Tables with columns named as shapes, action units, visemes or angles, in any spelling.

Live Link Face writes such a table, and so do scripts that read a phone or a tracker. Angles of Live
Link Face are in radians, angles of others may be in degrees. Angles grow downward and to the
subject's right.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from .angles import in_degrees
from .gaps import take_from_rows
from .names import LARGEST_VALUE, angle_of, shape_of, unit_of, viseme_of
from .table import FACE_COLUMNS, Table, one_face
from .take import Take, TakeRequest
from .timing import times_of
from .values import (
    from_percent,
    intensities,
    is_calibrated,
    is_flag,
    rows_without_face,
    shares,
    without_rows,
)

# [degrees] by which eyeballs turn outward while eyes look ahead, in the app's files and packets, as
# the axes of real eyes do.
OUTWARD_ANGLES = {"eye_yaw_left": 4.0, "eye_yaw_right": -4.0}


@dataclass
class Columns:
    """The channels of a table's columns: channel -> index of the column."""

    shapes: dict[str, int] = field(default_factory=dict)
    units: dict[str, int] = field(default_factory=dict)
    detections: dict[str, int] = field(default_factory=dict)
    visemes: dict[str, int] = field(default_factory=dict)
    angles: dict[str, int] = field(default_factory=dict)
    unknown: list[int] = field(default_factory=list)
    repeated: list[int] = field(default_factory=list)

    @classmethod
    def from_names(cls, names: tuple[str, ...]) -> Columns:
        """Assign columns to channels by name; the first column of a channel is used."""
        found = cls()
        units = [unit_of(name) for name in names]
        has_sides = any(unit is not None and unit.side == "_left" for unit in units)
        has_intensities = any(unit is not None and unit.kind == "intensity" for unit in units)
        useless_names = (
            "blendshapecount",
            "timecode",
            "index",
            "",
            "unnamed: 0",
            "lefteyeroll",
            "righteyeroll",
        )
        for number, (name, unit) in enumerate(zip(names, units, strict=True)):
            known: dict[str, int] | None = None
            channel = ""
            if unit is not None:
                is_detection = unit.kind == "detection" or (has_intensities and not unit.kind)
                known = found.detections if is_detection else found.units
                channel = unit.channel(has_sides)
            elif shape := shape_of(name):
                known = found.shapes
                channel = shape
            elif angle := angle_of(name):
                known = found.angles
                channel = angle
            elif name.casefold().startswith("viseme_") and (viseme := viseme_of(name)):
                known = found.visemes
                channel = viseme
            elif name.casefold() not in useless_names and not is_flag(name):
                found.unknown.append(number)
            if known is not None and known.setdefault(channel, number) != number:
                found.repeated.append(number)
        return found

    def notes_of(self, names: tuple[str, ...]) -> list[str]:
        """Return a note on channels that are in several columns with different names, if any."""
        twice = [names[each] for each in self.repeated if names.index(names[each]) == each]
        if not twice:
            return []
        listed = ", ".join(f"'{name}'" for name in twice)
        return [f"These repeat another column, and were left out: {listed}."]

    @property
    def are_known(self) -> bool:
        """Whether any column can be played."""
        return bool(self.shapes or self.units or self.detections or self.visemes)


def recognises(names: tuple[str, ...]) -> bool:
    """Whether any column has a known name."""
    return Columns.from_names(names).are_known


def is_live_link(names: tuple[str, ...]) -> bool:
    """Whether these are the columns of Live Link Face, whose angles have known signs.

    Columns are found by name: writers disagree about the order, and one adds seven emotions.
    """
    folded = {name.casefold() for name in names}
    return bool(folded & {"timecode", "blendshapecount"}) and recognises(names)


def read(table: Table, request: TakeRequest) -> Take:
    """Return the take in the table."""
    table = one_face(table, request)
    notes: list[str] = []
    columns = Columns.from_names(table.names)
    notes += columns.notes_of(table.names)
    times, used = times_of(table, request.rate, notes)
    only_present = {n: c for n, c in columns.detections.items() if n not in columns.units}
    twice = [name for name in columns.detections if name in columns.units]
    if twice:
        notes.append(f"Intensities were used, and detections left out: {', '.join(twice)}.")
    if only_present:
        notes.append(f"{', '.join(only_present)}: only present or absent, 0 or 1.")
    wanted = columns.shapes | columns.units | only_present | columns.visemes | columns.angles
    lost = rows_without_face(table.names, table.cells_of, len(table.lines))
    numbers = without_rows(table.numbers_of(wanted), lost)
    shapes = shares({name: numbers[name] for name in columns.shapes}, notes)
    channels = shapes | intensities({name: numbers[name] for name in columns.units}, notes)
    channels |= {name: numbers[name] for name in only_present}
    visemes = {name: numbers[name] for name in columns.visemes}
    channels |= from_percent(visemes, LARGEST_VALUE, "Visemes", notes)
    is_known = is_live_link(table.names)
    outward = OUTWARD_ANGLES if is_known else {}
    channels |= in_degrees({name: numbers[name] for name in columns.angles}, outward, notes)
    if columns.angles and not is_known:
        notes.append(
            "Angles were assumed to grow downward and to the subject's right, as in ARKit."
        )
    unknown = [table.names[number] for number in columns.unknown]
    return take_from_rows(
        "Live Link Face" if is_known else "Table of named columns",
        table.source,
        times,
        channels,
        notes=[*table.notes, *notes],
        unknown=[name for name in unknown if name.casefold() not in {*used, *FACE_COLUMNS}],
        is_calibrated=is_calibrated(shapes, notes),
    )
