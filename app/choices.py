"""What the command line's options stand for: a script, a refiner, a style."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

from risorius import refine, render
from risorius.assets.fitting import FittedHead, fit_head

from .errors import UserError
from .scenes import SCENES
from .script import Pose, Script, load_script

HELD = 1.0  # [s] that a pose of --set lasts


def script_for(path: Path | None, scene: str | None, settings: Sequence[str] = ()) -> Script:
    """The script at `path`, or the pose of `settings`, or the script that comes with the scene."""
    if settings and path is not None:
        raise UserError(f"{path}: a script and --set exclude each other")
    if path is None:
        path = Path(str(files("risorius.assets") / "scripts" / f"{scene or 'face'}.toml"))
    script = held_pose(settings) if settings else load_script(path)
    if scene is not None:
        script = replace(script, scene=scene)
    if script.scene not in SCENES:
        raise UserError(f"{path}: scene '{script.scene}'; allowed are {', '.join(SCENES)}")
    return script


def head_for(head: Path | None, landmarks: Path | None) -> FittedHead | None:
    """The head that somebody brought, fitted; None for the built-in one."""
    if head is None and landmarks is None:
        return None
    if head is None or landmarks is None:
        raise UserError("--head HEAD.obj and --landmarks LANDMARKS.json go together")
    return fit_head(head, landmarks)


def check_apart(outputs: Sequence[Path | None], inputs: Sequence[Path | None]) -> None:
    """UserError where two outputs are one file, or one would take the place of an input."""
    written: set[str] = set()
    read = {os.path.realpath(path) for path in inputs if path is not None}
    for path in outputs:
        if path is None:
            continue
        real = os.path.realpath(path)  # unlike `resolve` it bears links that lead to themselves
        if real in read:
            raise UserError(f"{path}: is read and would be written; choose another name")
        if real in written:
            raise UserError(f"{path}: is to be two outputs at once; choose another name for one")
        written.add(real)


def held_pose(settings: Sequence[str]) -> Script:
    """The script that `--set NAME=VALUE ...` stands for: one pose, held. A bare NAME is at 1."""
    values = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        try:
            value = float(text) if equals else 1.0
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise UserError(f"--set {setting}: '{text}' is no number; write NAME=VALUE")
        values[name] = value
    title = ", ".join(settings)
    return Script(title, duration=HELD, source="--set", poses=(Pose(0.0, values),))


def known_refiner(name: str) -> str:
    """The name of a registered refiner, or UserError with those that are."""
    if name not in refine.available():
        there_are = ", ".join(refine.available())
        raise UserError(f"refiner '{name}' is unknown; there are {there_are}")
    return name


def style_of(
    shading: str, wireframe: bool, splits: bool, skin: str, wrinkles: float
) -> render.Style:
    """The style that the drawing options ask for."""
    return render.Style(
        shading=render.Shading[shading.upper()],
        wireframe=wireframe,
        colour_by=render.ColourBy.SPLITS if splits else render.ColourBy.NONE,
        textured=skin == "textured",
        albedo=render.CLAY if skin == "clay" else render.SKIN,
        wrinkles=wrinkles,
    )
