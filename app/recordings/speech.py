"""Speech in JSON: visemes of OpenFaceFX, and mouth shapes of Rhubarb Lip Sync.

OpenFaceFX divides each moment among fifteen visemes, so PP has a weight of about 0.4 when lips
should meet, which does not shut them. This module raises the peaks of PP and FF until lips touch,
and the peaks of silence to 1, which lowers all other visemes. Rhubarb has one of nine mouth shapes
for each interval of time (its manual, "Mouth shapes").
"""

from __future__ import annotations

import contextlib
import itertools
import os
from dataclasses import dataclass, replace
from pathlib import Path, PureWindowsPath
from typing import Annotated, Any

import numpy as np

from risorius.geometry.arrays import Floats64
from risorius.schema import OneOf, Record, Rest, Within, called
from risorius.schema import read as read_table

from ..errors import UserError
from .gaps import take_from_rows
from .names import viseme_of
from .take import Take, TakeRequest

SILENT_VISEME = "viseme_sil"
VISEME_OF_MOUTH = {  # mouth shape of Rhubarb -> viseme and value
    "A": ("viseme_PP", 1.0),  # shut: p, b, m
    "B": ("viseme_SS", 0.7),  # teeth together: k, s, t, ee
    "C": ("viseme_E", 0.8),  # open: e, a
    "D": ("viseme_aa", 0.9),  # wide open: aa
    "E": ("viseme_oh", 0.8),  # a little rounded: ao, er
    "F": ("viseme_ou", 0.9),  # puckered: u, w
    "G": ("viseme_FF", 0.9),  # lower lip at the teeth: f, v
    "H": ("viseme_nn", 0.9),  # tongue up: l
    "X": (SILENT_VISEME, 1.0),
}


Time = Annotated[float, Within(0.0, 86_400.0)]  # [s]


@dataclass(frozen=True)
class _Track(Record):
    """The keys of a viseme, each a time and a weight."""

    others: Rest[Any]
    name: str
    keys: list[Annotated[tuple[float, float], Within(-86_400.0, 86_400.0)]]


@dataclass(frozen=True)
class _Tracks(Record):
    """The document of OpenFaceFX."""

    others: Rest[Any]
    channels: list[_Track]


@dataclass(frozen=True)
class _Cue(Record):
    """A mouth shape and its beginning."""

    others: Rest[Any]
    start: Time
    value: Annotated[str, OneOf(tuple(VISEME_OF_MOUTH))]
    end: Time = 0.0


@dataclass(frozen=True)
class _Cues(Record):
    """The JSON document of Rhubarb Lip Sync."""

    others: Rest[Any]
    mouth_cues: Annotated[list[_Cue], called("mouthCues")]
    metadata: Any = None


def recognises_tracks(document: Any) -> bool:
    """Whether the document holds tracks of visemes by name."""
    channels = document.get("channels") if isinstance(document, dict) else None
    names = [each.get("name") for each in channels or () if isinstance(each, dict)]
    return any(isinstance(name, str) and viseme_of(name) for name in names)


def read_tracks(document: Any, source: str, request: TakeRequest) -> Take:
    """Read the take in `{"channels": [{"name": "PP", "keys": [[time, weight], ...]}, ...]}`."""
    request.refuse_face(source)
    tracks: dict[str, Floats64] = {}
    unknown = []
    notes = list[str]()
    for channel in read_table(_Tracks, document, source, error=UserError).channels:
        if viseme := viseme_of(channel.name):
            if channel.keys:
                tracks[viseme] = np.array(sorted(channel.keys, key=lambda key: key[0]))
        else:
            unknown.append(channel.name)
    if not tracks:
        raise UserError(f"{source}: no channel of visemes has any keys")
    times = np.unique(np.concatenate([keys[:, 0] for keys in tracks.values()]))
    channels = {name: np.interp(times, keys[:, 0], keys[:, 1]) for name, keys in tracks.items()}
    channels = _raise_low_weights(channels, notes)
    return take_from_rows(
        "Viseme tracks", source, times, channels, notes=notes, unknown=unknown,
        is_calibrated=True, has_keys=True,
    )  # fmt: skip


