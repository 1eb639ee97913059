"""The script that somebody asks for: a file, a pose that is held, or the one of the scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

from ..errors import UserError
from ..scenes import SCENES
from .model import Pose, Script
from .reader import load_script

HELD = 1.0  # [s] that a pose of --set lasts


def script_for(path: Path | None, scene: str | None, settings: Sequence[str] = ()) -> Script:
    """The script at `path`, or the pose of `settings`, or the script that comes with the scene."""
    if settings and path is not None:
        raise UserError(
            f"{path}: a script and --set exclude each other; "
            "every NAME=VALUE has a --set of its own"
        )
    if path is None:
        path = Path(str(files("risorius.assets") / "scripts" / f"{scene or 'face'}.toml"))
    script = held_pose(settings) if settings else load_script(path)
    if scene is not None:
        script = replace(script, scene=scene)
    if script.scene not in SCENES:
        raise UserError(f"{path}: scene '{script.scene}'; allowed are {', '.join(SCENES)}")
    return script


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
