"""Surfaces to draw on."""

import os
import sys
from collections.abc import Iterator

import pytest

from risorius import render


@pytest.fixture
def surface() -> Iterator[render.Surface]:
    """A small square frame, with four samples per pixel."""
    with render.open_offscreen((96, 96)) as opened:
        yield opened


@pytest.fixture
def window() -> Iterator[render.WindowSurface]:
    """A small window, if there is a screen."""
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        pytest.skip("DISPLAY is not set: run the tests under `xvfb-run -a` to test windows, too")
    with render.open_window((96, 96), "test") as opened:
        yield opened


@pytest.fixture
def renderer(surface: render.Surface) -> render.Renderer:
    """A renderer for the small frame."""
    return render.Renderer(surface)