def _raise_low_weights(channels: dict[str, Floats64], notes: list[str]) -> dict[str, Floats64]:
    """Raise low weights, so that lips meet at P and F, and the mouth rests in silence."""
    clear_peak = 0.8  # tracks with higher peaks are clear enough
    if max(float(values.max()) for values in channels.values()) > clear_peak:
        return channels
    found = dict(channels)
    least_peaks = {"viseme_PP": 1.0, "viseme_FF": 0.9}  # weight that a sound needs
    for name, wanted in least_peaks.items():
        if name in found and (height := _height(found[name])):
            found[name] = np.minimum(found[name] * (wanted / height), wanted)
    if SILENT_VISEME in found and (height := _height(found[SILENT_VISEME])):
        silence = np.minimum(found[SILENT_VISEME] / height, 1.0)
        rest = (1.0 - silence) / np.maximum(1.0 - found[SILENT_VISEME], 1e-6)
        found = {name: values * rest for name, values in found.items()} | {SILENT_VISEME: silence}
    notes.append("Weights are low: those of PP, FF and silence were raised, so that lips meet.")
    return found


def _height(values: Floats64) -> float:
    """Return the median height of a track's peaks; 0 without peaks."""
    edged = np.concatenate([[-1.0], values, [-1.0]])
    least_peak = 0.1  # a lower peak belongs to a neighbouring sound
    is_peak = (values >= edged[:-2]) & (values >= edged[2:]) & (values > least_peak)
    return float(np.median(values[is_peak])) if is_peak.any() else 0.0


def recognises_cues(document: Any) -> bool:
    """Whether Rhubarb Lip Sync wrote the document."""
    return isinstance(document, dict) and isinstance(document.get("mouthCues"), list)


def read_cues(document: Any, source: str, request: TakeRequest) -> Take:
    """Read the take in `{"mouthCues": [{"start": 0.0, "end": 0.2, "value": "A"}]}`.

    Each mouth shape is held, and blends into the next one around the moment of change.
    """
    request.refuse_face(source)
    written = read_table(_Cues, document, source, error=UserError)
    given = written.mouth_cues
    if not given:
        raise UserError(f"{source}: has no mouth cues")
    end = max(cue.end for cue in given)
    cues = sorted((cue.start, cue.value) for cue in given)
    starts = np.array([start for start, _ in cues])
    ends = np.append(starts[1:], max(end, starts[-1]))
    transition = 0.08  # [s] in which one mouth shape changes into the next
    half = np.minimum((ends - starts) / 2.0, transition / 2.0)  # half of each cue's transition
    points: dict[float, str] = {float(starts[0]): cues[0][1]}
    for number, ((_, mouth), (start, following)) in enumerate(itertools.pairwise(cues)):
        turn = min(half[number], half[number + 1]) if number + 2 < len(cues) else half[number]
        points[start - turn] = mouth
        points[start + turn] = following
    points[max(float(ends[-1]), max(points))] = cues[-1][1]
    times = np.array(sorted(points))
    channels = {name: np.zeros(len(times)) for name, _ in VISEME_OF_MOUTH.values()}
    for row, time in enumerate(times):
        name, value = VISEME_OF_MOUTH[points[float(time)]]
        channels[name][row] = value
    used = {name: values for name, values in channels.items() if values.any()}
    notes = [f"Mouth shapes became visemes, {transition:g} s from one to the next."]
    sound = _sound_of(written.metadata, source, notes)
    take = take_from_rows(
        "Rhubarb Lip Sync", source, times, used, notes=notes, is_calibrated=True, has_keys=True
    )
    return replace(take, sound=sound)


def _sound_of(metadata: Any, source: str, notes: list[str]) -> Path | None:
    """Find the sound file that Rhubarb used, at its old place or beside the recording."""
    name = metadata.get("soundFile") if isinstance(metadata, dict) else None
    if not isinstance(name, str) or not name:
        return None
    folder = Path(source).parent
    for path in (folder / name, folder / PureWindowsPath(name).name):
        with contextlib.suppress(OSError, ValueError):  # an impossible name
            if path.is_file():
                notes.append(f"The sound is '{path.name}', which the file names.")
                return Path(os.path.abspath(path))
    notes.append(f"The sound file '{name}' is not there; --sound names another.")
    return None
