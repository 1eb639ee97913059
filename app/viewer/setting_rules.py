"""Which values of remembered settings are of use: a rule for each."""

from __future__ import annotations

import math
import reprlib
import sys
from collections.abc import Callable, Collection
from typing import Any, get_type_hints

from risorius import render

from ..refining.looks import LOOKS, STATIC
from .interface.commands import chord

Rule = Callable[[Any], Any]  # gives back a value that is of use; ValueError or KeyError if not

LONGEST_NUMBER = 15  # [digits] of a whole number; Python refuses to read very long ones
SIDES = 200, 16384  # [screen units] of the window, least and most
SIDES_EXPORTED = 16, 8192  # [pixels] of what is exported
MOST_TOLD = 6  # of values that are of no use; a line has room for no more
FURTHEST = 1e6  # of any number that says where a camera is
ZOOMS = 0.6, 3.0  # least and most of the size of words
COMPARISONS = ("off", "wipe", "side by side", "A alone", "B alone")
CHOSEN = "as chosen above"  # what a side of a comparison shows, where it is no other look
SKINS = {  # whether it is textured, and its colour
    "textured": (True, render.SKIN),
    "plain": (False, render.SKIN),
    "clay": (False, render.CLAY),
}
OF_RENDER = ("light", "dark", "white", "black")
BACKGROUNDS = {"theme": None, **{name: getattr(render, name.upper()) for name in OF_RENDER}}
# Individual typology angles [degrees], see assets/identities/complexion.py; None: the person's own.
TONES = {"own": None, "very light": 61.0, "light": 48.0, "intermediate": 34.0}
TONES |= {"tan": 19.0, "brown": -10.0, "dark": -45.0}
TABS = ("Face", "Mechanism", "Live")


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
        accepted = {}
        for name, value in stored.items():
            rule = rule_of(name)
            if rule is None:  # of another version of the program
                continue
            try:
                accepted[name] = rule(value)
            except (ValueError, KeyError):
                self._found.append(f"{where}{name} = {reprlib.repr(value)}")
        return accepted


def whole_number(digits: str) -> float:
    """The number that is written so; NaN for one that is of no use anywhere."""
    return int(digits) if len(digits) <= LONGEST_NUMBER else math.nan


def number(least: float, most: float) -> Rule:
    """Any from the least to the most."""

    def rule(value: Any) -> float:
        """A finite number, neither on nor off."""
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (is_number and least <= value <= most):  # NaN is not
            raise ValueError
        return float(value)

    return rule


def one_of(allowed: Collection[str]) -> Rule:
    """One of the words `allowed`."""

    def rule(value: Any) -> str:
        """One of them."""
        if not (isinstance(value, str) and value in allowed):
            raise ValueError
        return value

    return rule


def several_of(allowed: Collection[str]) -> Rule:
    """A list of the words `allowed`."""
    one = one_of(allowed)
    return lambda value: [one(each) for each in _list(value)]


def _list(value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise ValueError
    return value


def anything(value: Any) -> Any:
    """A table, whose entries have rules of their own, or what has no rule."""
    return value


def rules_of(kind: type) -> dict[str, Rule]:
    """The rules that the fields of a dataclass are annotated with, by their names."""
    hints = get_type_hints(kind, include_extras=True)
    return {name: next(iter(getattr(hints[name], "__metadata__", ())), anything) for name in hints}


def flag(value: Any) -> bool:
    """On or off."""
    if not isinstance(value, bool):
        raise ValueError
    return value


def size(value: Any) -> tuple[int, int] | None:
    """Width and height of a window, or None."""
    if value is None:
        return None
    side = number(*SIDES)
    width, height = (int(side(each)) for each in _list(value))
    return width, height


def sides(value: Any) -> tuple[int, int]:
    """Width and height of what is exported [pixels]."""
    width, height = map(number(*SIDES_EXPORTED), _list(value))
    return int(width), int(height)


def folder(value: Any) -> str:
    """The name of one; "" for the present one."""
    if not isinstance(value, str) or "\0" in value:
        raise ValueError
    return value


def shortcut(value: Any) -> str:
    """A key of the keyboard, with its modifiers."""
    chord(str(value))
    return str(value)


def texts(value: Any) -> list[str]:
    """A list of any words."""
    return [str(each) for each in _list(value)]


def camera(value: Any) -> list[float]:
    """Yaw, pitch, distance, and the point it looks at."""
    place = [number(-FURTHEST, FURTHEST)(each) for each in _list(value)]
    if len(place) != 6:
        raise ValueError
    return place


def option(value: Any) -> Any:
    """A number, a word, on or off, or None for what suits; the refiner knows more about it."""
    if isinstance(value, str | bool) or value is None:
        return value
    finite = number(-sys.float_info.max, sys.float_info.max)(value)
    return value if isinstance(value, int) else finite


def refiners() -> Collection[str]:
    """Names of refiners; they are imported when somebody asks for them."""
    from risorius import refine

    return refine.available()


def refiner(value: Any) -> str | None:
    """The name of one, which is not the one that does nothing; None for that of the look."""
    if value is None:
        return None
    if value == STATIC:
        raise ValueError
    return one_of(refiners())(value)  # type: ignore[no-any-return]


def side(value: Any) -> str:
    """What a side of a comparison shows: what is chosen, a look, or a refiner."""
    return one_of((CHOSEN, *LOOKS, *refiners()))(value)  # type: ignore[no-any-return]


def table_of_refiner(name: str) -> Rule | None:
    """The options of a refiner, where there is one of this name."""
    return anything if name in refiners() else None
