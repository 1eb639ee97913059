"""Which values of remembered settings are of use: a rule for each."""

from __future__ import annotations

import math
import reprlib
import sys
from collections.abc import Callable, Collection
from typing import Any

from risorius import refine, render

from .colours import COLOURS
from .gui import THEMES
from .overlays import OVERLAYS

Rule = Callable[[Any], Any]  # gives back a value that is of use; ValueError for one that is not

LONGEST_NUMBER = 15  # [digits] of a whole number; Python refuses to read very long ones
SIDES = 200, 16384  # [screen units] of the window, least and most
MOST_TOLD = 6  # of values that are of no use; a line has room for no more
FURTHEST = 1e6  # of any number that says where a camera is
ZOOMS = 0.6, 3.0  # least and most of the size of words
COMPARISONS = ("off", "wipe", "side by side")
SKINS = {  # whether it is textured, and its colour
    "textured": (True, render.SKIN),
    "plain": (False, render.SKIN),
    "clay": (False, render.CLAY),
}
TABS = ("Face", "Mechanism")


class Refused:
    """Takes what is of use out of stored tables, and gathers words for what is not."""

    def __init__(self) -> None:
        self._found: list[str] = []

    def __str__(self) -> str:
        more = len(self._found) - MOST_TOLD
        return ", ".join([*self._found[:MOST_TOLD], *([f"{more} more"] if more > 0 else [])])

    def table(self, where: str, stored: Any, rule_of: Callable[[str], Rule | None]) -> Any:
        """The entries of a table that their rules accept; what has no rule is passed by."""
        if not isinstance(stored, dict):
            self._found.append(f"{where.rstrip('.') or 'all'} = {reprlib.repr(stored)}")
            return {}
        kept = {}
        for name, value in stored.items():
            rule = rule_of(name)
            if rule is None:  # of another version of the program
                continue
            try:
                kept[name] = rule(value)
            except ValueError:
                self._found.append(f"{where}{name} = {reprlib.repr(value)}")
        return kept


def whole_number(digits: str) -> float:
    """The number that is written so; NaN for one that is of no use anywhere."""
    return int(digits) if len(digits) <= LONGEST_NUMBER else math.nan


def _number(least: float, most: float) -> Rule:
    def rule(value: Any) -> float:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (is_number and least <= value <= most):  # NaN is not
            raise ValueError
        return float(value)

    return rule


def _one_of(words: Collection[str]) -> Rule:
    def rule(value: Any) -> str:
        if not (isinstance(value, str) and value in words):
            raise ValueError
        return value

    return rule


def _several_of(words: Collection[str]) -> Rule:
    one = _one_of(words)
    return lambda value: [one(each) for each in _list(value)]


def _list(value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise ValueError
    return value


def flag(value: Any) -> bool:
    """On or off."""
    if not isinstance(value, bool):
        raise ValueError
    return value


def _any(value: Any) -> Any:
    """A table, whose entries have rules of their own."""
    return value


def _size(value: Any) -> tuple[int, int] | None:
    if value is None:
        return None
    side = _number(*SIDES)
    width, height = (int(side(each)) for each in _list(value))
    return width, height


def camera(value: Any) -> list[float]:
    """Yaw, pitch, distance, and the point it looks at."""
    place = [_number(-FURTHEST, FURTHEST)(each) for each in _list(value)]
    if len(place) != 6:
        raise ValueError
    return place


def option(value: Any) -> Any:
    """A number, a word, on or off, or None for what suits; the refiner knows more about it."""
    if isinstance(value, str | bool) or value is None:
        return value
    finite = _number(-sys.float_info.max, sys.float_info.max)(value)
    return value if isinstance(value, int) else finite


def _refiner(value: Any) -> str:
    if value not in refine.available() or value == "none":
        raise ValueError
    return str(value)


def table_of_refiner(name: str) -> Rule | None:
    """The options of a refiner, where there is one of this name."""
    return _any if name in refine.available() else None


LOOK: dict[str, Rule] = {
    "refiner": _refiner,
    "options": _any,
    "is_refined": flag,
    "compare": _one_of(COMPARISONS),
    "divider": _number(0.0, 1.0),
    "shading": _one_of([shading.value for shading in render.Shading]),
    "wireframe": flag,
    "colours": _one_of(COLOURS),
    "skin": _one_of(SKINS),
    "occlusion": flag,
    "wrinkles": _number(0.0, 1.0),
    "overlays": _several_of(OVERLAYS),
}
SETTINGS: dict[str, Rule] = {
    "size": _size,
    "theme": _one_of(THEMES),
    "zoom": _number(*ZOOMS),
    "is_linked": flag,
    "tab": _one_of(TABS),
    "panel_width": _number(0.0, 1000.0),  # [letters' heights]; layout.py has the limits of a screen
    "folds": _any,
    "cameras": _any,
    "look": _any,
}
