"""Reading a rig file: every key is checked against its rule in rig.py.

Errors are ValueError and say where (muscle and key), what it was, and what is allowed; an unknown
key is answered with the nearest known one.

Source: our own file format; the paper's rigs are drawn by hand in an editor.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, Field, fields
from typing import Any, TypeVar, cast

from .checked import number_within, quoted
from .landmarks import LANDMARK_COUNT, LandmarkPoint
from .rig import (
    FORMAT,
    Eyes,
    Fibre,
    Head,
    Jaw,
    LidMuscle,
    LinearMuscle,
    Muscle,
    Rig,
    RingMuscle,
    Tissue,
)

Record = TypeVar("Record")

KINDS: dict[str, type[Muscle]] = {
    "linear": LinearMuscle,
    "ring": RingMuscle,
    "lid": LidMuscle,
}


def read_rig(document: Mapping[str, Any]) -> Rig:
    """Read a rig from the parsed rig file; ValueError names the muscle and key that is wrong."""
    if not isinstance(document, Mapping):
        raise ValueError(f"rig: was {quoted(document)}, must be the table of a rig file")
    _known_keys(document, ("format", "tissue", "jaw", "eyes", "head", "muscle"), "rig")
    version = document.get("format", FORMAT)
    if not isinstance(version, int) or version != FORMAT:
        raise ValueError(f"rig, key 'format': was {quoted(version)}, this version reads {FORMAT}")
    muscles = []
    for name, table in _table(document, "muscle", "rig").items():
        where = f"rig, muscle '{name}'"
        if not isinstance(name, str) or not name.isidentifier() or name != name.lower():
            raise ValueError(
                f"{where}: a muscle name is lower case letters, digits and underscores"
            )
        if name.endswith(("_left", "_right")):
            raise ValueError(f"{where}: the side is added by itself, leave '_left'/'_right' away")
        muscles.append(_read_muscle(name, table, where))
    _check_stack({muscle.name: muscle for muscle in muscles})
    return Rig(
        tissue=_read(Tissue, _table(document, "tissue", "rig"), "rig, tissue"),
        jaw=_read(Jaw, _table(document, "jaw", "rig"), "rig, jaw"),
        eyes=_read(Eyes, _table(document, "eyes", "rig"), "rig, eyes"),
        head=_read(Head, _table(document, "head", "rig"), "rig, head"),
        muscles=tuple(muscles),
    )


def _read_muscle(name: str, table: Any, where: str) -> Muscle:
    """Read one muscle table by its kind."""
    if not isinstance(table, Mapping):
        raise ValueError(f"{where}: was {quoted(table)}, must be a table [muscle.{name}]")
    kind = table.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"{where}, key 'kind': was {quoted(kind)}, allowed are {', '.join(KINDS)}")
    rest = {("fibres" if key == "fibre" else key): v for key, v in table.items() if key != "kind"}
    muscle = _read(KINDS[kind], rest, where, name=name)
    if isinstance(muscle, LinearMuscle) and not muscle.fibres:
        raise ValueError(f"{where}: a linear muscle needs at least one [[muscle.{name}.fibre]]")
    return muscle


def _check_stack(muscles: Mapping[str, Muscle]) -> None:
    """Refuse a muscle on one that is not there, on or under a lid, or at last on itself."""
    for muscle in muscles.values():
        where = f"rig, muscle '{muscle.name}', key 'lies_on'"
        if muscle.lies_on and isinstance(muscle, LidMuscle):
            raise ValueError(f"{where}: a lid lies on the eyeball; leave the key away")
        for name in muscle.lies_on:
            if name not in muscles:
                raise ValueError(f"{where}: there is no muscle '{name}'{question(name, muscles)}")
            if isinstance(muscles[name], LidMuscle):
                raise ValueError(f"{where}: '{name}' is a lid, which carries nothing; take it out")
        _refuse_circle(muscles, (muscle.name,))


def _refuse_circle(muscles: Mapping[str, Muscle], way: tuple[str, ...]) -> None:
    """Go down from the last muscle of a way and refuse to meet its first one again."""
    for name in muscles[way[-1]].lies_on:
        if name == way[0]:
            circle = " on ".join((*way, name))
            raise ValueError(
                f"rig, muscle '{name}', key 'lies_on': {circle} is a circle; take one out"
            )
        if name in muscles and name not in way:
            _refuse_circle(muscles, (*way, name))


def _read(record: type[Record], table: Mapping[str, Any], where: str, **given: Any) -> Record:
    """Build a dataclass from a table: unknown and missing keys are refused, values checked."""
    known = {f.name: f for f in fields(cast(Any, record)) if f.name not in given}
    _known_keys(table, tuple(known), where)
    values = dict(given)
    for key, rule in known.items():
        if key in table:
            values[key] = _value(table[key], rule, f"{where}, key '{key}'")
        elif rule.default is MISSING:
            raise ValueError(f"{where}, key '{key}': is missing")
    return record(**values)


def _value(value: Any, rule: Field[Any], where: str) -> Any:
    """Check one value against the rule of its field."""
    meta = rule.metadata
    match meta["rule"]:
        case "number":
            return number_within(where, value, meta["low"], meta["high"])
        case "vector":
            return _check_vector(value, meta["size"], meta["low"], meta["high"], where)
        case "choice":
            if not isinstance(value, str) or value not in meta["allowed"]:
                allowed = ", ".join(meta["allowed"])
                raise ValueError(f"{where}: was {quoted(value)}, allowed are {allowed}")
            return value
        case "text" | "boolean":
            wanted = str if meta["rule"] == "text" else bool
            if not isinstance(value, wanted):
                raise ValueError(f"{where}: was {quoted(value)}, must be a {meta['rule']}")
            return value
        case "names":
            if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
                raise ValueError(f"{where}: was {quoted(value)}, must be a list of muscle names")
            return tuple(value)
        case "seeds":
            return _read_mix(value, where, low=-2.0, high=2.0)
        case "fibres":
            if not isinstance(value, list):
                raise ValueError(f"{where}: was {quoted(value)}, must be a list of fibre tables")
            read = (_read(Fibre, f, f"{where} {i + 1}") for i, f in enumerate(value))
            return tuple(read)
        case _:
            return _read_point(value, where)


def _read_point(value: Any, where: str) -> LandmarkPoint:
    """Read {landmark = 54} or {landmarks = {45 = 0.6, 14 = 0.4}}, with an optional offset."""
    if not isinstance(value, Mapping):
        raise ValueError(
            f"{where}: was {quoted(value)}, must be a table such as "
            "{landmark = 54, offset = [0, 0, 0]}"
        )
    _known_keys(value, ("landmark", "landmarks", "offset"), where)
    if ("landmark" in value) == ("landmarks" in value):
        raise ValueError(f"{where}: give exactly one of 'landmark' and 'landmarks'")
    single = {str(value["landmark"]): 1.0} if "landmark" in value else None
    mix = _read_mix(single or value["landmarks"], where, low=-5.0, high=5.0)
    total = sum(weight for _, weight in mix)
    if abs(total - 1.0) > 1e-6:
        raise ValueError(f"{where}: the landmark weights add up to {total:g}, must be 1")
    offset = _check_vector(value.get("offset", [0.0] * 3), 3, -200.0, 200.0, f"{where}, 'offset'")
    return LandmarkPoint(mix, (offset[0], offset[1], offset[2]))


def _read_mix(value: Any, where: str, *, low: float, high: float) -> tuple[tuple[int, float], ...]:
    """Read a table landmark number -> weight."""
    if not isinstance(value, Mapping) or not value:
        raise ValueError(f"{where}: was {quoted(value)}, must be a table landmark number = weight")
    mix = []
    for key, weight in value.items():
        text = str(key)
        if not re.fullmatch("[0-9]{1,2}", text) or int(text) >= LANDMARK_COUNT:
            raise ValueError(
                f"{where}: landmark {quoted(text)}, allowed are 0 to {LANDMARK_COUNT - 1}"
            )
        mix.append((int(text), number_within(f"{where}, landmark {text}", weight, low, high)))
    return tuple(mix)


def _check_vector(value: Any, size: int, low: float, high: float, where: str) -> tuple[float, ...]:
    """A list of `size` finite numbers inside [low, high]."""
    if not isinstance(value, list | tuple) or len(value) != size:
        raise ValueError(f"{where}: was {quoted(value)}, must be a list of {size} numbers")
    return tuple(number_within(f"{where}[{i}]", v, low, high) for i, v in enumerate(value))


def _table(document: Mapping[str, Any], key: str, where: str) -> Mapping[str, Any]:
    """The sub-table `key`, empty if it is not there."""
    table = document.get(key, {})
    if not isinstance(table, Mapping):
        raise ValueError(f"{where}, key '{key}': was {quoted(table)}, must be a table [{key}]")
    return table


def _known_keys(table: Mapping[str, Any], known: tuple[str, ...], where: str) -> None:
    """Refuse a key nobody reads, and offer the nearest one that is."""
    for key in table:
        if key not in known:
            hint = question(key, known) or "."
            raise ValueError(f"{where}: unknown key '{key}'{hint} Allowed: {', '.join(known)}")


def question(name: str, known: Iterable[str]) -> str:
    """The nearest known name, as a question at the end of an error; nothing if none is near."""
    near = difflib.get_close_matches(str(name), list(known), n=1)
    return f"; did you mean '{near[0]}'?" if near else ""
