"""The table that samples are drawn from: aus.toml, or one that a user copied and edited.

Sources of what stands in it are named there. This reads and checks it.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from risorius import assets
from risorius.assets.generator.eyeballs import IRISES
from risorius.assets.identities import DARKEST, LIGHTEST

from ..errors import UserError
from ..files import read_text

OF_EYES_AND_HEAD = {f"AU{number}" for number in range(51, 65)}  # these have their own sections
LONGEST_FILE = 2**18  # [bytes]
KINDS = ("neutral", "expression", "mixture", "speech", "unit")
LETTERS = ("A", "B", "C", "D", "E")
SIDES = ("asymmetric", "difference", "one_sided")
EYES = {"blink": 1.0, "at_camera": 1.0, "horizontal": 25.0, "vertical": 25.0}  # and the most
HEAD = {"yaw": 20.0, "pitch": 15.0, "roll": 15.0}  # half of what the neck turns [degrees]
CAMERA = {  # least and most
    "yaw": (-90.0, 90.0),
    "pitch": (-60.0, 60.0),
    "zoom": (0.2, 2.0),
    "field_of_view": (5.0, 90.0),
    "shift": (-0.3, 0.3),
}
Shares = Mapping[str, float]
Range = tuple[float, float]


@dataclass(frozen=True)
class Expression:
    """A row of the expressions: units, each with the share of such faces that show it."""

    share: float
    one_sided: float
    units: Shares


@dataclass(frozen=True)
class SampleTable:
    """What aus.toml says, section by section; its comments are the documentation."""

    kinds: Shares
    letters: Shares
    expressions: Mapping[str, Expression]
    units: Shares
    together: Mapping[str, Shares]
    excluded: frozenset[frozenset[str]]
    speech: Shares
    sides: Shares
    eyes: Shares
    head: Shares
    camera: Mapping[str, Range]
    persons: int
    tone: Range
    irises: Shares
    paired: frozenset[str]  # action units that have two sides
    sections: Mapping[str, Any]  # all of it, as TOML has it

    def goes_with(self, unit: str, others: Container[str] | Mapping[str, float]) -> bool:
        """Whether a unit may be there beside those that are."""
        return not any(
            other in others for pair in self.excluded if unit in pair for other in pair - {unit}
        )


def table_text() -> str:
    """The table that comes along, to be copied and edited."""
    return (files(__package__) / "aus.toml").read_text("utf-8")


def load_table(path: Path | None) -> SampleTable:
    """The table in a file over the one that comes along; None: that alone.

    Raises UserError with file, section and row.
    """
    sections = _parsed(table_text(), "aus.toml")
    if path is not None:
        try:
            text = read_text(path, what="table of samples", longest=LONGEST_FILE)
        except FileNotFoundError:
            raise UserError(
                f"{path}: no such table; `risorius dataset --sample-table > {path.name}` writes one"
            ) from None
        own = _parsed(text, str(path))
        if unknown := set(own) - set(sections):
            raise UserError(
                f"{path}: there is no section [{min(unknown)}]; allowed are {', '.join(sections)}"
            )
        sections.update(own)
    return _Reader(str(path or "aus.toml")).table(sections)


def _parsed(text: str, source: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise UserError(f"{source}: not valid TOML: {error}") from None


class _Reader:
    """Checks sections; every error names the file, the section and the row."""

    def __init__(self, source: str) -> None:
        self._source = source
        self._rows = {layer.title: layer.rows for layer in assets.load("head").layers}

    def table(self, given: Mapping[str, Any]) -> SampleTable:
        """All sections."""
        for name, section in given.items():
            if not isinstance(section, dict):
                raise self._error(name, "must be a section of rows", section)
        excluded = self._excluded(given["excluded"])
        table = SampleTable(
            kinds=self._named("kinds", given["kinds"], dict.fromkeys(KINDS, 1e6), some=True),
            letters=self._named(
                "letters", given["letters"], dict.fromkeys(LETTERS, 1e6), some=True
            ),
            expressions={
                name: self._expression(f"expressions, row '{name}'", row)
                for name, row in given["expressions"].items()
            },
            units=self._shares("units", given["units"], self._is_unit, 1e6),
            together={
                name: self._shares(f"together, row '{name}'", row, self._is_unit)
                for name, row in given["together"].items()
            },
            excluded=excluded,
            speech=self._shares("speech", given["speech"], self._is_viseme, 1e6),
            sides=self._named("sides", given["sides"], dict.fromkeys(SIDES, 1.0)),
            eyes=self._named("eyes", given["eyes"], EYES),
            head=self._named("head", given["head"], HEAD),
            camera={name: self.camera_range(name, given["camera"].get(name)) for name in CAMERA},
            persons=int(self._number("persons, 'count'", given["persons"].get("count"), 1, 1e6)),
            tone=self._range("persons, 'tone'", given["persons"].get("tone"), DARKEST, LIGHTEST),
            irises=self._named("irises", given["irises"], dict.fromkeys(IRISES, 1e6), some=True),
            paired=frozenset(
                name for name, row in self._rows["Action units"].items() if row.get("pair")
            ),
            sections=given,
        )
        self._check_all(table, given)
        return table

    def _check_all(self, table: SampleTable, given: Mapping[str, Any]) -> None:
        """What no section alone can tell."""
        if unknown := set(given["camera"]) - set(CAMERA):
            raise self._error("camera", f"allowed are {', '.join(CAMERA)}", min(unknown))
        for name in table.together:
            self._is_unit("together", name)
        for kind, rows in (
            ("expression", [each.share for each in table.expressions.values()]),
            ("mixture", table.units.values()),
            ("unit", table.units.values()),
            ("speech", table.speech.values()),
        ):
            if table.kinds[kind] > 0.0 and sum(rows) <= 0.0:
                raise UserError(f"{self._source}: [kinds] wants {kind}, but no row has a share")
        for name, row in table.expressions.items():
            certain = [unit for unit, share in row.units.items() if share >= 1.0]
            for unit in certain:
                if not table.goes_with(unit, certain):
                    raise UserError(
                        f"{self._source}: expressions, row '{name}': {unit} is excluded by another "
                        "unit that is always there, see [excluded]"
                    )

    def _expression(self, where: str, row: Any) -> Expression:
        if not isinstance(row, dict) or "share" not in row:
            raise self._error(where, "must be { share = 1, AU12 = 1.0, ... }", row)
        rest = dict(row)
        share = self._number(f"{where}, 'share'", rest.pop("share"), 0.0, 1e6)
        one_sided = self._number(f"{where}, 'one_sided'", rest.pop("one_sided", 0.0), 0.0, 1.0)
        return Expression(share, one_sided, self._shares(where, rest, self._is_unit))

    def _excluded(self, section: Mapping[str, Any]) -> frozenset[frozenset[str]]:
        pairs = section.get("pairs")
        if set(section) != {"pairs"} or not isinstance(pairs, list):
            raise self._error("excluded", 'must be pairs = [["AU26", "AU27"], ...]', section)
        for pair in pairs:
            if not isinstance(pair, list) or len(pair) != 2 or pair[0] == pair[1]:
                raise self._error("excluded", "must be a pair of two action units", pair)
            for unit in pair:
                self._is_unit("excluded", unit)
        return frozenset(map(frozenset, pairs))

    def _shares(
        self, where: str, rows: Any, check: Callable[[str, Any], None], most: float = 1.0
    ) -> dict[str, float]:
        if not isinstance(rows, dict):
            raise self._error(where, "must be names with shares", rows)
        for name in rows:
            check(where, name)
        return {
            name: self._number(f"{where}, '{name}'", value, 0.0, most)
            for name, value in rows.items()
        }

    def _named(
        self, where: str, rows: Mapping[str, Any], most: Mapping[str, float], *, some: bool = False
    ) -> dict[str, float]:
        """Rows whose names are given; `some`: not all may be 0."""
        if set(rows) != set(most):
            raise self._error(where, f"must have the rows {', '.join(most)}", ", ".join(rows))
        found = {
            name: self._number(f"{where}, '{name}'", rows[name], 0.0, limit)
            for name, limit in most.items()
        }
        if some and not any(found.values()):
            raise self._error(where, "must have a share above 0", "0 throughout")
        return found

    def camera_range(self, name: str, given: Any) -> Range:
        """A row of the camera."""
        return self._range(f"camera, '{name}'", given, *CAMERA[name])

    def _range(self, where: str, given: Any, least: float, most: float) -> Range:
        if not isinstance(given, list | tuple) or len(given) != 2:
            raise self._error(where, "must be [low, high]", given)
        low, high = (self._number(where, value, least, most) for value in given)
        if low > high:
            raise self._error(where, "must be [low, high], the lower first", list(given))
        return low, high

    def _is_unit(self, where: str, name: Any) -> None:
        units = [
            unit for unit in self._rows["Action units"] if unit not in {"AU45", *OF_EYES_AND_HEAD}
        ]
        if name not in units:
            raise self._error(where, f"allowed are {', '.join(units)}", name)

    def _is_viseme(self, where: str, name: Any) -> None:
        if name not in self._rows["Visemes"]:
            raise self._error(where, f"allowed are {', '.join(self._rows['Visemes'])}", name)

    def _number(self, where: str, value: Any, least: float, most: float) -> float:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not math.isfinite(value) or not least <= value <= most:
            raise self._error(where, f"must be a number from {least:g} to {most:g}", value)
        return float(value)

    def _error(self, where: str, allowed: str, given: object) -> UserError:
        return UserError(f"{self._source}: {where}: was {given!r}, {allowed}")


def with_camera(table: SampleTable, text: str) -> SampleTable:
    """A table whose camera is `--camera yaw[,pitch[,zoom]]`: each a number, or LOW:HIGH.

    Raises UserError.
    """
    camera = dict(table.camera)
    parts = text.split(",")
    how = f"--camera {text}: write yaw[,pitch[,zoom]], each a number or LOW:HIGH, as in -30:30,0:10"
    if len(parts) > 3:
        raise UserError(how)
    reader = _Reader(f"--camera {text}")
    for name, part in zip(("yaw", "pitch", "zoom"), parts, strict=False):
        try:
            numbers = [float(each) for each in part.split(":")]
        except ValueError:
            raise UserError(how) from None
        camera[name] = reader.camera_range(name, numbers * 2 if len(numbers) == 1 else numbers)
    plain = {name: list(limits) for name, limits in camera.items()}
    return replace(table, camera=camera, sections={**table.sections, "camera": plain})
