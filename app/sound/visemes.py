"""Sounds of speech -> tracks of visemes, as a mouth would form them.

A mouth is on its way to a sound before it is heard and lingers after it, so visemes overlap. They
share what there is, but lips that shut (p, b, m) or touch the teeth (f, v) have their way: without
them speech looks wrong, whatever else it does.
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..recordings.playback import LEAD
from ..script import Script, rounded, thinned
from .speech import Phone

# How strongly a sound forms the mouth, by its name in ARPABET; two visemes for one that glides.
# Tongues work behind the teeth: t, d, n, l, k and g leave the lips to the vowels around them.
SHAPES: dict[str, tuple[tuple[str, float], ...]] = {
    **dict.fromkeys(("P", "B", "M"), (("PP", 1.0),)),
    **dict.fromkeys(("F", "V"), (("FF", 1.0),)),
    **dict.fromkeys(("TH", "DH"), (("TH", 0.65),)),
    **dict.fromkeys(("T", "D"), (("DD", 0.5),)),
    **dict.fromkeys(("N", "L"), (("nn", 0.5),)),
    **dict.fromkeys(("K", "G", "NG"), (("kk", 0.45),)),
    **dict.fromkeys(("CH", "JH", "SH", "ZH"), (("CH", 0.8),)),
    **dict.fromkeys(("S", "Z"), (("SS", 0.7),)),
    **dict.fromkeys(("R", "ER"), (("RR", 0.65),)),
    "AA": (("aa", 0.7),),
    "AH": (("aa", 0.5),),
    "AE": (("E", 0.85),),
    "EH": (("E", 0.7),),
    "EY": (("E", 0.75), ("ih", 0.65)),
    "IH": (("ih", 0.6),),
    "IY": (("ih", 0.75),),
    "Y": (("ih", 0.6),),
    "AY": (("aa", 0.75), ("ih", 0.6)),
    "AO": (("oh", 0.8),),
    "OW": (("oh", 0.8), ("ou", 0.75)),
    "OY": (("oh", 0.8), ("ih", 0.6)),
    "AW": (("aa", 0.75), ("ou", 0.7)),
    "UH": (("ou", 0.55),),
    "UW": (("ou", 0.85),),
    "W": (("ou", 0.9),),
    "HH": (),  # breath through whatever comes next
}
DOMINANT = ("PP", "FF")  # the first has its way before the other
FIRST_PART = 0.55  # of a sound that glides, for its first viseme
ONSET, OFFSET = 0.09, 0.08  # [s] from which before a sound, and to which after it
SHORT_ONSET, SHORT_OFFSET = 0.07, 0.02  # [s] the same for what is dominant: vowels need their time
HELD = 0.6  # of a dominant sound; then its burst is on the way to what follows
REACHED = 0.01  # [s] before a sound, when it is formed


class Gesture(NamedTuple):
    """A viseme that grows from `begin` to `reached`, stays till `left`, and is gone at `end`."""

    viseme: str
    strength: float
    begin: float
    reached: float
    left: float
    end: float

    def value(self, time: float) -> float:
        """How much of it there is at a time [s]."""
        if not self.begin < time < self.end:
            return 0.0
        rise = (time - self.begin) / max(self.reached - self.begin, 1e-9)
        fall = (self.end - time) / max(self.end - self.left, 1e-9)
        return self.strength * min(rise, fall, 1.0)


def spoken(phones: Sequence[Phone], file: Path, duration: float) -> Script:
    """The script in which these sounds are spoken, with the sound file beside it.

    duration: of the sound [s].
    """
    gestures = [gesture for phone in phones for gesture in gestures_of(phone)]
    corners = sorted({rounded(max(time, 0.0)) for each in gestures for time in each[2:]} | {0.0})
    around = _around(gestures, corners)
    values = [shares(each, time) for time, each in zip(corners, around, strict=True)]
    tracks = {}
    for viseme in sorted({gesture.viseme for gesture in gestures}):
        track = [round(each.get(viseme, 0.0), 3) for each in values]
        tracks[f"viseme_{viseme}"] = thinned(np.array(corners), np.array(track))
    return Script(
        title=file.stem,
        duration=rounded(duration),
        source=str(file),
        sound=Path(os.path.abspath(file)),
        tracks=tracks,
    )


def gestures_of(phone: Phone) -> tuple[Gesture, ...]:
    """What the mouth does for a sound; ahead of it, since muscles follow late."""
    shapes = SHAPES.get(phone.name, ())
    start, end = phone.start - LEAD, phone.end - LEAD
    middle = start + FIRST_PART * (end - start)
    spans = [(start, end)] if len(shapes) == 1 else [(start, middle), (middle, end)]
    gestures = []
    for (viseme, strength), (first, last) in zip(shapes, spans, strict=False):
        formed, left = first - REACHED, last
        onset, offset = ONSET, OFFSET
        if viseme in DOMINANT:
            left = first + HELD * (last - first)
            onset, offset = SHORT_ONSET, SHORT_OFFSET
        left = max(left, 0.0)  # what is heard at once is formed when the sound begins
        end = max(last + offset, left + SHORT_OFFSET)
        gestures.append(Gesture(viseme, strength, first - onset, formed, left, end))
    return tuple(gestures)


def shares(gestures: Sequence[Gesture], time: float) -> dict[str, float]:
    """How much of each viseme there is at a time [s], of all gestures around it.

    Of one viseme the strongest gesture counts. All together are no more than a whole mouth, and
    what is dominant comes first.
    """
    values: dict[str, float] = defaultdict(float)
    for gesture in gestures:
        values[gesture.viseme] = max(values[gesture.viseme], gesture.value(time))
    room = 1.0
    for viseme in DOMINANT:
        if viseme in values:
            values[viseme] *= room
            room -= values[viseme]
    others = [viseme for viseme in values if viseme not in DOMINANT]
    crowd = max(sum(values[viseme] for viseme in others), 1.0)
    return values | {viseme: values[viseme] * room / crowd for viseme in others}


def _around(gestures: Sequence[Gesture], times: Sequence[float]) -> list[list[Gesture]]:
    """For each time the gestures that it lies in; both in the order of time."""
    waiting = sorted(gestures, key=lambda each: each.begin)
    present: list[Gesture] = []
    found, next_one = [], 0
    for time in times:
        while next_one < len(waiting) and waiting[next_one].begin <= time:
            present.append(waiting[next_one])
            next_one += 1
        present = [each for each in present if each.end > time]
        found.append(list(present))
    return found
