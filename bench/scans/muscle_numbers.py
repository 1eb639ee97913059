"""The numbers of a rig's muscles, jaw and lids as one vector, for a fit: own ones, and shared ones.

A number is told in units of how far it may easily go (SCALES), from where anatomy starts it. What
muscles have in common is told once: a shared change goes to all fibred muscles at once, to all ends
in the knot beside the corner of the mouth, or to the upper and the lower part of a muscle of the
lips, mirrored. So what one muscle teaches of widths and strengths holds for those that no scan
shows.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from importlib.resources import files
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.sim.rig import Eyes, Fibre, Jaw, LidMuscle, LinearMuscle, Muscle, Rig, RingMuscle
from risorius.sim.rig_reader import read_rig

Array = npt.NDArray[np.float64]
Path = tuple[str | int, ...]
Part = Muscle | Jaw | Eyes
Parts = Mapping[str, Part]  # muscles by their names, "jaw" and "eyes"

SCALES: Mapping[type, Mapping[str, float]] = {
    LinearMuscle: {
        "contraction": 0.1, "width": 4.0, "beyond": 4.0, "bulge": 2.0, "bulge_at": 0.15,
        "wrap": 0.2, "stiffness": 8.0,
    },
    Fibre: {
        "weight": 0.3, "gain": 0.3, "width_factor": 0.2, "convergence": 0.3, "origin": 4.0,
        "insertion": 3.0,
    },
    RingMuscle: {
        "contraction": 0.12, "radii": 4.0, "edge": 0.15, "push": 4.0, "flare": 3.0,
        "turn_deg": 12.0, "bulge": 3.0, "stiffness": 8.0, "centre": 4.0,
    },
    Jaw: {
        "opening_deg": 3.0, "opening_glide": 3.0, "sideways_glide": 3.0, "sideways_deg": 3.0,
        "condyle": 6.0, "seeds": 0.3,
    },
    Eyes: {
        "lid_reach": 3.0, "lid_plateau": 1.5, "blink_meeting": 0.1, "blink_slide": 1.5,
        "raise_slide": 3.0, "fold_plateau": 3.0, "fold_reach": 3.0,
    },
}  # fmt: skip
COMMON = (*SCALES[LinearMuscle], "weight", "convergence")  # to all fibred muscles
NATURE = (
    "kind", "action", "group", "pair", "halves", "crosses", "tone", "bone", "gate", "opens_lips",
    "lies_on", "lid",
)  # fmt: skip
CORNER = ((54, 1.0),)  # where muscles end in one knot, the modiolus
TWINS = (("_superioris", "_inferioris"), ("_upper", "_lower"))
MIRRORED = {("push", 1), ("turn_deg", 0), ("centre", "offset", 1)}  # of a lower lip: the other way
SWAPPED: Mapping[Path, Path] = {("radii", 1): ("radii", 2), ("radii", 2): ("radii", 1)}


@dataclass(frozen=True)
class Anatomy:
    """What is known of a face before any scan: its muscles, jaw and lids, and who makes a shape."""

    parts: Parts
    rows: Mapping[str, Mapping[str, float]]


def anatomical(document: Mapping[str, Any]) -> Anatomy:
    """Muscles of a rig's document as anatomy.toml has them; those that it has not as they are."""
    known = tomllib.loads((files(__package__) / "anatomy.toml").read_text(encoding="utf-8"))
    tables = dict(document["muscle"])
    for name, table in known["muscle"].items():
        nature = {key: value for key, value in tables[name].items() if key in NATURE}
        tables[name] = nature | known[nature["kind"]] | table
        if "fibre" in table:
            tables[name]["fibre"] = [known["fibre"] | each for each in table["fibre"]]
    bones = {key: known[key] for key in ("jaw", "eyes")}
    return Anatomy(parts_of(read_rig({"format": 1, "muscle": tables} | bones)), known["rows"])


def parts_of(rig: Rig) -> Parts:
    """All that a rig moves skin with."""
    return {"jaw": rig.jaw, "eyes": rig.eyes, **{each.name: each for each in rig.muscles}}


def moved_by(control: str, parts: Parts) -> str:
    """The part of a control; lids are moved by what the eyes say of them."""
    name = whole(control)
    if name.startswith("jaw_"):
        return "jaw"
    return "eyes" if isinstance(parts[name], LidMuscle) else name


def whole(control: str) -> str:
    """The muscle of a control."""
    return control.removesuffix("_left").removesuffix("_right")


