"""Types of options: each converts command-line text to a value, or reports the allowed forms."""

from __future__ import annotations

import contextlib
import math
import re
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from risorius import render

PATH_TYPE = click.Path(path_type=Path)
SHORTEST_SIDE = 16  # [pixels]
LONGEST_SIDE = 8192  # [pixels]
BACKGROUND_NAMES = ("light", "dark", "white", "black")  # constants of `render`
HEAD_NAMES = ("ada", "kofi", "maria", "coarse")  # heads in `assets`, which is imported later


class Size(click.ParamType[tuple[int, int]]):
    """Width x height in pixels, written 1280x720."""

    name = "WxH"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Turn the text into two numbers, or fail with the allowed sizes."""
        if isinstance(value, tuple):
            return value
        written = re.fullmatch("([0-9]{1,6})x([0-9]{1,6})", str(value).lower())
        if written:
            size = (int(written[1]), int(written[2]))
            if all(SHORTEST_SIDE <= side <= LONGEST_SIDE for side in size):
                return size
        self.fail(
            f"'{value}' is not a size; write width x height, each {SHORTEST_SIDE} to "
            f"{LONGEST_SIDE}, as in 1280x720"
        )


MAP_BACKGROUND = "map"


class BackgroundName(click.ParamType["render.Background | str | None"]):
    """The background of the scene, by name or as a colour; None is transparent.

    The word "map" is returned as it is, because other options choose the light map.
    """

    name = "COLOUR"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> render.Background | str | None:
        """Look the name up, or fail with the allowed names."""
        import PIL.ImageColor

        from risorius import render

        word = str(value).lower()
        if word == "transparent":
            return None
        if word == MAP_BACKGROUND:
            return word
        if word in BACKGROUND_NAMES:
            named: render.Background = getattr(render, word.upper())
            return named
        try:
            red, green, blue = (part / 255.0 for part in PIL.ImageColor.getrgb(word)[:3])
        except ValueError:
            self.fail(
                f"'{value}' is not a background; write {', '.join(BACKGROUND_NAMES)}, "
                f"{MAP_BACKGROUND}, transparent, or a colour such as #00b140 or grey"
            )
        return render.Background((red, green, blue), (red, green, blue))


class Times(click.ParamType[tuple[float, ...]]):
    """A time [s], or two with a colon between them: 2.5, or 1:2.5."""

    name = "T|FROM:TO"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """Turn the text into one or two times [s], or fail with the allowed forms."""
        if isinstance(value, tuple):
            return value
        try:
            times = tuple(float(part) for part in str(value).split(":"))
        except ValueError:
            times = ()
        if len(times) not in (1, 2) or not all(0.0 <= each <= 86_400.0 for each in times):
            self.fail(f"'{value}' is not a time [s]; write 2.5, or 1:2.5 for a part", param, ctx)
        return times


class FiniteRange(click.FloatRange):
    """A number within limits; unlike its parent class it refuses NaN, and it reads 30000/1001."""

    name = "number"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Turn the text into a number, or fail with the limits."""
        if "/" in str(value):
            with contextlib.suppress(ValueError, ZeroDivisionError):
                value = Fraction(str(value))
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number", param, ctx)
        return number


class HeadName(click.ParamType["Path | int | str"]):
    """A head: a file, the number or name of a person, or the coarse head."""

    name = "FILE|NAME"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Path | int | str:
        """Return the number of a person, a name in HEAD_NAMES, or else a path.

        A name without a suffix is reported as a misspelt head if there is no such file.
        """
        if value in HEAD_NAMES:
            return str(value)
        if str(value).isdecimal():
            return click.IntRange(0, 2**53 - 1).convert(value, param, ctx)
        path: Path = PATH_TYPE.convert(value, param, ctx)
        if not path.suffix and not path.exists():
            known = ", ".join(HEAD_NAMES)
            allowed = f"give {known}, the number of a person, or a mesh such as anna.obj"
            self.fail(f"'{value}' is not a head; {allowed}", param, ctx)
        return path
