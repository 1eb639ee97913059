"""Layers of controls: tables whose rows move the layers below, down to the muscles.

    muscles, jaw, gaze  <  both sides  <  action units  <  expressions  <  visemes  <  ARKit shapes

A layer is a table of rows; a row is a control of its own, named by its key. Each entry of a row is
a weight: at value 1, the row adds this weight to the control that the entry names. This control
must be in a layer below. Five keys of a row are not entries. `action` describes the effect of the
row. `pair = true` makes three controls of one row: one for both sides, `..._left` and `..._right`;
`pair = "Left Right"` makes two, `...Left` and `...Right`, as ARKit spells them:

    [AU4]
    action = "brow lowerer"
    pair = true
    corrugator_supercilii = 1.0     # a name without side is both sides; AU4_left takes the left
    procerus = 0.9                  # one in the middle: AU4_left takes half, so that left + right
                                    # is AU4

`mirror` names a second control, which is the row with left and right exchanged:

    [wink]
    action = "left eye shut"
    mirror = "wink_right"
    AU46_left = 1.0

`share_of` names another control, above the row in the same table or in a layer below. The row then
counts as its own value / the other control's value, at most 1:

    [mouthClose]
    action = "lips shut over the open jaw"
    share_of = "jawOpen"            # mouthClose 0.3 shuts the lips fully at jawOpen 0.3, and by
    lips_closed = 1.0               # half at jawOpen 0.6; without jawOpen it has no effect

`at_least` holds weights that do not add to others; they are minimum values, called floors.

    [AU22]
    action = "lip funneler"
    at_least = { jaw_open = 0.22 }  # lips need room for a funnel; an open jaw has it already

How layers combine: everything adds up, in any order of setting. A muscle's value is its own value,
plus each control above it times its weight. It is raised to the greatest floor, and cut off at the
muscle's limits once, at the end.

Source: Ekman, Friesen, Hager 2002, "Facial Action Coding System" (its action units); Apple,
ARFaceAnchor.BlendShapeLocation (its shapes); the tables themselves are files of assets. Differs
from FACS: all units add, but some units of FACS exclude each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np

from ..geometry.arrays import Floats64
from ..geometry.read_only import read_only
from ..schema import OneOf, Record, Rest, Within, question, read_once
from .checked import several

BOTH_SIDES = "Both sides"  # title of the layer in every face with paired muscles
SIDE_ENDINGS = ("_left", "_right")
# Endings of the names of a pair's sides, by the value of `pair`.
PAIR_ENDINGS: Mapping[bool | str, tuple[str, ...]] = MappingProxyType(
    {True: SIDE_ENDINGS, "Left Right": ("Left", "Right")}
)
GREATEST_WEIGHT = 2.0  # a larger weight is taken for a typing error
Weight = Annotated[float, Within(-GREATEST_WEIGHT, GREATEST_WEIGHT)]
Floor = Annotated[float, Within(0.0, GREATEST_WEIGHT)]
SidesOfPair = Annotated[bool | str, OneOf((False, *PAIR_ENDINGS), 'true, false or "Left Right"')]
LEAST_WHOLE = 0.08  # value of the control in `share_of` below which the weight fades


@dataclass(frozen=True)
class Layers:
    """All controls above the lowest controls, with their effects on the lowest controls.

    groups: title of the layer -> its names, from the lowest layer up.
    actions: name -> its effect, in words; "" if the table has none.
    shares: name -> its addition to each of the C lowest controls at value 1, shape (C,).
    floors: name -> the least value of each lowest control at value 1, 0 for none, shape (C,).
    share_of: name -> the control in the row's `share_of`, where there is one.
    """

    groups: Mapping[str, tuple[str, ...]]
    actions: Mapping[str, str]
    shares: Mapping[str, Floats64]
    floors: Mapping[str, Floats64]
    share_of: Mapping[str, str]


NO_LAYERS = Layers(*(MappingProxyType({}) for _ in range(5)))


def fraction_of_whole(value: float, whole: float) -> float:
    """Return `value` / `whole`, limited to 0 .. 1, and 0 if `whole` is 0.

    whole: value of the control that `share_of` names.
    """
    return min(value, max(whole, 0.0)) / max(whole, LEAST_WHOLE)


def read_layers(given: Sequence[Any], lowest: Sequence[str]) -> Layers:
    """Turn tables into weights of the lowest controls.

    given: objects from the bottom up, with `title`, `source` (the file, for errors) and `rows`,
    {row: {key: value}}; lowest: names of the lowest controls.

    Raises ValueError, with file and row, for a name that no layer below has, a weight that is not a
    number, a name already in use, and a paired row whose name has a side.
    """
    reader = _Reader(lowest)
    reader.add_both_sides()
    for layer in several("head.layers", given, ("title", "source", "rows")):
        below = dict(reader.weights)  # the controls that a row of this layer may name
        names: list[str] = []
        for name, row in read_once(dict[str, _Row], layer.rows, str(layer.source)).items():
            names += reader.add(f"{layer.source}, '{name}'", name, row, below)
        reader.groups[str(layer.title)] = tuple(names)
    weights = list(reader.weights.items())[len(lowest) :]
    floors = list(reader.floors.items())[len(lowest) :]
    return Layers(
        groups=MappingProxyType({title: names for title, names in reader.groups.items() if names}),
        actions=MappingProxyType(reader.actions),
        shares=MappingProxyType({name: read_only(row) for name, row in weights}),
        floors=MappingProxyType({name: read_only(row) for name, row in floors}),
        share_of=MappingProxyType(reader.share_of),
    )


@dataclass(frozen=True)
class _Row(Record):
    """A row of a table, as the head of this module describes it."""

    entries: Rest[Weight]
    action: str = ""
    pair: SidesOfPair = False
    mirror: str | None = None
    share_of: str | None = None
    at_least: Mapping[str, Floor] = field(default_factory=dict)

    def exchanged(self) -> _Row:
        """The row with left and right exchanged."""
        return replace(
            self, entries=_exchanged_sides(self.entries), at_least=_exchanged_sides(self.at_least)
        )


class _Reader:
    """Collects weights, layer by layer."""

    def __init__(self, lowest: Sequence[str]) -> None:
        self.weights: dict[str, Floats64] = dict(zip(lowest, np.eye(len(lowest)), strict=True))
        self.floors = {name: np.zeros(len(lowest)) for name in lowest}
        self.groups: dict[str, tuple[str, ...]] = {}
        self.actions: dict[str, str] = {}
        self.share_of: dict[str, str] = {}

    def add_both_sides(self) -> None:
        """Add the layer of names without side; each moves both sides, or the only side there is."""
        sides: dict[str, list[Floats64]] = {}
        for name, weight in self.weights.items():
            if name.endswith(SIDE_ENDINGS):
                sides.setdefault(name.rpartition("_")[0], []).append(weight)
        names = tuple(name for name in sides if name not in self.weights)
        for name in names:
            self.weights[name] = np.sum(sides[name], axis=0)
            self.floors[name] = np.zeros_like(self.weights[name])
            self.actions[name] = ""
        self.groups[BOTH_SIDES] = names

    def add(self, where: str, name: str, row: _Row, below: Mapping[str, Floats64]) -> list[str]:
        """Read one row, and return the names of the controls that it makes."""
        self._check(where, name, row, below)
        sides = zip(PAIR_ENDINGS[row.pair], SIDE_ENDINGS, strict=True) if row.pair else [("", "")]
        made = {name + ending: self._sums(row, side, below) for ending, side in sides}
        if row.pair is True:
            weights, floors = zip(*made.values(), strict=True)
            made = {name: (np.sum(weights, axis=0), np.max(floors, axis=0)), **made}
        if row.mirror is not None:
            self._check_entries(where, row.exchanged(), below)
            made[row.mirror] = self._sums(row.exchanged(), "", below)
        for each, (weight, floor) in made.items():
            if each in self.weights:
                raise ValueError(
                    f"{where}: there is a control called '{each}' already; rename the row"
                )
            self.weights[each] = weight
            self.floors[each] = floor
            self.actions[each] = row.action
            if row.share_of is not None:
                self.share_of[each] = row.share_of
        return list(made)

    def _check(self, where: str, name: str, row: _Row, below: Mapping[str, Floats64]) -> None:
        """Raise ValueError for names that a row cannot have, or cannot refer to."""
        if row.share_of is not None and row.share_of not in self.weights:
            raise ValueError(
                f"{where}, 'share_of': no row above and no layer below has a control called "
                f"'{row.share_of}'{question(row.share_of, self.weights)}"
            )
        if row.mirror is not None and (row.pair or row.mirror == name):
            allowed = "another name, in a row that is not a pair"
            raise ValueError(f"{where}, 'mirror': was '{row.mirror}', must be {allowed}")
        if row.pair:
            for side in (*SIDE_ENDINGS, *PAIR_ENDINGS["Left Right"]):
                if name.endswith(side):
                    raise ValueError(f"{where}: a pair adds the sides; omit '{side}'")
            for control in (*row.entries, *row.at_least):
                if control.endswith(SIDE_ENDINGS):
                    raise ValueError(f"{where}: in a pair omit the side of '{control}'")
        self._check_entries(where, row, below)

    def _check_entries(self, where: str, row: _Row, below: Mapping[str, Floats64]) -> None:
        """Raise ValueError if a layer below lacks a control of a row, or it has `share_of`."""
        for control in (*row.entries, *row.at_least):
            if control not in below:
                guess = question(control, below)
                raise ValueError(f"{where}: no layer below has a control called '{control}'{guess}")
            if control in self.share_of:
                raise ValueError(
                    f"{where}, '{control}': is a fraction of '{self.share_of[control]}', and "
                    "no row may refer to it; name the controls that it moves instead"
                )

    def _sums(
        self, row: _Row, side: str, below: Mapping[str, Floats64]
    ) -> tuple[Floats64, Floats64]:
        """Shares and floors of a row, shape (C,) each; `side`: the side in a pair, or "".

        A side takes its own side of each entry. An entry without sides gives it half the weight,
        and the whole floor.
        """
        control_count = len(next(iter(below.values()), ()))
        weight = np.zeros(control_count)
        floor = np.zeros(control_count)
        for control, part in row.entries.items():
            sided = control + side
            weight += part * (below[sided] if sided in below else 0.5 * below[control])
            floor = np.maximum(floor, part * self.floors[sided if sided in below else control])
        for control, part in row.at_least.items():
            floor = np.maximum(floor, part * below.get(control + side, below[control]))
        return weight, floor


def _exchanged_sides(entries: Mapping[str, float]) -> dict[str, float]:
    """Entries of a row with left and right exchanged."""
    left, right = SIDE_ENDINGS
    names = {name: name.removesuffix(left) + right for name in entries if name.endswith(left)}
    names |= {name: name.removesuffix(right) + left for name in entries if name.endswith(right)}
    return {names.get(name, name): value for name, value in entries.items()}
