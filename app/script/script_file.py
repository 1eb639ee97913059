"""Reading and writing of script files; an error names the wrong line or key.

A written script reads back unchanged. Tracks with few keys are written as tables, which are easy to
understand; tracks with more keys are written as lines, which are short and fast to read. A single
pose is a script with one [[pose]] at time 0.
"""

from __future__ import annotations

import contextlib
import functools
import io
import itertools
import json
import os
import re
import sys
from array import array
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import click
import numpy as np
import numpy.typing as npt

from risorius.schema import Flag, MadeFrom, Record, parsed_toml, quoted, read

from ..errors import UserError
from ..files import read_text, save_text
from ..text import as_text, in_one_line
from . import (
    LARGEST_NUMBER,
    LONGEST_SCRIPT_FILE,
    POSE_SECONDS,
    Channel,
    Key,
    Moment,
    Pose,
    Script,
    rounded,
)
from .easings import ALLOWED_EASINGS, Easing, easing_named


def _channel(entries: Any) -> Channel:
    """Read a channel from a list of tables, or from lines of text."""
    if isinstance(entries, str) and entries.strip():
        return _channel_of_lines(entries)
    if not isinstance(entries, list) or not entries:
        raise ValueError(
            f"was {quoted(entries)}, must be a list of {{time = .., value = ..}}, or lines of a "
            "time and a value in quotes"
        )
    keys = read(list[Key], entries, "key")
    _check_order("key", [key.time for key in keys])
    return Channel.from_keys(keys)


def _channel_of_lines(text: str) -> Channel:
    """Read a channel from lines of a time, a value and, unless it is linear, an easing.

    A take has half a million lines, so numbers are put into arrays and checked there.
    """
    times = array("d")
    values = array("d")
    easings = array("B")
    for number, words in enumerate(filter(None, map(str.split, io.StringIO(text))), start=1):
        try:
            time, value, easing = words if len(words) == 3 else (*words, "linear")
            times.append(float(time))
            values.append(float(value))
            easings.extend(easing_named(easing))
        except ValueError:
            raise ValueError(
                f"key {number}: was {quoted(' '.join(words))}, must be a time, a value and perhaps "
                f"an easing: {ALLOWED_EASINGS}"
            ) from None
    channel = Channel(times, values, np.array(easings).reshape(-1, 3))
    is_wrong = ~(np.abs(channel.values) <= LARGEST_NUMBER) | ~(channel.times <= LARGEST_NUMBER)
    for place in np.flatnonzero(is_wrong | (channel.times < 0.0))[:1].tolist():
        read(Key, {"time": times[place], "value": values[place]}, f"key {place + 1}")
    _check_order("key", channel.times)
    return channel


def _check_order(what: str, times: npt.ArrayLike) -> None:
    """Raise ValueError unless the times [s] rise strictly."""
    rising = np.asarray(times)
    for place in np.flatnonzero(np.diff(rising) <= 0.0)[:1].tolist():
        raise ValueError(
            f"{what} {place + 2}: time {rising[place + 1]:g} s does not come after the {what} "
            f"before it ({rising[place]:g} s)"
        )


def _poses(poses: list[Pose]) -> tuple[Pose, ...]:
    _check_order("pose", [pose.time for pose in poses])
    return tuple(poses)


@dataclass(frozen=True)
class _File(Record):
    """The keys of a script file."""

    title: str | None = None
    scene: str = "face"
    camera: str | None = None
    sound: str | None = None
    alive: Flag = False
    duration: Moment | None = None
    pose: Annotated[tuple[Pose, ...], MadeFrom(list[Pose], _poses)] = ()
    tracks: dict[str, Annotated[Channel, MadeFrom(Any, _channel)]] = field(default_factory=dict)


def load_script(path: Path) -> Script:
    """Read a script file. Raises UserError with the file and the line or key that is wrong."""
    text = read_text(path, what="script", longest=LONGEST_SCRIPT_FILE)
    # A longer script takes a while to read, so a line reports it.
    if len(text) > 2**20 and sys.stderr.isatty():
        click.echo(f"... reading {in_one_line(path)}, {len(text) >> 20} MB", err=True)
    return parse_script(text, source=str(path))


