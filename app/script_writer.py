"""Scripts and poses back into TOML files; what is written reads back as the same script.

A pose by itself is a script with one [[pose]] at time 0.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

from .outputs import save_text
from .script import Channel, Key, Script

_BARE = re.compile(r"[A-Za-z0-9_-]+")
POSE_SECONDS = 1.0  # duration of a script that is one pose


def save_script(target: Path, script: Script) -> None:
    """Write a script file, whole or not at all; UserError where it cannot be written."""
    save_text(target, script_text(script))


def script_text(script: Script) -> str:
    """The TOML text of a script."""
    head = [f"title = {_quoted(script.title)}", f"scene = {_quoted(script.scene)}"]
    if script.camera is not None:
        head.append(f"camera = {_quoted(script.camera)}")
    head.append(f"duration = {_number(script.duration)}")
    blocks = ["\n".join(head), *_poses(script)]
    if script.tracks:
        tracks = [_track(name, channel) for name, channel in script.tracks.items()]
        blocks.append("\n".join(["[tracks]", *tracks]))
    return "\n\n".join(blocks) + "\n"


def pose_script(values: Mapping[str, float], *, title: str, scene: str) -> Script:
    """A script that is nothing but one pose; what is 0 is left out."""
    poses = {name: Channel((Key(0.0, value),)) for name, value in values.items() if value}
    return Script(title, POSE_SECONDS, source=title, scene=scene, poses=poses)


def is_pose(script: Script) -> bool:
    """Whether a script holds one pose and no motion."""
    channels = (*script.poses.values(), *script.tracks.values())
    return bool(channels) and all(len(channel.keys) == 1 for channel in channels)


def _poses(script: Script) -> list[str]:
    """A [[pose]] for each time at which the pose channels have keys, or that has a name."""
    names = {pose.time: pose.name for pose in script.key_poses}
    rows: dict[float, dict[str, Key]] = {time: {} for time in names}
    for name, channel in script.poses.items():
        for key in channel.keys:
            rows.setdefault(key.time, {})[name] = key
    if not rows and not script.tracks:
        rows[0.0] = {}
    blocks = []
    for time in sorted(rows):
        lines = ["[[pose]]", f"time = {_number(time)}"]
        easing = next((key.easing for key in rows[time].values()), "smooth")
        if easing != "smooth":
            lines.append(f"easing = {_quoted(easing)}")
        if time in names:
            lines.append(f"name = {_quoted(names[time])}")
        # A pose is zero where it is silent; the first names all, so that no channel is lost.
        is_first = time == min(rows)
        for name, key in rows[time].items():
            if key.value or is_first:
                lines.append(f"{_key(name)} = {_number(key.value)}")
        blocks.append("\n".join(lines))
    return blocks


def _track(name: str, channel: Channel) -> str:
    lines = [f"{_key(name)} = ["]
    for key in channel.keys:
        easing = "" if key.easing == "smooth" else f", easing = {_quoted(key.easing)}"
        lines.append(f"    {{ time = {_number(key.time)}, value = {_number(key.value)}{easing} }},")
    return "\n".join([*lines, "]"])


def _number(value: float) -> str:
    return repr(round(float(value), 6))


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _quoted(name)
