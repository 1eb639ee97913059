"""Speech as visemes: tracks of OpenFaceFX (JSON), and mouth shapes of Rhubarb Lip Sync (JSON, TSV).

OpenFaceFX shares each moment among fifteen visemes, so that the lips' weight is about 0.4 where
they meet: far too little to shut them. Its peaks of PP and FF are raised to what contact needs, and
silence to 1, at the cost of all others.

Rhubarb names one of nine mouth shapes for each stretch of time (its manual, "Mouth shapes").
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import UserError
from .faces import only_one
from .gaps import whole_take
from .request import Request
from .spelling import viseme_of
from .table import Table
from .take import Array, Take

CONTACTS = {"viseme_PP": 1.0, "viseme_FF": 0.9}  # what the peak of a sound needs
SILENCE = "viseme_sil"
PEAK = 0.1  # what is lower is a neighbour's shadow
LOW = 0.8  # tracks whose peaks are higher are clear enough
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


def recognises_tracks(document: Any) -> bool:
    """Whether the document holds tracks of visemes by name."""
    if not isinstance(document, dict) or not isinstance(document.get("channels"), list):
        return False
    return any(
        isinstance(channel, dict)
        and isinstance(channel.get("name"), str)
        and isinstance(channel.get("keys"), list)
        and viseme_of(channel["name"])
        for channel in document["channels"]
    )


def read_tracks(document: Any, source: str, request: Request) -> Take:
    """The take in tracks of visemes: `{"channels": [{"name": "PP", "keys": [[time, value]]}]}`."""
    only_one(source, request)
    tracks: dict[str, Array] = {}
    unknown = []
    for number, channel in enumerate(document["channels"]):
        if not isinstance(channel, dict) or not isinstance(name := channel.get("name"), str):
            raise UserError(f"{source}: channel {number + 1} has no name")
        viseme = viseme_of(name)
        if viseme is None:
            unknown.append(name)
        else:
            tracks[viseme] = _keys(channel.get("keys"), f"{source}: channel '{name}'")
    tracks = {name: keys for name, keys in tracks.items() if len(keys)}
    if not tracks:
        raise UserError(f"{source}: no channel of visemes has any keys")
    times = np.unique(np.concatenate([keys[:, 0] for keys in tracks.values()]))
    notes: list[str] = []
    channels = {
        name: np.clip(np.interp(times, keys[:, 0], keys[:, 1]), 0.0, 1.0)
        for name, keys in tracks.items()
    }
    channels = _made_clear(channels, notes)
    return whole_take(
        "Viseme tracks", source, times, channels, notes=notes, unknown=unknown,
        is_calibrated=True,
    )  # fmt: skip


def _keys(keys: Any, where: str) -> Array:
    """Keys as rows of time and value, shape (K, 2), by time."""
    if not isinstance(keys, list):
        raise UserError(f"{where}: keys must be a list of [time, value]")
    for key in keys:
        is_pair = isinstance(key, list) and len(key) >= 2
        if not is_pair or not all(_is_number(each) for each in key[:2]):
            raise UserError(f"{where}: a key is {key!r:.40}, must be [time, value]")
    rows = np.array([key[:2] for key in keys], dtype=float).reshape(-1, 2)
    return rows[np.argsort(rows[:, 0], kind="stable")]


def _is_number(value: Any) -> bool:
    """Whether the value is a finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) < 1e9 and math.isfinite(value)


def _made_clear(channels: dict[str, Array], notes: list[str]) -> dict[str, Array]:
    """Weights that shut the lips where they are to meet, and that rest in silence."""
    if max(float(values.max()) for values in channels.values()) > LOW:
        return channels
    found = dict(channels)
    for name, wanted in CONTACTS.items():
        if name in found and (height := _height(found[name])):
            found[name] = np.minimum(found[name] * (wanted / height), wanted)
    if SILENCE in found and (height := _height(found[SILENCE])):
        silence = np.minimum(found[SILENCE] / height, 1.0)
        rest = (1.0 - silence) / np.maximum(1.0 - found[SILENCE], 1e-6)
        found = {name: values * rest for name, values in found.items()} | {SILENCE: silence}
    notes.append("Weights are low: those of PP, FF and silence were raised, so that lips meet.")
    return found


def _height(values: Array) -> float:
    """How high the peaks of a track are, in the middle; 0 where it has none."""
    edged = np.concatenate([[-1.0], values, [-1.0]])
    is_peak = (values >= edged[:-2]) & (values >= edged[2:]) & (values > PEAK)
    return float(np.median(values[is_peak])) if is_peak.any() else 0.0


def recognises_mouths(document: Any) -> bool:
    """Whether the document is what Rhubarb Lip Sync writes as JSON."""
    return isinstance(document, dict) and isinstance(document.get("mouthCues"), list)


def read_mouths(document: Any, source: str, request: Request) -> Take:
    """The take in `{"mouthCues": [{"start": 0.0, "end": 0.2, "value": "A"}]}`."""
    only_one(source, request)
    cues, end = [], 0.0
    for number, cue in enumerate(document["mouthCues"]):
        where = f"{source}: mouth cue {number + 1}"
        if not isinstance(cue, dict) or not _is_number(cue.get("start")):
            raise UserError(f"{where}: has no start [s]")
        cues.append((float(cue["start"]), _mouth(cue.get("value"), where)))
        if _is_number(cue.get("end")):
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