def parse_script(text: str, *, source: str) -> Script:
    """Turn the TOML text of a script into a Script; `source` names it in error texts."""
    try:
        document = parsed_toml(text)
    except ValueError as error:
        raise UserError(f"{source}: {error}") from None
    if isinstance(document.get("pose"), dict):
        raise UserError(f"{source}: [pose] is one table; write [[pose]], in two brackets, for each")
    file = read(_File, document, source, error=UserError)
    ends = [float(channel.times[-1]) for channel in file.tracks.values()]
    ends += [pose.time for pose in file.pose[-1:]]
    if not ends:
        raise UserError(f"{source}: no [[pose]] and no [tracks]: a script needs at least one key")
    held = 1.0  # [s] of a script whose only key is at 0 s
    duration = (max(ends) or held) if file.duration is None else file.duration
    if duration <= 0.0:
        raise UserError(f"{source}: duration is {duration:g} s; it must be above 0")
    for pose in file.pose:
        if pose.name is not None and pose.time > duration:
            raise UserError(
                f"{source}: pose '{pose.name}' at {pose.time:g} s comes after the duration, "
                f"{duration:g} s"
            )
    if file.sound == "":
        raise UserError(f"{source}, 'sound': is empty, must be the name of a sound file")
    sound = file.sound and Path(os.path.abspath(Path(source).parent / file.sound))
    return Script(
        title=Path(source).stem if file.title is None else file.title,
        duration=duration,
        source=source,
        scene=file.scene,
        camera=file.camera,
        sound=sound or None,
        alive=file.alive,
        poses=file.pose,
        tracks=file.tracks,
        preface=preface_of(text),
    )


def preface_of(text: str) -> str:
    """Return the comments at the beginning of a file, which survive when it is rewritten."""
    comments = itertools.takewhile(lambda line: line.startswith("#"), text.split("\n"))
    return "\n".join(comments)


_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def save_script(target: Path, script: Script) -> None:
    """Write a script file atomically; raise UserError if it cannot be written."""
    text = script_text(script, target.parent)
    if len(text) > LONGEST_SCRIPT_FILE:
        raise UserError(
            f"{target}: the script is too long; it may have {LONGEST_SCRIPT_FILE >> 20} MB: "
            "delete some keys"
        )
    save_text(target, text)


def script_text(script: Script, folder: Path | None = None) -> str:
    """Return the TOML text of a script; folder: folder of the file, for relative paths.

    Raises UserError for a sound whose name is not UTF-8: TOML requires UTF-8.
    """
    head = [as_text(script.preface)] if script.preface else []
    if script.title:  # without a title the file's name is used
        head.append(f"title = {_quoted(script.title)}")
    head.append(f"scene = {_quoted(script.scene)}")
    if script.camera is not None:
        head.append(f"camera = {_quoted(script.camera)}")
    if script.alive:
        head.append("alive = true")
    if script.sound is not None:
        sound = _as_seen_from(folder, script.sound)
        if as_text(sound) != sound:
            raise UserError(
                f"{script.sound}: a script cannot name this sound, because its path is not UTF-8; "
                "rename it"
            )
        head.append(f"sound = {_quoted(sound)}")
    head.append(f"duration = {_number(script.duration)}")
    blocks = ["\n".join(head), *map(_pose, script.poses)]
    if script.tracks:
        tracks = [_track(name, channel) for name, channel in script.tracks.items()]
        blocks.append("\n".join(["[tracks]", *tracks]))
    return "\n\n".join(blocks) + "\n"


def pose_script(values: Mapping[str, float], *, title: str, scene: str) -> Script:
    """Return a script of one pose; controls at 0 are left out."""
    pose = Pose(0.0, {name: rounded(value) for name, value in values.items() if rounded(value)})
    return Script(title, POSE_SECONDS, source=title, scene=scene, poses=(pose,))


def is_pose(script: Script) -> bool:
    """Whether a script holds one pose and no motion."""
    is_still = all(len(channel) == 1 for channel in script.tracks.values())
    is_something = bool(script.posed_names or script.tracks)
    return is_something and is_still and len(script.poses) <= 1


def _as_seen_from(folder: Path | None, file: Path) -> str:
    """Return the path of a file relative to `folder`, so that script and file may move together.

    If the file is neither in the folder nor near it, the path is absolute, and only the script may
    move.
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
    # A table of more keys would be too long for readers.
    if len(channel) > 24:
        parts = (channel.times.tolist(), channel.values.tolist(), channel.easing_rows())
        keys = "\n".join(
            f"{time!r} {value!r}{_ending(easing)}"
            for time, value, easing in zip(*parts, strict=True)
        )
        return f"{_key(name)} = '''\n{keys}\n'''"
    lines = [f"{_key(name)} = ["]
    for key in channel.keys:
        easing = "" if key.easing == "smooth" else f", easing = {_quoted(key.easing)}"
        lines.append(f"    {{ time = {_number(key.time)}, value = {_number(key.value)}{easing} }},")
    return "\n".join([*lines, "]"])


@functools.cache
def _ending(easing: Easing) -> str:
    """Return the end of a key's line for an easing; "" for the linear easing."""
    return "" if easing.name == "linear" else f" {easing.name}"


def _number(value: float) -> str:
    return repr(float(value))


def _quoted(text: str) -> str:
    return json.dumps(as_text(text), ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else _quoted(name)
