"""The table that samples are drawn from: aus.toml, or one that a user copied and edited.

Sources of what stands in it are named there. This reads and checks it.
"""

from __future__ import annotations

import tomllib
from collections.abc import Container, Mapping
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
from ..files import NoSuchFileError, read_text
from ..recordings.viseme_tracks import is_number

LONGEST_FILE = 2**18  # [bytes]
KINDS = ("neutral", "expression", "mixture", "speech", "unit")
LETTERS = ("A", "B", "C", "D", "E")
BLINK = "AU45"
OF_EYES_AND_HEAD = {f"AU{number}" for number in range(51, 65)}  # these have their own sections
FILLED_UP = ("sides", "eyes", "head", "camera", "persons")  # rows that are left out are taken
Shares = Mapping[str, float]
Range = tuple[float, float]
ANY = "*"  # rows of any name
WEIGHT, SHARE = (0.0, 1e6), (0.0, 1.0)


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
    where = str(path or "aus.toml")
    if path is not None:
        try:
            own = tomllib.loads(read_text(path, what="table of samples", longest=LONGEST_FILE))
        except NoSuchFileError:
            raise UserError(
                f"{path}: no such table; `risorius dataset --sample-table > {path.name}` writes one"
            ) from None
        except (ValueError, RecursionError) as error:
            raise UserError(f"{path}: not valid TOML: {error}") from None
        for name, rows in own.items():
            is_added = name in FILLED_UP and isinstance(rows, dict)
            sections[name] = {**sections[name], **rows} if is_added else rows
    found = _checked(where, sections, {**_weighted(), **_others()})
    shares = {name: found[name].values() for name in _weighted()}
    shares["expressions"] = [row.get("share") for row in found["expressions"].values()]
    for name, given in shares.items():
        if not any(given):
            raise UserError(f"{where}, '{name}': all shares are 0; one at least must be above")
    found["persons"]["count"] = int(found["persons"]["count"])
    return SampleTable(**{**found, "excluded": found["excluded"].get("pairs", ())})


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
    camera = _checked(f"--camera {text}", pairs, _others()["camera"])
    return replace(table, camera={**table.camera, **camera})


@cache
def paired_units() -> frozenset[str]:
    """The action units that have two sides."""
    return frozenset(name for name, row in _layer("Action units").items() if row.get("pair"))


def _layer(title: str) -> Mapping[str, Any]:
    return {layer.title: layer.rows for layer in assets.load("head").layers}[title]


def _units() -> list[str]:
    return [unit for unit in _layer("Action units") if unit not in {BLINK, *OF_EYES_AND_HEAD}]


def _weighted() -> dict[str, dict[str, Any]]:
    """Sections from which one name is drawn, as `_checked` wants them."""
    names = {"kinds": KINDS, "letters": LETTERS, "units": _units(), "speech": _layer("Visemes"),
             "irises": IRISES, "lights": LIGHTS}  # fmt: skip
    return {section: dict.fromkeys(each, WEIGHT) for section, each in names.items()}


def _others() -> dict[str, dict[str, Any]]:
    """All other sections."""
    shares = dict.fromkeys(_units(), SHARE)
    return {
        "expressions": {ANY: {"share": WEIGHT, "one_sided": SHARE, **shares}},
        "together": dict.fromkeys(shares, shares),
        "excluded": {"pairs": frozenset(shares)},
        "sides": dict.fromkeys(("asymmetric", "difference", "one_sided"), SHARE),
        "eyes": {"blink": SHARE, "at_camera": SHARE, "horizontal": (0, 15), "vertical": (0, 15)},
        "head": {"yaw": (0, 20), "pitch": (0, 15), "roll": (0, 15)},  # half of what the neck turns
        "camera": {"yaw": [-90, 90], "pitch": [-60, 60], "zoom": [0.2, 2.0],
                   "field_of_view": [5, 90], "shift": [-0.3, 0.3]},
        "persons": {"count": (1, 1e6), "tone": [DARKEST, LIGHTEST]},
    }  # fmt: skip


def _checked(where: str, given: Any, allowed: Any) -> Any:
    """What is given, its numbers as floats; UserError where it is not allowed.

    allowed: (least, most) for a number, [least, most] for a pair [low, high] of them, a set for
    pairs of its names, and for rows what is allowed by their names, or by ANY.
    """

    def wrong(what: str) -> UserError:
        """An error about all that is given."""
        return UserError(f"{where}: was {given!r}, must be {what}")

    if isinstance(allowed, dict):
        if not isinstance(given, dict):
            raise wrong("a table of rows")
        for name in given:
            if name not in allowed and ANY not in allowed:
                raise UserError(
                    f"{where}, '{name}': is no name here; allowed are {', '.join(allowed)}"
                )
        return {
            name: _checked(f"{where}, '{name}'", row, allowed.get(name, allowed.get(ANY)))
            for name, row in given.items()
        }
    if isinstance(allowed, frozenset):
        if not isinstance(given, list):
            raise wrong('pairs, as in [["AU26", "AU27"], ...]')
        for pair in given:
            names = set(map(str, pair)) if isinstance(pair, list) else set()
            if len(names) != 2 or not names <= allowed:
                raise UserError(f"{where}: was {pair!r}, must be two different action units")
        return tuple(map(frozenset, given))
    least, most = allowed
    if isinstance(allowed, list):
        if not isinstance(given, list) or len(given) != 2:
            raise wrong("[low, high]")
        low, high = (_checked(where, value, (least, most)) for value in given)
        if low > high:
            raise wrong("[low, high], the lower first")
        return low, high
    if not is_number(given) or not least <= given <= most:
        raise wrong(f"a number from {least:g} to {most:g}")
    return float(given)
