"""What can be chosen in the window, by the names that panels show and settings keep."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from risorius import render
from risorius.schema import MadeFrom, OneOf, Record, Within, parsed_json, quoted

from ..files import read_text
from .interface.gui import THEMES

LONGEST_FILE = 2**20  # [bytes] of settings; those that we write have two thousand
SIDES = 200, 16384  # [screen units] of the window, least and most
SIDES_EXPORTED = 16, 8192  # [pixels] of what is exported
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


def _folder(name: str) -> str:
    if "\0" in name:
        raise ValueError(f"was {name!r}, must be the name of a folder")
    return name


def _option(value: Any) -> Any:
    is_number = isinstance(value, int | float)
    if is_number and abs(value) <= sys.float_info.max:
        return value
    if is_number or not isinstance(value, str | None):
        raise ValueError(f"was {quoted(value)}, must be a number, a text, true or false")
    return value


_Pair = Annotated[tuple[int, int], Within(*SIDES)]
_Place = Annotated[tuple[float, float, float, float, float, float], Within(-FURTHEST, FURTHEST)]
Size = Annotated[tuple[int, int] | None, MadeFrom(_Pair, tuple)]
Camera = Annotated[list[float], MadeFrom(_Place, list)]  # yaw, pitch, distance, target
Folder = Annotated[str, MadeFrom(str, _folder)]
Share = Annotated[float, Within(0.0, 1.0)]
# Of a refiner, which knows more about it.
Option = Annotated[Any, MadeFrom(Any, _option)]


@dataclass
class WindowSettings(Record):
    """What of the settings is needed before anything else is there."""

    size: Size = None  # of the window [screen units]
    theme: Annotated[str, OneOf(THEMES)] = "light"
    zoom: Annotated[float, Within(*ZOOMS)] = 1.0  # of all words and sliders


def stored_settings(path: Path) -> Any:
    """What the file has; UserError, OSError or ValueError where it is none."""
    return parsed_json(read_text(path, what="file of settings", longest=LONGEST_FILE))
