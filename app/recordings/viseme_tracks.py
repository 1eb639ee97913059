"""Speech as tracks of visemes in JSON, as OpenFaceFX writes them.

It shares each moment among fifteen visemes, so that the lips' weight is about 0.4 where they meet:
far too little to shut them. Its peaks of PP and FF are raised to what contact needs, and silence to
1, at the cost of all others.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..errors import UserError
from .faces import only_one
from .gaps import whole_take
from .request import Request
from .spelling import viseme_of
from .take import Array, Take

CONTACTS = {"viseme_PP": 1.0, "viseme_FF": 0.9}  # what the peak of a sound needs
SILENCE = "viseme_sil"
PEAK = 0.1  # what is lower is a neighbour's shadow
LOW = 0.8  # tracks whose peaks are higher are clear enough


def recognises(document: Any) -> bool:
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


def read(document: Any, source: str, request: Request) -> Take:
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
        if not is_pair or not all(is_number(each) for each in key[:2]):
            raise UserError(f"{where}: a key is {key!r:.40}, must be [time, value]")
    rows = np.array([key[:2] for key in keys], dtype=float).reshape(-1, 2)
    return rows[np.argsort(rows[:, 0], kind="stable")]


def is_number(value: Any) -> bool:
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
