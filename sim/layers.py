"""Layers of controls: tables that speak of what lies below them, down to the muscles.

    muscles, jaw, gaze  <  both sides  <  action units  <  expressions  <  visemes  <  ARKit shapes

A layer is a table of rows; a row is a control of its own, named by its key. Each entry of a row is
a share: the row at 1 adds so much to the control that the entry names, which must stand in a layer
below. Five keys of a row are no entries. `action` says in words what it does. `pair = true` makes
three controls of one row, for both sides, `..._left` and `..._right`; `pair = "Left Right"` makes
two, `...Left` and `...Right`, the way ARKit spells them:

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

`share_of` names a control above it in the same table, or in a layer below: the row's value says how
much of that one's it makes good, and counts as value / the other's value, at most 1:

    [mouthClose]
    action = "lips shut over the open jaw"
    share_of = "jawOpen"            # mouthClose 0.3 shuts the lips where jawOpen is 0.3, and
    lips_closed = 1.0               # where that is 0.6 half; without jawOpen it does nothing

`at_least` holds shares that do not add to others: they are made sure of.

    [AU22]
    action = "lip funneler"
    at_least = { jaw_open = 0.22 }  # lips need room for a funnel: nothing where the jaw is open

How layers combine: everything adds up, whatever was set first. A muscle's value is its own plus,
for each control above it, that control's value times its share; then at least the greatest of what
rows make sure of; cut off at the muscle's limits once, at the end.

Source: Ekman, Friesen, Hager 2002, "Facial Action Coding System" (what an action unit is); Apple,
ARFaceAnchor.BlendShapeLocation (what an ARKit shape is); the tables themselves are files of assets.
Differs from FACS: units add, where some of theirs exclude each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from .checked import number_within, quoted, several
from .landmarks import Array
from .rig_reader import question

BOTH_SIDES = "Both sides"  # title of the layer that every face with paired muscles has
SIDES = ("_left", "_right")
ENDINGS: Mapping[bool | str, tuple[str, ...]] = MappingProxyType(  # of the names of a pair's sides
    {True: SIDES, "Left Right": ("Left", "Right")}
)
GREATEST_SHARE = 2.0  # a share beyond it is a slip of the pen
LEAST_WHOLE = 0.08  # of what a control is a share of: below it the share fades instead of jumping


@dataclass(frozen=True)
class Layers:
    """All controls above the lowest ones, with what each of them does to those.

    groups: title of the layer -> its names, from the lowest layer up.
    actions: name -> what it does, in words; "" where the table does not say.
    shares: name -> what it adds to each of the C lowest controls at value 1, shape (C,).
    floors: name -> the least that it makes of each lowest control at value 1, 0 for none, (C,).
    share_of: name -> the control whose value its own is a share of, where there is one.
    """

    groups: Mapping[str, tuple[str, ...]]
    actions: Mapping[str, str]
    shares: Mapping[str, Array]
    floors: Mapping[str, Array]
    share_of: Mapping[str, str]


NO_LAYERS = Layers(*(MappingProxyType({}) for _ in range(5)))


def share_of_whole(value: float, whole: float) -> float:
    """How a value counts that is a share of another control's: 0 .. 1, and 0 where that is 0."""
    return min(value, max(whole, 0.0)) / max(whole, LEAST_WHOLE)


def read_layers(given: Sequence[Any], lowest: Sequence[str]) -> Layers:
    """Turn tables into shares of the lowest controls.

    given: from the bottom up, objects with `title`, `source` (what errors call the table: its file)
    and `rows`, {row: {key: value}}; lowest: names of the lowest controls.

    Raises ValueError that names file and row for a name that no layer below has, a share that is
    no number, a name that is taken, and a pair that names a side.
    """
    reader = _Reader(lowest)
    reader.add_both_sides()
    for layer in several("head.layers", given, ("title", "source", "rows")):
        if not isinstance(layer.rows, Mapping):
            raise ValueError(f"{layer.source}: was {quoted(layer.rows)}, must be a table of rows")
        below = dict(reader.shares)  # what a row of this layer may name
        names: list[str] = []
        for row, table in layer.rows.items():
            names += reader.row(f"{layer.source}, row '{row}'", str(row), table, below)
        reader.groups[str(layer.title)] = tuple(names)
    count = len(lowest)
    return Layers(
        MappingProxyType({title: names for title, names in reader.groups.items() if names}),
        MappingProxyType(reader.actions),
        MappingProxyType(dict(list(reader.shares.items())[count:])),
        MappingProxyType(dict(list(reader.floors.items())[count:])),
        MappingProxyType(reader.share_of),
    )


