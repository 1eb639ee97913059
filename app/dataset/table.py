"""The table that samples are drawn from: aus.toml, or one that a user copied and edited.

Sources of what stands in it are named there. This reads and checks it.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from risorius import assets
from risorius.assets.generator.eyeballs import IRISES
from risorius.assets.identities import DARKEST, LIGHTEST
from risorius.render import LIGHTS

from ..errors import UserError
from ..files import read_text

LONGEST_FILE = 2**18  # [bytes]
KINDS = ("neutral", "expression", "mixture", "speech", "unit")
LETTERS = ("A", "B", "C", "D", "E")
BLINK = "AU45"
OF_EYES_AND_HEAD = {f"AU{number}" for number in range(51, 65)}  # these have their own sections
FILLED_UP = ("sides", "eyes", "head", "camera", "persons")  # rows that are left out are taken
Shares = Mapping[str, float]
Range = tuple[float, float]
Check = Callable[[str, Any], Any]  # takes where something stands and what; returns it, or raises


@dataclass(frozen=True)
class SampleTable:
    """What aus.toml says, section by section; its comments are the documentation."""

    kinds: Shares
    letters: Shares
    expressions: Mapping[str, Shares]
    units: Shares
    together: Mapping[str, Shares]
    excluded: tuple[frozenset[str], ...]
    speech: Shares
    sides: Shares
    eyes: Shares
    head: Shares
    camera: Mapping[str, Range]
    persons: Mapping[str, Any]
    irises: Shares
    lights: Shares

    def goes_with(self, unit: str, others: Container[str]) -> bool:
        """Whether a unit may be there beside those that are."""
        excluded = (pair - {unit} for pair in self.excluded if unit in pair)
        return not any(other in others for pair in excluded for other in pair)


def table_text() -> str:
    """The table that comes along, to be copied and edited."""
    return (files(__package__) / "aus.toml").read_text("utf-8")


def load_table(path: Path | None) -> SampleTable:
    """The table in a file over the one that comes along; None: that alone.

    Raises UserError with file, section and row.
    """
    sections = tomllib.loads(table_text())
    if path is not None:
        try:
            own = tomllib.loads(read_text(path, what="table of samples", longest=LONGEST_FILE))
        except FileNotFoundError:
            raise UserError(
                f"{path}: no such table; `risorius dataset --sample-table > {path.name}` writes one"
            ) from None
        except (ValueError, RecursionError) as error:
            raise UserError(f"{path}: not valid TOML: {error}") from None
        for name, rows in own.items():
            is_added = name in FILLED_UP and isinstance(rows, dict)
            sections[name] = {**sections[name], **rows} if is_added else rows
    return SampleTable(**_rows(_sections())(str(path or "aus.toml"), sections))


def with_camera(table: SampleTable, text: str) -> SampleTable:
    """A table whose camera is `--camera yaw[,pitch[,zoom]]`: each a number, or LOW:HIGH.

    Raises UserError.
    """
    parts = dict(zip(("yaw", "pitch", "zoom"), text.split(","), strict=False))
    try:
        given = {name: [float(each) for each in part.split(":")] for name, part in parts.items()}
        if text.count(",") > 2:
            raise ValueError
    except ValueError:
        raise UserError(
            f"--camera {text}: write yaw[,pitch[,zoom]], each a number or LOW:HIGH, as in "
            "-30:30,0:10"
        ) from None
    pairs = {name: ends * 2 if len(ends) == 1 else ends for name, ends in given.items()}
    camera = _sections()["camera"](f"--camera {text}", {**table.camera, **pairs})
    return replace(table, camera=camera)


@cache
def paired_units() -> frozenset[str]:
    """The action units that have two sides."""
    return frozenset(name for name, row in _layer("Action units").items() if row.get("pair"))


def _layer(title: str) -> Mapping[str, Any]:
    return {layer.title: layer.rows for layer in assets.load("head").layers}[title]


def _sections() -> dict[str, Check]:
    """How each section is checked."""
    share, weight = _number(0.0, 1.0), _number(0.0, 1e6)
    units = [unit for unit in _layer("Action units") if unit not in {BLINK, *OF_EYES_AND_HEAD}]
    shares = dict.fromkeys(units, share)
    expression = _rows({"share": weight, "one_sided": share, **shares})
    camera = {"yaw": (-90.0, 90.0), "pitch": (-60.0, 60.0), "zoom": (0.2, 2.0),
              "field_of_view": (5.0, 90.0), "shift": (-0.3, 0.3)}  # fmt: skip
    eyes = {"blink": 1.0, "at_camera": 1.0, "horizontal": 15.0, "vertical": 15.0}
    head = {"yaw": 20.0, "pitch": 15.0, "roll": 15.0}  # half of what the neck turns [degrees]
    return {
        "kinds": _weights(KINDS),
        "letters": _weights(LETTERS),
        "expressions": _expressions(expression),
        "units": _weights(units),
        "together": _rows(dict.fromkeys(units, _rows(shares))),
        "excluded": lambda where, given: _pairs(where, given, units),
        "speech": _weights(tuple(_layer("Visemes"))),
        "sides": _rows(dict.fromkeys(("asymmetric", "difference", "one_sided"), share)),
        "eyes": _rows({name: _number(0.0, most) for name, most in eyes.items()}),
        "head": _rows({name: _number(0.0, most) for name, most in head.items()}),
        "camera": _rows({name: _range(*ends) for name, ends in camera.items()}),
        "persons": _rows({"count": _count, "tone": _range(DARKEST, LIGHTEST)}),
        "irises": _weights(tuple(IRISES)),
        "lights": _weights(tuple(LIGHTS)),
    }


def _wrong(where: str, given: object, allowed: str) -> UserError:
    return UserError(f"{where}: was {given!r}, {allowed}")


def _number(least: float, most: float) -> Check:
    def check(where: str, given: Any) -> float:
        """A finite number from `least` to `most`."""
        is_number = isinstance(given, int | float) and not isinstance(given, bool)
        if not is_number or not math.isfinite(given) or not least <= given <= most:
            raise _wrong(where, given, f"must be a number from {least:g} to {most:g}")
        return float(given)

    return check


def _count(where: str, given: Any) -> int:
    return int(_number(1, 1e6)(where, given))


def _range(least: float, most: float) -> Check:
    def check(where: str, given: Any) -> Range:
        """[low, high], both from `least` to `most`."""
        if not isinstance(given, list | tuple) or len(given) != 2:
            raise _wrong(where, given, "must be [low, high]")
        low, high = (_number(least, most)(where, value) for value in given)
        if low > high:
            raise _wrong(where, given, "must be [low, high], the lower first")
        return low, high

    return check


def _each(check: Check) -> Check:
    def check_each(where: str, given: Any) -> dict[str, Any]:
        """Rows of any name."""
        if not isinstance(given, dict):
            raise _wrong(where, given, "must be a table of rows")
        return {name: check(f"{where}, '{name}'", row) for name, row in given.items()}

    return check_each


def _rows(checks: Mapping[str, Check]) -> Check:
    def check(where: str, given: Any) -> dict[str, Any]:
        """Rows of some of these names."""
        given = _each(lambda _, row: row)(where, given)
        for name in given:
            if name not in checks:
                raise UserError(
                    f"{where}, '{name}': is no name here; allowed are {', '.join(checks)}"
                )
        return {name: checks[name](f"{where}, '{name}'", row) for name, row in given.items()}

    return check


def _weights(names: Iterable[str]) -> Check:
    def check(where: str, given: Any) -> dict[str, float]:
        """Shares of these names, which are not all 0."""
        found: dict[str, float] = _rows(dict.fromkeys(names, _number(0.0, 1e6)))(where, given)
        if not any(found.values()):
            raise UserError(f"{where}: all shares are 0; one at least must be above")
        return found

    return check


def _expressions(check: Check) -> Check:
    def check_all(where: str, given: Any) -> dict[str, Shares]:
        """Rows of any name, of which some have a share."""
        rows: dict[str, Shares] = _each(check)(where, given)
        if not any(row.get("share") for row in rows.values()):
            raise UserError(f"{where}: all shares are 0; one at least must be above")
        return rows

    return check_all


def _pairs(where: str, given: Any, units: Sequence[str]) -> tuple[frozenset[str], ...]:
    pairs = given.get("pairs") if isinstance(given, dict) else None
    if not isinstance(pairs, list):
        raise _wrong(where, given, 'must be pairs = [["AU26", "AU27"], ...]')
    for pair in pairs:
        if (
            not isinstance(pair, list)
            or len(set(map(str, pair))) != 2
            or not set(map(str, pair)) <= set(units)
        ):
            raise _wrong(where, pair, "must be two different action units")
    return tuple(map(frozenset, pairs))
