"""Layers of controls: action units, expressions and visemes as plain tables into what lies below.

    muscles, jaw, gaze   <   both sides at once   <   action units   <   expressions   <   visemes

A layer is a table of rows; a row is a control of its own, named by its key. Each entry of a row is
a share: the row at 1 adds so much to the control that the entry names, which must stand in a layer
below. Two keys of a row are no entries: `action` says in words what it does, and `pair = true`
makes three controls of one row, for both sides, `..._left` and `..._right`:

    [AU4]
    action = "brow lowerer"
    pair = true
    corrugator_supercilii = 1.0     # a name without side is both sides; AU4_left takes the left
    procerus = 0.9                  # one in the middle: AU4_left takes half, so that left + right
                                    # is AU4

How layers combine: everything adds up, whatever was set first. A muscle's value is its own plus,
for each control above it, that control's value times its share, cut off at the muscle's limits
once, at the end.

Source: Ekman, Friesen, Hager 2002, "Facial Action Coding System" (what an action unit is); the
tables themselves are files of assets/.
Differs from FACS: units add, where some of theirs exclude each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from .checked import number_within, quoted, several
from .landmarks import Array
from .rig_reader import question

BOTH_SIDES = "Both sides"  # title of the layer that every face with paired muscles has
SIDES = ("_left", "_right")
GREATEST_SHARE = 2.0  # a share beyond it is a slip of the pen


@dataclass(frozen=True)
class Layers:
    """All controls above the lowest ones, with what each of them does to those.

    groups: title of the layer -> its names, from the lowest layer up.
    actions: name -> what it does, in words; "" where the table does not say.
    shares: name -> what it adds to each of the C lowest controls at value 1, shape (C,).
    """

    groups: Mapping[str, tuple[str, ...]]
    actions: Mapping[str, str]
    shares: Mapping[str, Array]


NO_LAYERS = Layers(MappingProxyType({}), MappingProxyType({}), MappingProxyType({}))


def read_layers(given: Sequence[Any], lowest: Sequence[str]) -> Layers:
    """Turn tables into shares of the lowest controls.

    given: from the bottom up, objects with `title`, `source` (what errors call the table: its file)
    and `rows`, {row: {key: value}}; lowest: names of the lowest controls.

    Raises ValueError that names file and row for a name that no layer below has, a share that is
    no number, a name that is taken, and a pair that names a side.
    """
    reader = _Reader(lowest)
    paired = [n.removesuffix("_left") for n in lowest if n.endswith("_left")]
    reader.add(BOTH_SIDES, (base for base in paired if f"{base}_right" in reader.shares))
    for layer in several("head.layers", given, ("title", "source", "rows")):
        if not isinstance(layer.rows, Mapping):
            raise ValueError(f"{layer.source}: was {quoted(layer.rows)}, must be a table of rows")
        below = reader.everything()
        names: list[str] = []
        for row, table in layer.rows.items():
            names += reader.row(f"{layer.source}, row '{row}'", str(row), table, below)
        reader.groups[str(layer.title)] = tuple(names)
    count = len(lowest)
    return Layers(
        MappingProxyType({title: names for title, names in reader.groups.items() if names}),
        MappingProxyType(reader.actions),
        MappingProxyType(dict(list(reader.shares.items())[count:])),
    )


class _Reader:
    """Collects shares, layer by layer."""

    def __init__(self, lowest: Sequence[str]) -> None:
        self.shares: dict[str, Array] = dict(zip(lowest, np.eye(len(lowest)), strict=True))
        self.groups: dict[str, tuple[str, ...]] = {}
        self.actions: dict[str, str] = {}

    def everything(self) -> dict[str, Array]:
        """The shares of all names so far: what a row of the next layer may name."""
        return dict(self.shares)

    def add(self, title: str, bases: Iterable[str]) -> None:
        """A layer of names without side, each for both of its sides."""
        names = tuple(base for base in bases if base not in self.shares)
        for name in names:
            self.shares[name] = self.shares[f"{name}_left"] + self.shares[f"{name}_right"]
            self.actions[name] = ""
        self.groups[title] = names

    def row(self, where: str, name: str, table: Any, below: Mapping[str, Array]) -> list[str]:
        """Take in one row; the names of the controls that it makes."""
        if not isinstance(table, Mapping):
            raise ValueError(f"{where}: was {quoted(table)}, must be a table of control = share")
        entries = dict(table)
        action, is_pair = entries.pop("action", ""), entries.pop("pair", False)
        if not isinstance(action, str):
            raise ValueError(f"{where}: 'action' was {quoted(action)}, must be a text")
        if not isinstance(is_pair, bool):
            raise ValueError(f"{where}: 'pair' was {quoted(is_pair)}, must be true or false")
        if is_pair and name.endswith(SIDES):
            raise ValueError(f"{where}: a pair adds the sides by itself; leave '_left' away")
        sides = SIDES if is_pair else ("",)
        names = [name + side for side in sides]
        for side, full in zip(sides, names, strict=True):
            self._new(where, full)
            share = np.zeros(len(next(iter(below.values()), ())))
            for control, value in entries.items():
                part = number_within(
                    f"{where}, '{control}'", value, -GREATEST_SHARE, GREATEST_SHARE
                )
                share += part * _side_of(where, control, side, below)
            self.shares[full] = share
            self.actions[full] = action
        if is_pair:
            self._new(where, name)
            self.shares[name] = self.shares[names[0]] + self.shares[names[1]]
            self.actions[name] = action
            names.insert(0, name)
        return names

    def _new(self, where: str, name: str) -> None:
        if name in self.shares:
            raise ValueError(f"{where}: there is a control called '{name}' already; rename the row")


def _side_of(where: str, control: str, side: str, below: Mapping[str, Array]) -> Array:
    """Shares of what an entry names; for a side of a pair, of that side or half of the middle."""
    if control not in below:
        raise ValueError(
            f"{where}: no layer below has a control called '{control}'{question(control, below)}"
        )
    if not side:
        return below[control]
    if control.endswith(SIDES):
        raise ValueError(f"{where}: in a pair leave the side of '{control}' away")
    if control + side in below:
        return below[control + side]
    return 0.5 * below[control]
