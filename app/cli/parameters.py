"""Kinds of parameters of the command line: the size of a picture, a number that is one."""

from __future__ import annotations

import math
import re
from typing import Any

import click

LEAST, MOST = 16, 8192  # [pixels] of a side


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
