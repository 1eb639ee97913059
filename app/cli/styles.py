"""The options `--style` and `--anatomy`: words and NAME=VALUE, separated by commas."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..errors import UserError

STRUCTURE_NAMES = ("muscles", "skull")  # a copy of anatomy.STRUCTURES, which is imported later
# A copy of the names in render.LIGHTS, which is imported later.
LIGHT_NAMES = ("studio", "side", "overcast", "window", "hard", "clouds", "room", "street")
LIGHT_SUFFIXES = (".hdr", ".exr")  # a copy of light_maps.LIGHT_SUFFIXES, which is imported later
SKIN_NAMES = ("textured", "plain", "clay")
SIDE_NAMES = ("both", "left", "right")


@dataclass(frozen=True)
class Words:
    """The words that an option may hold.

    flags: single words. choices: the words that each name takes as NAME=WORD. fractions: the names
    that take a number from 0 to 1 as NAME=x. file_kinds: the suffixes of files that a name in
    `choices` also takes, as NAME=FILE.
    """

    option: str
    flags: tuple[str, ...]
    choices: Mapping[str, tuple[str, ...]]
    fractions: tuple[str, ...]
    file_kinds: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def read(self, settings: Sequence[str]) -> dict[str, Any]:
        """Return the value of each name that is set: True for a flag, a Path for a file.

        Raises UserError for any other word.
        """
        values: dict[str, Any] = {}
        for word in ",".join(settings).split(",") if settings else ():
            name, equals, text = word.partition("=")
            if name in self.flags and not equals:
                values[name] = True
            elif name in self.choices:
                values[name] = self._choice(name, text)
            elif name in self.fractions:
                values[name] = self._fraction(name, text)
            else:
                raise UserError(f"{self.option}: '{word}' is unknown; allowed are {self.allowed}")
        return values

    @property
    def allowed(self) -> str:
        """All allowed words, for messages."""
        named = []
        for name, words in self.choices.items():
            files = [f"FILE{suffix}" for suffix in self.file_kinds.get(name, ())]
            named.append(f"{name}={'|'.join([*words, *files])}")
        numbers = [f"{name}=0..1" for name in self.fractions]
        return ", ".join([*self.flags, *named, *numbers])

    def _choice(self, name: str, text: str) -> str | Path:
        if text in self.choices[name]:
            return text
        suffixes = self.file_kinds.get(name, ())
        if Path(text).suffix.lower() in suffixes:
            return Path(text)
        words = ", ".join(self.choices[name])
        files = f", and no file {' or '.join(suffixes)}" if suffixes else ""
        raise UserError(f"{self.option} {name}={text}: '{text}' is none of {words}{files}")

    def _fraction(self, name: str, text: str) -> float:
        try:
            fraction = float(text)
        except ValueError:
            fraction = math.nan
        if not 0.0 <= fraction <= 1.0:
            raise UserError(f"{self.option} {name}={text}: write a number from 0 to 1")
        return fraction


STYLE_WORDS = Words(
    "--style",
    ("wireframe", "splits", "wires"),
    {"skin": SKIN_NAMES, "light": LIGHT_NAMES},
    ("wrinkles",),
    {"light": LIGHT_SUFFIXES},
)
ANATOMY_WORDS = Words("--anatomy", STRUCTURE_NAMES, {"dissect": SIDE_NAMES}, ("opacity",))


def style_in(settings: Sequence[str]) -> dict[str, Any]:
    """Return all settings of style by name, with defaults for settings that are not set."""
    usual = {
        "skin": "textured",
        "light": "studio",
        "wrinkles": 1.0,
        "wireframe": False,
        "splits": False,
        "wires": False,
    }
    return usual | STYLE_WORDS.read(settings)


def anatomy_in(text: str) -> tuple[tuple[str, ...], float | None, str]:
    """Return the structures that `--anatomy` shows, the skin's opacity or None, and the side."""
    values = ANATOMY_WORDS.read([text])
    structures = tuple(name for name in STRUCTURE_NAMES if name in values)
    return structures or STRUCTURE_NAMES, values.get("opacity"), values.get("dissect", "both")
