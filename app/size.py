"""A parameter of the command line: the size of a picture."""

from __future__ import annotations

from typing import Any

import click


class Size(click.ParamType[tuple[int, int]]):
    """Width x height in pixels, written 1280x720."""

    name = "WxH"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Turn the text into two numbers, or fail with what is allowed."""
        if isinstance(value, tuple):
            return value
        width, separator, height = str(value).lower().partition("x")
        if separator and width.isdigit() and height.isdigit():
            size = (int(width), int(height))
            if all(16 <= side <= 8192 for side in size):
                return size
        self.fail(f"'{value}' is no size; write width x height, each 16 to 8192, as in 1280x720")
