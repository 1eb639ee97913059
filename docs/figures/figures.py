"""Programs that draw the figures of the documentation: what they are told, and what they write."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from risorius.app.cli.parameters import LEAST, MOST
from risorius.app.errors import UserError, told_in_one_line
from risorius.app.files import Image, check_png, save_png
from risorius.app.stopping import handle_signals

Figure = Callable[[], Image]
FOLDER = Path("docs/pictures")


def parse(arguments: Sequence[str], about: str | None, *, width: int = 0) -> argparse.Namespace:
    """Read `folder` and `only` from the command line, and `width` where there is one to choose."""
    parser = argparse.ArgumentParser(description=(about or "").partition("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    parser.add_argument("--only", nargs="+", metavar="NAME", default=[], help="these alone")
    if width:
        parser.add_argument("--width", type=_pixels, default=width, help="of a picture in it")
    return parser.parse_args(arguments)


def _pixels(text: str) -> int:
    if text.isdecimal() and LEAST <= int(text) <= MOST:
        return int(text)
    raise argparse.ArgumentTypeError(f"'{text}' is no width; write {LEAST} to {MOST} pixels")


def chosen(figures: Mapping[str, Figure], only: Sequence[str]) -> dict[str, Figure]:
    """Those of `figures` that are named, or all of them; UserError for an unknown name."""
    for name in only:
        if name not in figures:
            raise UserError(f"unknown figure '{name}'; there are {', '.join(figures)}")
    return {name: figures[name] for name in only or figures}


def draw(folder: Path, figures: Mapping[str, Figure]) -> None:
    """Draw each figure into NAME.png in the folder, which is looked at before anything is drawn."""
    for name in figures:
        check_png(folder / f"{name}.png")
    for name, figure in figures.items():
        save_png(folder / f"{name}.png", figure(), is_small=True)


def run(main: Callable[[Sequence[str]], None]) -> None:
    """Run a program by the rules of the command: mistakes are one line, signals are heard."""
    handle_signals()
    with told_in_one_line():
        main(sys.argv[1:])