@dataclass(frozen=True)
class Number:
    """One number of one part."""

    part: str
    path: Path
    scale: float
    low: float
    high: float

    def of(self, part: Part) -> float:
        """What it is."""
        value: Any = part
        for key in self.path:
            value = value[key] if isinstance(key, int) else getattr(value, key)
        return float(value)

    def put(self, part: Part, value: float) -> Part:
        """The part with another value here, within what a rig file may say."""
        found: Part = _put(part, self.path, float(np.clip(value, self.low, self.high)))
        return found


class Numbers:
    """All numbers of some parts, and a vector of changes: one of each, then the shared ones."""

    def __init__(self, parts: Parts, used: Iterable[str]) -> None:
        self._parts = parts
        self.all = tuple(each for name in used for each in _numbers(name, parts[name]))
        self._start = np.array([each.of(parts[each.part]) for each in self.all])
        self._scale = np.array([each.scale for each in self.all])
        groups: dict[tuple[str, Path], list[tuple[int, float]]] = {}
        for j, number in enumerate(self.all):
            shared = _shared(number, parts[number.part])
            if shared is not None:
                groups.setdefault(shared[0], []).append((j, shared[1]))
        several = [group for group in groups.values() if len(group) > 1]
        self.sharing = np.zeros((len(self.all), len(several)))
        for column, group in enumerate(several):
            for j, sign in group:
                self.sharing[j, column] = sign

    @property
    def count(self) -> int:
        """How long a vector of changes is."""
        return sum(self.sharing.shape)

    def parts(self, changes: Array) -> dict[str, Part]:
        """All parts with these changes, shape (count,)."""
        own = len(self.all)
        values = self._start + self._scale * (changes[:own] + self.sharing @ changes[own:])
        found = dict(self._parts)
        for number, value in zip(self.all, values, strict=True):
            found[number.part] = number.put(found[number.part], float(value))
        return found


def _numbers(name: str, part: Part) -> list[Number]:
    """What may be fitted of a part."""
    found = _of(part, name, ())
    for place, fibre in enumerate(getattr(part, "fibres", ())):
        found += _of(fibre, name, ("fibres", place))
    return found


def _of(owner: Any, part: str, above: Path) -> list[Number]:
    """The numbers of a part or of one of its fibres."""
    found = []
    for key, scale in SCALES.get(type(owner), {}).items():
        rule = next(each for each in fields(owner) if each.name == key).metadata
        low, high = rule.get("low", -np.inf), rule.get("high", np.inf)
        value, path = getattr(owner, key), (*above, key)
        if rule["rule"] == "point":
            value, path = value.offset, (*path, "offset")
        paths = [(*path, k) for k in range(len(value))] if isinstance(value, tuple) else [path]
        if rule["rule"] == "seeds":  # pairs of a landmark and its share, which is but advice
            paths = [(*each, 1) for each in paths]
        found += [Number(part, each, scale, low, high) for each in paths]
    return found


def _shared(number: Number, part: Part) -> tuple[tuple[str, Path], float] | None:
    """With whom a number is shared, and which way it goes there."""
    if isinstance(part, LinearMuscle) and number.path[2:3] == ("insertion",):
        is_knotted = part.fibres[int(number.path[1])].insertion.mix == CORNER
        return (("modiolus", number.path[-1:]), 1.0) if is_knotted else None
    if number.path[-1] in COMMON and number.path[0] in ("fibres", *SCALES[LinearMuscle]):
        is_fibred = not number.part.startswith(("orbicularis", "incisivus", "cheek_puff"))
        return (("fibred", number.path[-1:]), 1.0) if is_fibred else None
    for upper, lower in TWINS:
        if number.part.endswith(lower):
            other = number.part.removesuffix(lower) + upper
            sign = -1.0 if number.path in MIRRORED else 1.0
            return (other, SWAPPED.get(number.path, number.path)), sign
        if number.part.endswith(upper):
            return (number.part, number.path), 1.0
    return None


def _put(owner: Any, path: Path, value: float) -> Any:
    """A frozen thing with another value somewhere in it."""
    key, below = path[0], path[1:]
    if isinstance(key, int):
        items = list(owner)
        items[key] = _put(items[key], below, value) if below else value
        return tuple(items)
    return replace(owner, **{key: _put(getattr(owner, key), below, value) if below else value})


def with_parts(rig: Rig, parts: Mapping[str, Any]) -> Rig:
    """A rig with other parts under the same names."""
    muscles = tuple(parts[each.name] for each in rig.muscles)
    return replace(rig, jaw=parts["jaw"], eyes=parts["eyes"], muscles=muscles)