class _Reader:
    """Collects shares, layer by layer."""

    def __init__(self, lowest: Sequence[str]) -> None:
        self.shares: dict[str, Array] = dict(zip(lowest, np.eye(len(lowest)), strict=True))
        self.floors = {name: np.zeros(len(lowest)) for name in lowest}
        self.groups: dict[str, tuple[str, ...]] = {}
        self.actions: dict[str, str] = {}
        self.share_of: dict[str, str] = {}

    def add_both_sides(self) -> None:
        """The layer of names without side, each for both of its sides, or the one that there is."""
        sides: dict[str, list[Array]] = {}
        for name, share in self.shares.items():
            if name.endswith(SIDES):
                sides.setdefault(name.rpartition("_")[0], []).append(share)
        names = tuple(name for name in sides if name not in self.shares)
        for name in names:
            self.shares[name] = np.sum(sides[name], axis=0)
            self.floors[name] = np.zeros_like(self.shares[name])
            self.actions[name] = ""
        self.groups[BOTH_SIDES] = names

    def row(self, where: str, name: str, table: Any, below: Mapping[str, Array]) -> list[str]:
        """Take in one row; the names of the controls that it makes."""
        if not isinstance(table, Mapping):
            raise ValueError(f"{where}: was {quoted(table)}, must be a table of control = share")
        entries = dict(table)
        action, pair = entries.pop("action", ""), entries.pop("pair", False)
        whole, floors = entries.pop("share_of", None), entries.pop("at_least", {})
        mirror = entries.pop("mirror", None)
        if not isinstance(action, str):
            raise ValueError(f"{where}: 'action' was {quoted(action)}, must be a text")
        if not isinstance(pair, bool | str) or pair not in (False, *ENDINGS):
            allowed = 'true, false or "Left Right"'
            raise ValueError(f"{where}: 'pair' was {quoted(pair)}, must be {allowed}")
        if whole is not None:
            self._check_whole(where, whole)
        if not isinstance(floors, Mapping):
            allowed = "a table of control = share"
            raise ValueError(f"{where}: 'at_least' was {quoted(floors)}, must be {allowed}")
        if mirror is not None and (pair or mirror == name or not isinstance(mirror, str)):
            allowed = "another name, in a row that is no pair"
            raise ValueError(f"{where}: 'mirror' was {quoted(mirror)}, must be {allowed}")
        if pair:
            self._check_pair(where, name, (*entries, *floors))
        ends = zip(ENDINGS[pair], SIDES, strict=True) if pair else [("", "")]
        made = {name + end: self._sums(where, entries, floors, side, below) for end, side in ends}
        if pair is True:
            shares, least = zip(*made.values(), strict=True)
            made = {name: (np.sum(shares, axis=0), np.max(least, axis=0)), **made}
        if mirror is not None:
            made[mirror] = self._sums(where, _exchanged(entries), _exchanged(floors), "", below)
        for each, (share, floor) in made.items():
            if each in self.shares:
                raise ValueError(
                    f"{where}: there is a control called '{each}' already; rename the row"
                )
            self.shares[each], self.floors[each], self.actions[each] = share, floor, action
            if whole is not None:
                self.share_of[each] = whole
        return list(made)

    def _check_whole(self, where: str, whole: Any) -> None:
        """ValueError unless `share_of` names a control that has been read."""
        if not isinstance(whole, str):
            raise ValueError(
                f"{where}: 'share_of' was {quoted(whole)}, must be the name of a control"
            )
        if whole not in self.shares:
            raise ValueError(
                f"{where}, 'share_of': no row above and no layer below has a control called "
                f"'{whole}'{question(whole, self.shares)}"
            )

    def _check_pair(self, where: str, name: str, entries: Sequence[str]) -> None:
        """ValueError where a row for two sides names a side."""
        for side in (*SIDES, *ENDINGS["Left Right"]):
            if name.endswith(side):
                raise ValueError(f"{where}: a pair adds the sides by itself; leave '{side}' away")
        for control in entries:
            if control.endswith(SIDES):
                raise ValueError(f"{where}: in a pair leave the side of '{control}' away")

    def _sums(
        self,
        where: str,
        entries: Mapping[str, Any],
        floors: Mapping[str, Any],
        side: str,
        below: Mapping[str, Array],
    ) -> tuple[Array, Array]:
        """What a row adds and what it makes sure of, shape (C,) each; `side` of a pair, or "".

        A side takes its side of each entry. Of what has none it adds half, and makes sure of all.
        """
        share, floor = (np.zeros(len(next(iter(below.values()), ()))) for _ in range(2))
        for control, value in entries.items():
            part = number_within(f"{where}, '{control}'", value, -GREATEST_SHARE, GREATEST_SHARE)
            self._check_entry(where, control, below)
            sided = control + side
            share += part * (below[sided] if sided in below else 0.5 * below[control])
            floor = np.maximum(floor, part * self.floors[sided if sided in below else control])
        for control, value in floors.items():
            part = number_within(f"{where}, 'at_least', '{control}'", value, 0.0, GREATEST_SHARE)
            self._check_entry(where, control, below)
            floor = np.maximum(floor, part * below.get(control + side, below[control]))
        return share, floor

    def _check_entry(self, where: str, control: str, below: Mapping[str, Array]) -> None:
        """ValueError unless a layer below has the control, and it can be part of a row."""
        if control not in below:
            hint = question(control, below)
            raise ValueError(f"{where}: no layer below has a control called '{control}'{hint}")
        if control in self.share_of:
            raise ValueError(
                f"{where}, '{control}': is a share of '{self.share_of[control]}', which only a "
                "value that is set can be; name what it moves instead"
            )


def _exchanged(entries: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a row with left and right exchanged."""
    other = {**dict(zip(SIDES, SIDES[::-1], strict=True)), "": ""}
    result = {}
    for control, value in entries.items():
        side = next((side for side in SIDES if control.endswith(side)), "")
        result[control.removesuffix(side) + other[side]] = value
    return result
