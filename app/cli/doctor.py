"""`risorius doctor`: the commands that work on this machine, and the remedy for the others."""

from __future__ import annotations

import contextlib
import enum
import os
import platform
import subprocess
from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any

from risorius import __version__, render

from ..errors import UserError
from ..sound.decoding import ffmpeg
from ..text import in_one_line

VERSION_TIMEOUT = 20.0  # [s] for ffmpeg to report its version
MODULES_OF_EXTRAS = {
    "window": ("imgui_bundle", "glfw", "miniaudio"),
    "films": ("imageio_ffmpeg",),
    "live": ("pythonosc",),
    "export": ("h5py", "pxr"),
    "passes": ("OpenEXR",),
    "cluster": ("distributed",),
    "compression": ("DracoPy", "meshopt", "opengl_basisu"),
}
"""The modules that `pip install '.[EXTRA]'` installs."""
PARTS_OF_COMMANDS = {
    "view": ("window",),
    "replay": ("window",),
    "capture": ("offscreen",),
    "demo": ("offscreen", "films"),
    "dataset": ("offscreen",),
    "reproduce": ("offscreen",),
    "bench": ("offscreen",),
    "batch": (),
    "export": (),
    "rig": (),
    "convert": (),
    "send": (),
    "controls": (),
}
"""The parts that each command needs. Without films, `capture` still writes pictures."""


class Health(enum.IntEnum):
    """State of this installation; the values are exit codes."""

    WHOLE = 0
    PARTLY = 1  # it draws, but without windows, offscreen frames or films
    NOTHING = 2  # it cannot draw


def examine(*, offscreen_only: bool = False) -> tuple[Health, list[str]]:
    """Return the state of this installation, and the lines of the report.

    offscreen_only: test and report only offscreen frames.
    """
    found = {finding.name: finding for finding in render.probe(offscreen_only=offscreen_only)}
    system = f"{platform.system()} {platform.machine()}"
    lines = [f"Risorius {__version__}, Python {platform.python_version()}, {system}"]
    if not offscreen_only:
        try:
            from .. import viewer  # noqa: F401 - only whether it can be
        except UserError as error:
            found["window"] = render.Finding("window", is_ok=False, message=str(error))
    works = {name: finding.is_ok for name, finding in found.items()}
    lines += map(str, found.values())
    if not offscreen_only:
        works["films"], films = _films()
        lines += [_card(list(found.values())), films, _extras(), *_names(), _commands(works)]
    missing = [name for name, is_there in works.items() if not is_there]
    names = f"Missing: {', '.join(missing)}; the cure is in its line above."
    lines = [in_one_line(line) for line in (*lines, names if missing else "Everything is there.")]
    if not missing:
        return Health.WHOLE, lines
    draws = works["offscreen"] or works.get("window", False)
    return Health.PARTLY if draws else Health.NOTHING, lines


def _commands(works: Mapping[str, bool]) -> str:
    """Return a line with the commands that work with these parts, and with other commands."""
    able = [name for name, parts in PARTS_OF_COMMANDS.items() if all(works[each] for each in parts)]
    others = [name for name in PARTS_OF_COMMANDS if name not in able]
    there = ", ".join(able)
    return f"commands: {there} work; {', '.join(others)} do not" if others else "commands: all work"


def _card(findings: list[render.Finding]) -> str:
    """Return a line on the optional refiner `kahler-gl`, which needs OpenGL 4.3."""
    able = [each for each in findings if each.lends_gpu_streams]
    if not able:
        return "kahler-gl: no. It needs OpenGL 4.3; the refiner kahler does the same"
    ways = ", ".join(each.name for each in able)
    if all(each.is_software for each in able):
        return f"kahler-gl: yes ({ways}), by software, where the refiner kahler is faster"
    return f"kahler-gl: yes ({ways})"


def _names() -> list[str]:
    """Return lines with the names that options of refinement accept."""
    from risorius import refine  # slow, and not needed for offscreen frames

    known: dict[str, refine.Registry[Any]] = {
        "refiners": refine.refiners,
        "schemes": refine.schemes,
        "criteria": refine.criteria,
    }
    return [f"{kind}: {', '.join(each.available())}" for kind, each in known.items()]


def _extras() -> str:
    """Return a line with the installed extras, and the command to install missing extras."""
    missing = [
        name for name, modules in MODULES_OF_EXTRAS.items() if not all(map(_is_there, modules))
    ]
    there = ", ".join(name for name in MODULES_OF_EXTRAS if name not in missing) or "none"
    cure = (
        f"; for the others, in the checkout: pip install '.[{','.join(missing)}]'"
        if missing
        else ""
    )
    return f"extras: {there}{cure}"


def _is_there(module: str) -> bool:
    """Whether a module is installed; it is not imported."""
    with contextlib.suppress(ImportError):
        return find_spec(module) is not None
    return False


def _films() -> tuple[bool, str]:
    """Return whether ffmpeg works, and a line with its version or the remedy."""
    cure = "pip install --force-reinstall imageio-ffmpeg"
    if "IMAGEIO_FFMPEG_EXE" in os.environ:
        cure = "unset IMAGEIO_FFMPEG_EXE"
    try:
        said = subprocess.run(
            [ffmpeg(), "-version"],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=VERSION_TIMEOUT,
            check=True,
        )
    except (UserError, OSError, subprocess.SubprocessError) as error:
        return False, f"films: no. {error}. Cure: {cure}"
    return True, f"films: yes. {' '.join(said.stdout.split()[:3])}"
