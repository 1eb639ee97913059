"""`risorius doctor`: what this machine has, what it lacks, and what works here because of that."""

from __future__ import annotations

import contextlib
import enum
import os
import platform
import subprocess
from importlib.util import find_spec
from typing import Any

from risorius import __version__, render

from .. import ffmpeg
from ..errors import UserError, in_one_line

PATIENCE = 20.0  # [s] for ffmpeg to say which it is
EXTRAS = {
    "window": ("imgui_bundle", "glfw", "miniaudio"),
    "films": ("imageio_ffmpeg",),
    "live": ("pythonosc",),
    "export": ("h5py", "pxr"),
    "passes": ("OpenEXR",),
    "cluster": ("distributed",),
}
"""What `pip install 'risorius[EXTRA]'` brings, as modules."""


class Health(enum.IntEnum):
    """What works here; the values are exit codes."""

    WHOLE = 0
    PARTLY = 1  # it draws, but has no window, no offscreen frames or no films
    NOTHING = 2  # it cannot draw


def examine(*, offscreen_only: bool = False) -> tuple[Health, list[str]]:
    """Return what works here, and the lines of the report.

    offscreen_only: ask for offscreen frames alone, and report on nothing else.
    """
    found = {finding.name: finding for finding in render.probe(offscreen_only=offscreen_only)}
    if not offscreen_only:
        try:
            from .. import viewer  # noqa: F401 - only whether it can be
        except UserError as error:
            found["window"] = render.Finding("window", is_ok=False, message=str(error))
    works = {name: finding.is_ok for name, finding in found.items()}
    lines = [
        f"Risorius {__version__}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}",
        *map(str, found.values()),
    ]
    if not offscreen_only:
        works["films"], answer = _films()
        sound = _sound()
        lines += [f"films: {answer}", f"sound: {sound}", _extras(), *_names()]
        rest = "but a device for sound" if sound.startswith("no") else ""
    else:
        rest = "for offscreen frames; nothing else was looked at"
    lines = [in_one_line(line) for line in lines + _verdicts(works, rest)]
    if all(works.values()):
        return Health.WHOLE, lines
    draws = works["offscreen"] or works.get("window", False)
    return Health.PARTLY if draws else Health.NOTHING, lines


def _verdicts(works: dict[str, bool], rest: str) -> list[str]:
    """A line for each command: whether it works; rest: what "everything" leaves out."""
    if not works["offscreen"]:
        frames = "no: needs offscreen"
    elif works.get("films", True):
        frames = "works"
    else:
        frames = "works for pictures and folders of frames; films need ffmpeg"
    verdicts = [f"capture, demo, reproduce: {frames}"]
    if "window" in works:
        verdicts.append(f"view, replay: {'works' if works['window'] else 'no: needs a window'}")
    missing = [name for name, is_there in works.items() if not is_there]
    verdicts.append(
        f"Missing: {', '.join(missing)}; the cure is in its line above."
        if missing
        else f"Everything is there {rest}".rstrip() + "."
    )
    return verdicts


def _names() -> list[str]:
    """What can be named in options of refinement, and what of it cannot be loaded."""
    from risorius import refine  # slow, and not needed for offscreen frames alone

    known: dict[str, refine.Registry[Any]] = {
        "refiners": refine.refiners,
        "schemes": refine.schemes,
        "criteria": refine.criteria,
    }
    lines = [f"{kind}: {', '.join(each.available())}" for kind, each in known.items()]
    for each in known.values():
        for name in each.installed():
            try:
                each.find(name)
            except ValueError as error:
                lines.append(str(error))
    return lines


def _extras() -> str:
    """Which extras are installed, and what installs the others."""

    def is_there(module: str) -> bool:
        """Whether it could be imported; that is not tried."""
        with contextlib.suppress(ImportError):
            return find_spec(module) is not None
        return False

    missing = [name for name, modules in EXTRAS.items() if not all(map(is_there, modules))]
    there = ", ".join(name for name in EXTRAS if name not in missing) or "none"
    cure = f"; for the others: pip install 'risorius[{','.join(missing)}]'" if missing else ""
    return f"extras: {there}{cure}"


def _sound() -> str:
    """Whether the window can be heard; nothing is missing where it cannot."""
    from ..sound.player import NoDeviceError, open_device

    try:
        device = open_device(ffmpeg.RATE, 2)
    except NoDeviceError as error:
        return f"no. {error}; the window is silent, films have their sound"
    name = str(device.backend)
    device.close()
    return f"yes. miniaudio, {name}"


def _films() -> tuple[bool, str]:
    """Whether there is an ffmpeg that answers, and which, or the cure."""
    is_named = "IMAGEIO_FFMPEG_EXE" in os.environ
    mend = (
        "unset IMAGEIO_FFMPEG_EXE" if is_named else "pip install --force-reinstall imageio-ffmpeg"
    )
    cure = f"Cure: {mend}"
    try:
        program = ffmpeg.program()
        said = subprocess.run(
            [program, "-version"],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=PATIENCE,
            check=True,
        ).stdout
    except UserError as error:
        return False, f"no. {error}" if "pip install" in str(error) else f"no. {error}. {cure}"
    except subprocess.TimeoutExpired:
        return False, f"no. {program} did not answer within {PATIENCE:g} s. {cure}"
    except (OSError, subprocess.CalledProcessError) as error:
        return False, f"no. {program} does not run ({error}). {cure}"
    return True, f"yes. {' '.join(said.split()[:3])}"
