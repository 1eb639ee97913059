"""Read and check the table from which samples are drawn: aus.toml, or a user's edited copy.

Comments of the table name its sources.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any

from risorius import assets
from risorius.assets.identities import (
    COLLAR_BUILDERS,
    DARKEST_TONE,
    GLASSES_FRAMES,
    LIGHTEST_TONE,
    MASK_COLOURS,
    SHIRT_COLOURS,
    Population,
)
from risorius.assets.identities.hair import HAIR_CUTS
from risorius.assets.identities.population import BEARDS_OF_MEN, IRIS_FREQUENCIES
from risorius.render import LIGHTS
from risorius.schema import REST_KEY, MadeFrom, OneOf, Record, Within, called, parsed_toml, read

from ..errors import UserError
from ..files import NoSuchFileError, read_text

INTENSITY_LETTERS = ("A", "B", "C", "D", "E")
BLINK_UNIT = "AU45"
NOTHING_WORN = "none"  # in the table: no glasses, or no mask
PERSON_COUNT = 1_000_000  # number of persons of a seed; other seeds have other persons
Weights = Mapping[str, float]
Range = tuple[float, float]


def _layer(title: str) -> Mapping[str, Any]:
    return {layer.title: layer.rows for layer in assets.load("head").layers}[title]


def _units() -> list[str]:
    # Other sections of the table move eyes and head.
    units_of_eyes_and_head = {f"AU{number}" for number in range(51, 65)}
    return [
        unit for unit in _layer("Action units") if unit not in {BLINK_UNIT, *units_of_eyes_and_head}
    ]


def _shares(weights: dict[str, float]) -> Weights:
    """Return shares for a random choice; if all are 0, raise ValueError."""
    if not any(weights.values()):
        raise ValueError("all shares are 0; at least one must be above 0")
    return weights


def _ordered(ends: Range) -> Range:
    if ends[0] > ends[1]:
        raise ValueError(f"was {list(ends)}, must be [low, high], the lower first")
    return ends


def _range_within(low: float, high: float) -> MadeFrom:
    """Return the type of a range whose ends lie between two limits."""
    return MadeFrom(Annotated[Range, Within(low, high)], _ordered)


def _drawn_from(names: Iterable[str] | Callable[[], Iterable[str]]) -> MadeFrom:
    """Return the type of a table that maps some of the given names to weights."""
    return MadeFrom(dict[Annotated[str, OneOf(names)], Weight], _shares)


Weight = Annotated[float, Within(0.0, 1e6)]
Fraction = Annotated[float, Within(0.0, 1.0)]
Degrees = Annotated[float, Within(0.0, 15.0)]
Unit = Annotated[str, OneOf(_units)]


@dataclass(frozen=True)
class Expression(Record):
    """An expression.

    units: probability of each unit. share: weight of the expression. one_sided: probability that a
    face is one-sided.
    """

    units: Annotated[dict[Unit, Fraction], called(REST_KEY)]
    share: Weight = 0.0
    one_sided: Fraction = 0.0

    @property
    def row(self) -> Weights:
        """The row in the form of the table."""
        found = {"share": self.share, "one_sided": self.one_sided, **self.units}
        return {name: value for name, value in found.items() if value}


def _expressions(rows: dict[str, Expression]) -> Mapping[str, Expression]:
    _shares({name: row.share for name, row in rows.items()})
    return rows


def _pairs(pairs: list[list[str]]) -> tuple[frozenset[str], ...]:
    for pair in pairs:
        if len(set(pair)) != 2 or len(pair) != 2:
            raise ValueError(f"was {pair}, must be two different action units")
    return tuple(map(frozenset, pairs))


@dataclass(frozen=True)
class Excluded(Record):
    """Units that exclude each other."""

    pairs: Annotated[tuple[frozenset[str], ...], MadeFrom(list[list[Unit]], _pairs)]


@dataclass(frozen=True)
class Sides(Record):
    """Probabilities of asymmetric and of one-sided faces, and difference between the sides."""

    asymmetric: Fraction
    difference: Fraction
    one_sided: Fraction


@dataclass(frozen=True)
class EyeMotion(Record):
    """Probabilities of a blink and of a look into the camera; spread of the gaze [degrees]."""

    blink: Fraction
    at_camera: Fraction
    horizontal: Degrees
    vertical: Degrees


@dataclass(frozen=True)
class HeadTurn(Record):
    """Spread of the head's rotation [degrees], at most half of the neck's range."""

    yaw: Annotated[float, Within(0.0, 20.0)]
    pitch: Degrees
    roll: Degrees


@dataclass(frozen=True)
class Camera(Record):
    """Ranges of the camera: angles and field of view [degrees], zoom, and shift [heights]."""

    yaw: Annotated[Range, _range_within(-90.0, 90.0)]
    pitch: Annotated[Range, _range_within(-60.0, 60.0)]
    zoom: Annotated[Range, _range_within(0.2, 2.0)]
    field_of_view: Annotated[Range, _range_within(5.0, 90.0)]
    shift: Annotated[Range, _range_within(-0.3, 0.3)]


@dataclass(frozen=True)
class Persons(Record):
    """Number of persons, fraction of women, ages [years], and skin tones, ITA [degrees]."""

    count: Annotated[int, Within(1, PERSON_COUNT)]
    women: Fraction
    age: Annotated[Range, _range_within(18.0, 90.0)]
    tone: Annotated[Range, _range_within(DARKEST_TONE, LIGHTEST_TONE)]


@dataclass(frozen=True)
class Degradations(Record):
    """Probabilities and amounts of blur, noise and compression of pictures."""

    blurred: Fraction
    noisy: Fraction
    compressed: Fraction
    blur: Annotated[Range, _range_within(0.0, 20.0)]
    noise: Annotated[Range, _range_within(0.0, 100.0)]
    jpeg: Annotated[Range, _range_within(1.0, 95.0)]


@dataclass(frozen=True)
class SampleTable(Record):
    """The sections of aus.toml, whose comments are their documentation."""

    kinds: Annotated[Weights, _drawn_from(("neutral", "expression", "mixture", "speech", "unit"))]
    letters: Annotated[Weights, _drawn_from(INTENSITY_LETTERS)]
    expressions: Annotated[Mapping[str, Expression], MadeFrom(dict[str, Expression], _expressions)]
    units: Annotated[Weights, _drawn_from(_units)]
    together: dict[Unit, dict[Unit, Fraction]]
    excluded: Excluded
    speech: Annotated[Weights, _drawn_from(lambda: _layer("Visemes"))]
    sides: Sides
    eyes: EyeMotion
    head: HeadTurn
    camera: Camera
    persons: Persons
    irises: Annotated[Weights, _drawn_from(IRIS_FREQUENCIES)]
    cuts_of_women: Annotated[Weights, _drawn_from(HAIR_CUTS)]
    cuts_of_men: Annotated[Weights, _drawn_from(HAIR_CUTS)]
    beards: Annotated[Weights, _drawn_from(BEARDS_OF_MEN)]
    shirts: Annotated[Weights, _drawn_from(SHIRT_COLOURS)]
    collars: Annotated[Weights, _drawn_from(COLLAR_BUILDERS)]
    glasses: Annotated[Weights, _drawn_from((NOTHING_WORN, *GLASSES_FRAMES))]
    masks: Annotated[Weights, _drawn_from((NOTHING_WORN, *MASK_COLOURS))]
    lights: Annotated[Weights, _drawn_from(LIGHTS)]
    degradations: Degradations

    @property
    def population(self) -> Population:
        """The population of random persons."""
        persons = self.persons
        return Population(
            women=persons.women,
            ages=persons.age,
            tones=persons.tone,
            irises=self.irises,
            cuts_of_women=self.cuts_of_women,
            cuts_of_men=self.cuts_of_men,
            beards=self.beards,
        )

    def can_be_combined(self, unit: str, others: Container[str]) -> bool:
        """Whether a unit may be combined with other units."""
        excluding = {other for pair in self.excluded.pairs if unit in pair for other in pair}
        return not any(other in others for other in excluding - {unit})


def table_text() -> str:
    """Return the text of the built-in table, which users copy and edit."""
    return (files(__package__) / "aus.toml").read_text("utf-8")


def load_table(path: Path | None) -> SampleTable:
    """Load a table, and add missing rows from the built-in table; None loads the built-in table.

    An error raises UserError, whose message has file, section and row.
    """
    sections = parsed_toml(table_text())
    where = str(path or "aus.toml")
    if path is not None:
        try:
            own = parsed_toml(read_text(path, what="table of samples", longest=2**18))
        except NoSuchFileError:
            raise UserError(
                f"{path}: no such table; `risorius dataset --sample-table > {path.name}` writes one"
            ) from None
        except ValueError as error:
            raise UserError(f"{path}: {error}") from None
        # In these sections, rows that are missing come from the built-in table.
        filled_up = ("sides", "eyes", "head", "camera", "persons", "degradations")
        for name, rows in own.items():
            is_added = name in filled_up and isinstance(rows, dict)
            sections[name] = {**sections[name], **rows} if is_added else rows
    return read(SampleTable, sections, where, error=UserError)


@cache
def paired_units() -> frozenset[str]:
    """Return the action units that have two sides."""
    return frozenset(name for name, row in _layer("Action units").items() if row.get("pair"))
