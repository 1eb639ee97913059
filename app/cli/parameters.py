"""Kinds of parameters of the command line: sizes of pictures, numbers, names."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from risorius import render

LEAST, MOST = 16, 8192  # [pixels] of a side
BACKGROUNDS = ("light", "dark", "white", "black")  # of `render`
PERSON_NAMES = ("ada", "kofi", "maria")  # of `assets.identities`, which is not imported yet


class Size(click.ParamType[tuple[int, int]]):
    """Width x height in pixels, written 1280x720."""

    name = "WxH"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Turn the text into two numbers, or fail with what is allowed."""
        if isinstance(value, tuple):
            return value
        written = re.fullmatch("([0-9]{1,6})x([0-9]{1,6})", str(value).lower())
        if written:
            size = (int(written[1]), int(written[2]))
            if all(LEAST <= side <= MOST for side in size):
                return size
        self.fail(
            f"'{value}' is no size; write width x height, each {LEAST} to {MOST}, as in 1280x720"
        )


class BackgroundName(click.ParamType["render.Background | None"]):
    """What is behind the scene, by name or as a colour; None where nothing is."""

    name = "COLOUR"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> render.Background | None:
        """Look the name up, or fail with what is allowed."""
        from risorius import render

        word = str(value).lower()
        if word == "transparent":
            return None
        if word in BACKGROUNDS:
            named: render.Background = getattr(render, word.upper())
            return named
        if re.fullmatch("#[0-9a-f]{6}", word):
            red, green, blue = (part / 255.0 for part in bytes.fromhex(word[1:]))
            return render.Background((red, green, blue), (red, green, blue))
        self.fail(
            f"'{value}' is no background; take {', '.join(BACKGROUNDS)}, transparent, or a colour "
            "as #00b140"
        )


class FiniteRange(click.FloatRange):
    """A number within limits; unlike its parent it lets no NaN through."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Turn the text into a number, or fail with what is allowed."""
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number", param, ctx)
        return number


class PersonName(click.ParamType[int | str]):
    """A person's number or name."""

    name = "NUMBER|NAME"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> int | str:
        """The number, or the name as it is."""
        if value in PERSON_NAMES:
            return str(value)
        if not str(value).isdecimal():
            names = ", ".join(PERSON_NAMES)
            self.fail(f"'{value}' is nobody; write a number, 0 or more, or {names}", param, ctx)
        return click.IntRange(0, 2**32 - 1).convert(value, param, ctx)
