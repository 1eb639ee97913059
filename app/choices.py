"""What the command line's options stand for: a script, a refiner, a style."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import refine
import render

from .errors import UserError
from .scenes import SCENES
from .script import Script, load_script


def script_for(path: Path | None, scene: str | None) -> Script:
    """The script at `path`, or the one that comes with the scene."""
    if path is None:
        path = Path(str(files("assets") / "scripts" / f"{scene or 'face'}.toml"))
    script = load_script(path)
    if scene is not None:
        script = replace(script, scene=scene)
    if script.scene not in SCENES:
        raise UserError(f"{path}: scene '{script.scene}'; allowed are {', '.join(SCENES)}")
    return script


def known_refiner(name: str) -> str:
    """The name of a registered refiner, or UserError with those that are."""
    if name not in refine.available():
        raise UserError(f"refiner '{name}'; available are {', '.join(refine.available())}")
    return name


def threshold_options(
    refiner: str, thresholds: tuple[float, float] | None
) -> dict[str, float] | None:
    """The refiner's options that --thresholds stands for; None where it was not given."""
    if not thresholds:
        return None
    if refiner != "kahler":
        raise UserError(f"--thresholds goes with --refiner kahler, not with '{refiner}'")
    once, twice = thresholds
    if once > twice:
        raise UserError(f"--thresholds {once:g} {twice:g}: the first must not be above the second")
    return {"threshold_once": once, "threshold_twice": twice}


def style_of(shading: str, wireframe: bool, splits: bool, skin: str) -> render.Style:
    """The style that the drawing options ask for."""
    return render.Style(
        shading=render.Shading[shading.upper()],
        wireframe=wireframe,
        colour_by=render.ColourBy.SPLITS if splits else render.ColourBy.NONE,
        textured=skin == "textured",
        albedo=render.CLAY if skin == "clay" else render.SKIN,
    )
