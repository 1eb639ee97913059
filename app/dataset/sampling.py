"""Choose the random values that describe sample n of a seed.

    table, seed, n  ->  Sample: expression, head, eyes, camera, person, light

All random numbers of a sample come from numpy's SeedSequence([seed, n]). Each part of a sample has
a separate stream, so that other ranges of the camera do not change the faces.

aus.toml names the sources of the table. Letters of intensity are equal fifths of 0 to 1 here, as in
OpenFace and DISFA, which number them 1 to 5. In FACS, C and D are wider than the other letters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..control_names.angles import FULL_ANGLES
from .degrading import Degradation
from .table import BLINK_UNIT, INTENSITY_LETTERS, PERSON_COUNT, SampleTable, Weights, paired_units

MOST_UNITS = 7  # greatest number of units in a mixture


@dataclass(frozen=True)
class SampleCamera:
    """A camera around the head.

    yaw, pitch: position of the camera [degrees].
    zoom: 1 fits the head into the picture; 2 makes it twice as large.
    field_of_view: from top to bottom [degrees].
    shift: offset of the head to the right and up, as fractions of the picture's height.
    """

    yaw: float
    pitch: float
    zoom: float
    field_of_view: float
    shift: tuple[float, float]


@dataclass(frozen=True)
class Sample:
    """The numbers that describe a sample.

    kind: kind of face, such as "expression".
    name: name of the face, such as "happiness".
    controls: all controls of the face, except the gaze.
    gaze: angles of the eyes relative to the head, to its left and up [degrees]; None: the eyes look
        into the camera.
    view: the camera.
    person: number of the person, see `assets.identities.sample_identity`.
    light: name of a light of the renderer; light maps of the user replace it.
    surroundings: seed of light and background.
    degradation: blur, noise and JPEG compression, for degraded sets.
    """

    seed: int
    index: int
    kind: str
    name: str
    controls: Mapping[str, float]
    gaze: tuple[float, float] | None
    view: SampleCamera
    person: int
    light: str
    surroundings: int
    degradation: Degradation


def draw(table: SampleTable, seed: int, index: int) -> Sample:
    """Choose the random values of sample number `index` of a seed."""
    streams = np.random.SeedSequence([seed, index]).spawn(6)
    faces, sides, heads, cameras, looks, faults = map(np.random.default_rng, streams)
    kind = chosen(faces, table.kinds)
    face = _Face(table, faces)
    name = face.fill(kind)
    controls = face.controls | _blink(table, heads, face.controls)
    controls = _two_sided(table, sides, controls, face.one_sided)
    for angle in ("yaw", "pitch", "roll"):
        degrees = getattr(table.head, angle) * _bounded_normal(heads)
        controls[f"head_{angle}"] = degrees / FULL_ANGLES[f"head_{angle}"]
    aside = [
        getattr(table.eyes, direction) * _bounded_normal(heads)
        for direction in ("horizontal", "vertical")
    ]
    is_at_camera = heads.random() < table.eyes.at_camera
    ranges = [getattr(table.camera, each) for each in ("yaw", "pitch", "zoom", "field_of_view")]
    yaw, pitch, zoom, field_of_view = (float(cameras.uniform(*each)) for each in ranges)
    across, along = (float(cameras.uniform(*table.camera.shift)) for _ in range(2))
    return Sample(
        seed=seed,
        index=index,
        kind=kind,
        name=name,
        controls={key: round(float(value), 4) for key, value in controls.items()},
        gaze=None if is_at_camera else (aside[0], aside[1]),
        view=SampleCamera(
            yaw=yaw, pitch=pitch, zoom=zoom, field_of_view=field_of_view, shift=(across, along)
        ),
        person=seed * PERSON_COUNT + int(looks.integers(table.persons.count)),
        light=chosen(looks, table.lights),
        surroundings=int(looks.integers(2**63)),
        degradation=_degradation(table, faults),
    )


def chosen(random: np.random.Generator, frequencies: Weights) -> str:
    """Return a random name; its probability is proportional to its weight."""
    weights = np.array(list(frequencies.values()))
    return list(frequencies)[int(random.choice(len(weights), p=weights / weights.sum()))]


def _degradation(table: SampleTable, random: np.random.Generator) -> Degradation:
    """Draw the blur, noise and JPEG compression of a sample."""
    rows = table.degradations
    probabilities = rows.blurred, rows.noisy, rows.compressed
    is_blurred, is_noisy, is_compressed = random.random(3) < probabilities
    blur = float(random.uniform(*rows.blur))
    noise = float(random.uniform(*rows.noise))
    jpeg = float(random.uniform(*rows.jpeg))
    return Degradation(
        round(blur, 3) if is_blurred else 0.0,
        round(noise, 3) if is_noisy else 0.0,
        round(jpeg) if is_compressed else None,
        int(random.integers(2**63)),
    )


class _Face:
    """A face that is composed unit by unit."""

    def __init__(self, table: SampleTable, random: np.random.Generator) -> None:
        self._table = table
        self._random = random
        self.controls: dict[str, float] = {}
        self.one_sided = table.sides.one_sided  # probability that a unit is one-sided

    def fill(self, kind: str) -> str:
        """Compose a face of some kind; return the name of the face."""
        table = self._table
        random = self._random
        if kind == "expression":
            rows = table.expressions
            name = chosen(random, {name: row.share for name, row in rows.items()})
            self.one_sided = float(random.random() < rows[name].one_sided)
            strength = self._intensity()
            for unit, probability in rows[name].units.items():
                if random.random() < probability:
                    self._add(unit, strength * random.uniform(0.75, 1.1))
            return name
        if kind == "unit":
            self._add(unit := chosen(random, table.units), self._intensity())
            return unit
        if kind == "mixture":
            self._mix(table.units)
            return "+".join(self.controls)
        return self._speak() if kind == "speech" else ""

    def _mix(self, units: Weights) -> None:
        """Add one or two random units, and units that often accompany them."""
        random = self._random
        waiting = [chosen(random, units) for _ in range(1 + int(random.random() < 0.5))]
        while waiting and len(self.controls) < MOST_UNITS:
            unit = waiting.pop(0)
            if unit in self.controls or not self._add(unit, self._intensity()):
                continue
            for other, probability in self._table.together.get(unit, {}).items():
                if random.random() < probability:
                    waiting.append(other)

    def _speak(self) -> str:
        """Add one viseme or a blend of two, and in half of all cases units of brows and eyes."""
        random = self._random
        names = [chosen(random, self._table.speech) for _ in range(2)]
        blend = random.uniform(0.2, 0.8) if random.random() < 0.5 else 1.0
        strength = random.uniform(0.5, 1.0)
        brows_and_eyes = ("AU1", "AU2", "AU4", "AU5", "AU6", "AU7")
        units = {name: self._table.units.get(name, 0.0) for name in brows_and_eyes}
        if random.random() < 0.5 and any(units.values()):
            for name in dict.fromkeys(chosen(random, units) for _ in range(2)):
                self._add(name, self._intensity())
        parts = [blend, 1.0 - blend] if blend < 1.0 else [blend]
        spoken = names[: len(parts)]
        for name, part in zip(spoken, parts, strict=True):
            self.controls[name] = self.controls.get(name, 0.0) + strength * part
        return "+".join(dict.fromkeys(spoken))

    def _add(self, unit: str, value: float) -> bool:
        """Add a unit, unless another unit excludes it; return whether it was added."""
        is_possible = self._table.can_be_combined(unit, self.controls)
        if is_possible:
            self.controls[unit] = min(value, 1.0)
        return is_possible

    def _intensity(self) -> float:
        """Return a random intensity: choose a letter, then a value in its fifth of 0..1."""
        place = INTENSITY_LETTERS.index(chosen(self._random, self._table.letters))
        # Values below a quarter of the lowest fifth would be invisible.
        within = self._random.uniform(0.0 if place else 0.25, 1.0)
        return float((place + within) / len(INTENSITY_LETTERS))


def _blink(
    table: SampleTable, random: np.random.Generator, controls: Mapping[str, float]
) -> dict[str, float]:
    """Return a random blink, partial or full; {} for no blink, or if other units move the lids."""
    is_blinking = random.random() < table.eyes.blink
    closed = random.uniform(0.25, 1.0)
    if not is_blinking or not {"AU5", "AU43", "AU46_left", "AU46_right"}.isdisjoint(controls):
        return {}
    return {BLINK_UNIT: float(closed)}


def _two_sided(
    table: SampleTable,
    random: np.random.Generator,
    controls: Mapping[str, float],
    one_sided: float,
) -> dict[str, float]:
    """Split units of an asymmetric face into two sides; one side is stronger in all units."""
    is_asymmetric = random.random() < table.sides.asymmetric
    side = int(random.integers(2))  # the stronger or only side
    result: dict[str, float] = {}
    sides = ("_left", "_right")
    for name, value in controls.items():
        weaker = 1.0 - min(abs(table.sides.difference * _bounded_normal(random)), 1.0)
        if name not in paired_units() or name == BLINK_UNIT:
            result[name] = value
        elif random.random() < one_sided:
            result[name + sides[side]] = value
        elif is_asymmetric:
            result[name + sides[side]] = value
            result[name + sides[1 - side]] = value * weaker
        else:
            result[name] = value
    return result


def _bounded_normal(random: np.random.Generator) -> float:
    """Return a number of the standard normal distribution, truncated at -2 and 2."""
    while abs(value := float(random.standard_normal())) > 2.0:
        pass
    return value
