"""Scripts to play: from a script file, a recording, a pose, or the built-in script of a scene."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from .control_names.limits import Limits
from .errors import UserError
from .playback import Playback
from .scenes import SCENES, controls_of
from .script import POSE_SECONDS, Pose, Script
from .script.script_file import load_script

if TYPE_CHECKING:
    from .recordings.report import Report


def script_for(
    path: Path | None,
    scene: str | None,
    settings: Sequence[str] = (),
    *,
    playback: Playback | None = None,
    on_report: Callable[[Report], None] | None = None,
) -> Script:
    """Return the script of the file `path`, of the pose `settings`, or else of the scene.

    playback: options for a recording. on_report: function that gets the report of a recording.
    """
    playback = playback or Playback()
    if settings and path is not None:
        raise UserError(
            f"{path}: a script and --set exclude each other; write --set before every NAME=VALUE"
        )
    if path is None:
        if playback != Playback():
            raise UserError(
                f"{options_in(playback)} needs a recording; add one, or leave the option out"
            )
        own = Path(str(files("risorius.assets") / "scripts" / f"{scene or 'face'}.toml"))
        script = held_pose(settings) if settings else load_script(own)
    else:
        script, report = read_performance(path, playback)
        if report is not None and on_report is not None:
            on_report(report)
    if scene is not None:
        script = replace(script, scene=scene)
    if script.scene not in SCENES:
        raise UserError(f"{path}: scene '{script.scene}'; allowed are {', '.join(SCENES)}")
    return script


def built_in_words() -> Script:
    """Return the built-in script of a few spoken words."""
    return load_script(Path(str(files("risorius.assets") / "scripts" / "speech.toml")))


def new_script(
    scene: str = "face", camera: str | None = None, values: Mapping[str, float] | None = None
) -> Script:
    """Return a script of one pose, to which keys can be added; without values it is neutral."""
    nonzero = {name: value for name, value in (values or {}).items() if value}
    duration = 4.0  # [s]
    poses = (Pose(0.0, nonzero),)
    return Script("", duration, "a new script", scene, camera, poses=poses)


def examples(scene: str) -> list[Path]:
    """Return the paths of the built-in scripts of a scene."""
    folder = Path(str(files("risorius.assets") / "scripts"))
    return [path for path in sorted(folder.glob("*.toml")) if load_script(path).scene == scene]


def read_performance(
    path: Path, playback: Playback | None = None, limits: Limits | None = None
) -> tuple[Script, Report | None]:
    """Read a script, or convert a recording to a script; return it with the recording's report.

    limits: limits of the face's controls; None takes those of the built-in face. Raises UserError
    for a file that is neither, and if a script comes with options for recordings.
    """
    playback = playback or Playback()
    if path.suffix.lower() != ".toml":
        from .recordings.conversion import script_of
        from .recordings.reading import read_take

        take = read_take(path, face=playback.face, rate=playback.rate)
        return script_of(take, playback, limits or limits_of("face"))
    script = load_script(path)
    if playback != Playback():
        raise UserError(f"{path}: is a script, but {options_in(playback)} needs a recording")
    return script, None


def options_in(playback: Playback) -> str:
    """Return the command-line name of the first option that differs from its default."""
    usual = Playback()
    first = next(
        field.name
        for field in fields(playback)
        if getattr(playback, field.name) != getattr(usual, field.name)
    )
    return f"--{first.removesuffix('s')}"


@functools.cache
def limits_of(scene: str) -> Limits:
    """Return the lowest and highest value of each control of a scene, by the scene's name."""
    return controls_of(scene).limits


def held_pose(settings: Sequence[str]) -> Script:
    """Return the script of `--set NAME=VALUE ...`, which holds one pose; a bare NAME means 1."""
    values = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        try:
            value = float(text) if equals else 1.0
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise UserError(f"--set {setting}: '{text}' is not a number; write NAME=VALUE")
        values[name] = value
    title = ", ".join(settings)
    return Script(title, duration=POSE_SECONDS, source="--set", poses=(Pose(0.0, values),))
