"""Programs that draw the figures of the documentation: what they are told, and what they write.

`python docs/figures/figures.py FILE.png ...` takes pictures of `risorius capture` and `risorius
reproduce` into docs/pictures.
"""

from __future__ import annotations

import argparse
import io
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import PIL.Image

from risorius.app.cli.parameters import LEAST, MOST
from risorius.app.errors import UserError, report_user_errors
from risorius.app.files import Image, check_file, written_atomically
from risorius.app.stopping import handle_signals

Figure = Callable[[], Image]
FOLDER = Path("docs/pictures")
QUALITY = 96  # of 100: no difference is seen at full size
LARGER = 1.5  # times, that a picture without any loss may be: line art is smaller so


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
    """Draw each figure into NAME.webp in the folder, which is looked at before one is drawn."""
    for name in figures:
        check_file(folder / f"{name}.webp")
    for name, figure in figures.items():
        target = folder / f"{name}.webp"
        packed = webp(figure())
        with written_atomically(target) as part:
            part.write_bytes(packed)


def webp(image: Image) -> bytes:
    """A picture as WebP: without loss where that is not much larger."""
    exact, near = io.BytesIO(), io.BytesIO()
    page = PIL.Image.fromarray(image)
    page.save(exact, "WEBP", lossless=True, quality=80)
    page.save(near, "WEBP", quality=QUALITY)
    is_exact = exact.tell() <= LARGER * near.tell()
    return (exact if is_exact else near).getvalue()


def read(file: Path) -> Image:
    """A picture without its alpha."""
    return np.asarray(PIL.Image.open(file).convert("RGB"))


def run(main: Callable[[Sequence[str]], None]) -> None:
    """Run a program by the rules of the command: mistakes are one line, signals are heard."""
    handle_signals()
    with report_user_errors():
        main(sys.argv[1:])


def _take(arguments: Sequence[str]) -> None:
    files = [Path(argument) for argument in arguments]
    draw(FOLDER, {file.stem: partial(read, file) for file in files})


if __name__ == "__main__":
    run(_take)
