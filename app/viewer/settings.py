"""What the window remembers: its size, how things are shown, where the camera stood.

One JSON file in the user's configuration folder, replaced whole or not at all. A file that cannot
be read is as good as none: the window says so in one line and opens as it was first.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from ..outputs import written_aside

FILE_NAME = "viewer.json"


@dataclass
class Look:
    """How the scene is shown; the names are those that panels show."""

    refiner: str = "kahler"
    options: dict[str, dict[str, Any]] = field(default_factory=dict)  # by refiner
    is_refined: bool = True
    compare: str = "off"  # off, wipe, side by side
    divider: float = 0.5  # of the picture's width
    shading: str = "pixel"
    wireframe: bool = False
    colours: str = "none"  # a key of colours.COLOURS
    skin: str = "textured"  # textured, plain, clay
    occlusion: bool = True  # less light in folds; of textured skin
    wrinkles: float = 1.0  # how deep skin wrinkles where it is compressed, 0..1
    overlays: list[str] = field(default_factory=list)  # keys of overlays.OVERLAYS


@dataclass
class Settings:
    """Everything that is remembered."""

    size: tuple[int, int] | None = None  # of the window [screen units]
    theme: str = "light"
    zoom: float = 1.0  # of all words and sliders
    is_linked: bool = True  # sliders of both sides
    tab: str = "Face"
    panel_width: float = 22.5  # [letters' heights]
    folds: dict[str, bool] = field(default_factory=dict)  # which headings are open, by title
    cameras: dict[str, list[float]] = field(default_factory=dict)  # by scene
    look: Look = field(default_factory=Look)


def look_of(
    refiner: str,
    options: Mapping[str, float] | None,
    *,
    shading: str,
    wireframe: bool,
    splits: bool,
    skin: str,
    wrinkles: float,
) -> Look | None:
    """The look that the command line asks for; None where it asks for nothing: as it was last."""
    look = Look(shading=shading, wireframe=wireframe, skin=skin, wrinkles=wrinkles)
    look.colours = "splits" if splits else "none"
    if refiner == "none":
        look.is_refined = False
    else:
        look.refiner = refiner
    if options:
        look.options[refiner] = dict(options)
    return None if look == Look() else look


def settings_path() -> Path:
    """Where this system keeps a user's settings."""
    home = Path.home()
    if sys.platform == "win32":
        folder = Path(os.environ.get("APPDATA", home / "AppData" / "Roaming"))
    elif sys.platform == "darwin":
        folder = home / "Library" / "Application Support"
    else:
        folder = Path(os.environ.get("XDG_CONFIG_HOME") or home / ".config")
    return folder / "risorius" / FILE_NAME


def load_settings(path: Path) -> tuple[Settings, str]:
    """What is remembered, and a line to say where the file is there but of no use."""
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        look = _like(Look(), stored.pop("look", {}))
        settings = _like(Settings(), stored)
        settings.look = look
        settings.folds = {title: bool(is_open) for title, is_open in settings.folds.items()}
        if settings.size is not None:
            width, height = settings.size
            settings.size = int(width), int(height)
            if not all(200 <= side <= 16384 for side in settings.size):
                settings.size = None
        return settings, ""
    except FileNotFoundError:
        return Settings(), ""
    except (OSError, ValueError, TypeError, AttributeError) as error:
        return Settings(), f"{path}: not read, and written anew on closing ({error})"


def save_settings(path: Path, settings: Settings) -> None:
    """Write the file; UserError where that cannot be."""
    with written_aside(path) as part:
        part.write_text(json.dumps(asdict(settings), indent=1), encoding="utf-8")


def _like(default: Any, stored: Any) -> Any:
    """The default with the stored values that are of the same kind; anything else is passed by."""
    if not isinstance(stored, dict):
        raise ValueError("a table was expected")
    for entry in fields(default):
        value, known = stored.get(entry.name), getattr(default, entry.name)
        if value is None:
            continue
        if isinstance(known, float) and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if known is None or isinstance(value, type(known)):
            setattr(default, entry.name, value)
    return default
