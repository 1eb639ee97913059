"""Scripts and poses back into TOML files; what is written reads back as the same script.

Tracks of a few keys are written as tables, which explain themselves, those of more keys as lines,
which are short and quickly read.

A pose by itself is a script with one [[pose]] at time 0.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
from collections.abc import Mapping
from pathlib import Path

from ..errors import UserError
from ..files import save_text
from .model import LONGEST_FILE, Channel, Pose, Script, rounded

_BARE = re.compile(r"[A-Za-z0-9_-]+")
MOST_TABLES = 24  # keys of a track that are written as tables; those of more as lines
POSE_SECONDS = 1.0  # duration of a script that is one pose


def save_script(target: Path, script: Script) -> None:
    """Write a script file, whole or not at all; UserError where it cannot be written."""
    text = script_text(script, target.parent)
    if len(text) > LONGEST_FILE:
        raise UserError(
            f"{target}: the script would be longer than can be read again, "
            f"{LONGEST_FILE >> 20} MB; leave out some keys"
        )
    save_text(target, text)


def script_text(script: Script, folder: Path | None = None) -> str:
    """The TOML text of a script; folder: where it will be, for what it names beside it."""
    head = [script.preface] if script.preface else []
    if script.title:  # else it is called as its file is
        head.append(f"title = {_quoted(script.title)}")
    head.append(f"scene = {_quoted(script.scene)}")
    if script.camera is not None:
        head.append(f"camera = {_quoted(script.camera)}")
    if script.sound is not None:
        head.append(f"sound = {_quoted(_as_seen_from(folder, script.sound))}")
    head.append(f"duration = {_number(script.duration)}")
    blocks = ["\n".join(head), *map(_pose, script.poses)]
    if script.tracks:
        tracks = [_track(name, channel) for name, channel in script.tracks.items()]
        blocks.append("\n".join(["[tracks]", *tracks]))
    return "\n\n".join(blocks) + "\n"


def pose_script(values: Mapping[str, float], *, title: str, scene: str) -> Script:
    """A script that is nothing but one pose; what is 0 is left out."""
    pose = Pose(0.0, {name: rounded(value) for name, value in values.items() if rounded(value)})
    return Script(title, POSE_SECONDS, source=title, scene=scene, poses=(pose,))


def is_pose(script: Script) -> bool:
    """Whether a script holds one pose and no motion."""
    is_still = all(len(channel) == 1 for channel in script.tracks.values())
    is_something = bool(script.posed_names or script.tracks)
    return is_something and is_still and len(script.poses) <= 1


def _as_seen_from(folder: Path | None, file: Path) -> str:
    """How a script in `folder` names a file, so that both may move together.

    By its whole path where it is neither in the folder nor near it: then only the script moves.
    """
    if folder is not None:
        with contextlib.suppress(ValueError):  # another drive
            near = Path(os.path.relpath(file, folder))
            if near.parts[:2] != ("..", ".."):
                return near.as_posix()
    return str(file)


def _pose(pose: Pose) -> str:
    lines = ["[[pose]]", f"time = {_number(pose.time)}"]
    if pose.easing != "smooth":
        lines.append(f"easing = {_quoted(pose.easing)}")
    if pose.name is not None:
        lines.append(f"name = {_quoted(pose.name)}")
    lines += [f"{_key(name)} = {_number(value)}" for name, value in pose.values.items()]
    return "\n".join(lines)


def _track(name: str, channel: Channel) -> str:
    if len(channel) > MOST_TABLES:
        return f"{_key(name)} = '''\n{channel.lines}\n'''"
    lines = [f"{_key(name)} = ["]
    for key in channel.keys:
        easing = "" if key.easing == "smooth" else f", easing = {_quoted(key.easing)}"
        lines.append(f"    {{ time = {_number(key.time)}, value = {_number(key.value)}{easing} }},")
    return "\n".join([*lines, "]"])


def _number(value: float) -> str:
    return repr(float(value))


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _quoted(name)
