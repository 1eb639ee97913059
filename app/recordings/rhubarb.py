"""Speech as the mouth shapes of Rhubarb Lip Sync, in JSON or TSV.

One of nine mouth shapes for each stretch of time (its manual, "Mouth shapes").
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import UserError
from .faces import only_one
from .gaps import whole_take
from .request import Request
from .table import Table
from .take import Take
from .viseme_tracks import SILENCE, is_number

MOUTHS = {  # of Rhubarb -> viseme and value
    "A": ("viseme_PP", 1.0),  # shut: p, b, m
    "B": ("viseme_SS", 0.7),  # teeth together: k, s, t, ee
    "C": ("viseme_E", 0.8),  # open: e, a
    "D": ("viseme_aa", 0.9),  # wide open: aa
    "E": ("viseme_oh", 0.8),  # a little rounded: ao, er
    "F": ("viseme_ou", 0.9),  # puckered: u, w
    "G": ("viseme_FF", 0.9),  # lower lip at the teeth: f, v
    "H": ("viseme_nn", 0.9),  # tongue up: l
    "X": (SILENCE, 1.0),
}
TURN = 0.08  # [s] in which one mouth shape goes over to the next


def recognises(document: Any) -> bool:
    """Whether the document is what Rhubarb Lip Sync writes as JSON."""
    return isinstance(document, dict) and isinstance(document.get("mouthCues"), list)


def read(document: Any, source: str, request: Request) -> Take:
    """The take in `{"mouthCues": [{"start": 0.0, "end": 0.2, "value": "A"}]}`."""
    only_one(source, request)
    cues, end = [], 0.0
    for number, cue in enumerate(document["mouthCues"]):
        where = f"{source}: mouth cue {number + 1}"
        if not isinstance(cue, dict) or not is_number(cue.get("start")):
            raise UserError(f"{where}: has no start [s]")
        cues.append((float(cue["start"]), _mouth(cue.get("value"), where)))
        if is_number(cue.get("end")):
            end = max(end, float(cue["end"]))
    return _from_cues(cues, end, source)


def recognises_rows(names: tuple[str, ...]) -> bool:
    """Whether a first line is one of Rhubarb's TSV: a time, a mouth shape."""
    if len(names) != 2 or names[1].upper() not in MOUTHS:
        return False
    return names[0].replace(".", "", 1).isdecimal()


def read_rows(table: Table, request: Request) -> Take:
    """The take in Rhubarb's TSV; its first row is no header."""
    only_one(table.source, request)
    rows = [(1, table.names[0], table.names[1])]
    rows += zip(table.line_numbers, table.cells(0), table.cells(1), strict=True)
    cues = []
    for number, start, mouth in rows:
        where = f"{table.source}: line {number}"
        try:
            cues.append((float(start), _mouth(mouth, where)))
        except ValueError:
            raise UserError(f"{where}: '{start[:20]}' is no time [s]") from None
    return _from_cues(cues, cues[-1][0], table.source)


def _mouth(value: Any, where: str) -> str:
    """A mouth shape of Rhubarb; UserError for another."""
    if not isinstance(value, str) or value.upper() not in MOUTHS:
        raise UserError(f"{where}: mouth shape {value!r:.20}; allowed are {', '.join(MOUTHS)}")
    return value.upper()


def _from_cues(cues: Sequence[tuple[float, str]], end: float, source: str) -> Take:
    """Mouth shapes that hold, and go over into each other around the moments of change."""
    if not cues:
        raise UserError(f"{source}: has no mouth cues; nothing is said")
    cues = sorted(cues)
    starts = np.array([start for start, _ in cues])
    if not np.isfinite(starts).all():
        raise UserError(f"{source}: a mouth cue starts at no time [s]")
    ends = np.append(starts[1:], max(end, starts[-1]))
    half = np.minimum((ends - starts) / 2.0, TURN / 2.0)  # of its way out, and of the next one's in
    points: dict[float, str] = {float(starts[0]): cues[0][1]}
    for number, ((_, mouth), (start, following)) in enumerate(itertools.pairwise(cues)):
        turn = min(half[number], half[number + 1]) if number + 2 < len(cues) else half[number]
        points[start - turn] = mouth
        points[start + turn] = following
    points[max(float(ends[-1]), max(points))] = cues[-1][1]
    times = np.array(sorted(points))
    channels = {name: np.zeros(len(times)) for name, _ in MOUTHS.values()}
    for row, time in enumerate(times):
        name, value = MOUTHS[points[float(time)]]
        channels[name][row] = value
    used = {name: values for name, values in channels.items() if values.any()}
    note = f"Mouth shapes became visemes, {TURN:g} s from one to the next."
    return whole_take("Rhubarb Lip Sync", source, times, used, notes=[note], is_calibrated=True)
