"""A script file -> a Script, or the file and the line or key that is wrong."""

from __future__ import annotations

import io
import itertools
import os
import sys
import tomllib
from array import array
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click
import numpy as np

from ..errors import UserError, in_one_line
from ..files import read_text
from .bounds import LONGEST_FILE, excess_in
from .easing import ALL_EASINGS, ALLOWED
from .model import EASING_NAMES, Channel, Key, Pose, Script

SOON_READ = 2**20  # [bytes]; a longer script is said to be read
LARGEST = 86_400.0  # of any number in a script; as a time [s] it is a day
TOP_LEVEL_KEYS = ("title", "scene", "camera", "sound", "duration", "pose", "tracks")
POSE_KEYS = ("time", "easing", "name")
TRACK_KEYS = ("time", "value", "easing")


def load_script(path: Path) -> Script:
    """Read a script file. Raises UserError with the file and the line or key that is wrong."""
    text = read_text(path, what="script", longest=LONGEST_FILE)
    if len(text) > SOON_READ and sys.stderr.isatty():
        click.echo(f"... reading {in_one_line(path)}, {len(text) >> 20} MB", err=True)
    return parse_script(text, source=str(path))


def parse_script(text: str, *, source: str) -> Script:
    """Turn the TOML text of a script into a Script; `source` names it in error texts."""
    excess = excess_in(text)
    if excess:
        raise UserError(f"{source}: {excess}; no script needs that")
    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # numbers too long, lists too deep, too
        is_long = "set_int_max_str_digits" in str(error)  # advice for programmers
        why = "a number has thousands of digits" if is_long else error
        raise UserError(f"{source}: not valid TOML: {why}") from None
    reader = _Reader(source)
    reader.only(document, TOP_LEVEL_KEYS, where="top level")
    poses = reader.poses(document.get("pose", []))
    tracks = reader.tracks(document.get("tracks", {}))
    ends = [float(channel.times[-1]) for channel in tracks.values()]
    ends += [pose.time for pose in poses[-1:]]
    if not ends:
        raise UserError(f"{source}: no [[pose]] and no [tracks]: a script needs at least one key")
    duration = reader.number(document, "duration", where="top level", default=max(ends))
    if duration <= 0.0:
        raise UserError(
            f"{source}: duration is {duration:g} s; it must be above 0: "
            "write duration = 1.0, or a key after 0 s"
        )
    for pose in poses:
        if pose.name is not None and pose.time > duration:
            raise UserError(
                f"{source}: pose '{pose.name}' at {pose.time:g} s comes after the duration, "
                f"{duration:g} s"
            )
    return Script(
        title=reader.text(document, "title", default=Path(source).stem),
        duration=duration,
        source=source,
        scene=reader.text(document, "scene", default="face"),
        camera=reader.text(document, "camera", default=None),
        sound=reader.sound(document),
        poses=poses,
        tracks=tracks,
        preface=preface_of(text),
    )


def preface_of(text: str) -> str:
    """The lines of comment with which a file begins; programs that write it anew keep them."""
    comments = itertools.takewhile(lambda line: line.startswith("#"), text.split("\n"))
    return "\n".join(comments)


class _Reader:
    """Takes typed values out of a parsed TOML document, or says which key is wrong."""

    def __init__(self, source: str) -> None:
        self.source = source

    def fail(self, text: str) -> UserError:
        return UserError(f"{self.source}: {text}")

    def only(self, table: Mapping[str, Any], allowed: tuple[str, ...], *, where: str) -> None:
        for key in table:
            if key not in allowed:
                raise self.fail(f"{where}: unknown key '{key}'; allowed are {', '.join(allowed)}")

    def number(
        self, table: Mapping[str, Any], key: str, *, where: str, default: float | None = None
    ) -> float:
        """A finite number; with a default it may be missing."""
        value = table.get(key, default)
        if value is None:
            raise self.fail(f"{where}: '{key}' is missing; it must be a number")
        if isinstance(value, bool) or not isinstance(value, int | float) or value != value:
            raise self.fail(f"{where}: '{key}' is {value!r}; it must be a number")
        if abs(value) > LARGEST:
            raise self.fail(f"{where}: '{key}' must lie between -{LARGEST:g} and {LARGEST:g}")
        return float(value)

    def text(self, table: Mapping[str, Any], key: str, *, default: str | None) -> Any:
        """A text, or the default where there is none."""
        value = table.get(key, default)
        if value is not default and not isinstance(value, str):
            raise self.fail(f"top level: '{key}' is {value!r}; it must be a text in quotes")
        return value

    def sound(self, document: Mapping[str, Any]) -> Path | None:
        """The whole path of the sound file, which is named as seen from the script."""
        name = self.text(document, "sound", default=None)
        if name == "":
            raise self.fail("top level: 'sound' is empty; it must be the name of a sound file")
        return None if name is None else Path(os.path.abspath(Path(self.source).parent / name))

    def easing(self, table: Mapping[str, Any], *, where: str) -> str:
        """The name of an easing that there is."""
        value = table.get("easing", "smooth")
        if not isinstance(value, str) or value not in ALL_EASINGS:
            raise self.fail(f"{where}: easing {value!r}; allowed are {ALLOWED}")
        return str(value)

    def time(self, table: Mapping[str, Any], previous: float | None, *, where: str) -> float:
        """The time of a key [s], which has to come after that of the key before it."""
        time = self.number(table, "time", where=where)
        if time < 0.0:
            raise self.fail(f"{where}: time is {time:g} s; it must be 0 or more")
        if previous is not None and time <= previous:
            raise self.fail(
                f"{where}: time {time:g} s does not come after the key before it ({previous:g} s)"
            )
        return time

    def poses(self, tables: Any) -> tuple[Pose, ...]:
        """The whole poses, in the order of time."""
        if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
            raise self.fail("'pose' must be a list of tables, each written [[pose]]")
        poses: list[Pose] = []
        for number, table in enumerate(tables, start=1):
            where = f"pose {number}"
            time = self.time(table, poses[-1].time if poses else None, where=where)
            easing = self.easing(table, where=where)
            pose_name = table.get("name")
            if pose_name is not None and not isinstance(pose_name, str):
                raise self.fail(f"{where}: 'name' must be a text in quotes")
            values = {
                name: self.number(table, name, where=where)
                for name in table
                if name not in POSE_KEYS
            }
            poses.append(Pose(time, values, easing, pose_name))
        return tuple(poses)

    def tracks(self, tables: Any) -> dict[str, Channel]:
        """The single channels of the table [tracks]."""
        if not isinstance(tables, dict):
            raise self.fail(
                "'tracks' must be a table: [tracks], then name = [ {time, value}, ... ]"
            )
        return {name: self.track(name, entries) for name, entries in tables.items()}

    def track(self, name: str, entries: Any) -> Channel:
        """A channel of [tracks]: a list of tables, or lines of text."""
        if isinstance(entries, str) and entries.strip():
            return self.track_of_lines(name, entries)
        if not isinstance(entries, list) or not entries:
            raise self.fail(
                f"track '{name}' must be a list of {{ time = .., value = .. }}, "
                "or lines of a time and a value in quotes"
            )
        keys: list[Key] = []
        for number, entry in enumerate(entries, start=1):
            where = f"track '{name}', key {number}"
            if not isinstance(entry, dict):
                raise self.fail(f"{where} must be written {{ time = .., value = .. }}")
            self.only(entry, TRACK_KEYS, where=where)
            time = self.time(entry, keys[-1].time if keys else None, where=where)
            value = self.number(entry, "value", where=where)
            keys.append(Key(time, value, self.easing(entry, where=where)))
        return Channel.of(keys)

    def track_of_lines(self, name: str, text: str) -> Channel:
        """A channel from lines of a time, a value and, where it is not linear, an easing.

        A take has half a million of them: numbers are put into arrays, and checked there.
        """
        times, values, easings = array("d"), array("d"), array("H")
        for number, words in enumerate(filter(None, map(str.split, io.StringIO(text))), start=1):
            try:
                time, value, easing = words if len(words) == 3 else (*words, "linear")
                times.append(float(time))
                values.append(float(value))
                easings.append(EASING_NAMES.index(easing))
            except ValueError:
                raise self.fail(
                    f"track '{name}', key {number}: {' '.join(words)!r} must be a time, a value "
                    f"and perhaps an easing: {ALLOWED}"
                ) from None
        channel = Channel(times, values, easings)
        is_wrong = ~(np.abs(channel.values) <= LARGEST) | ~(channel.times <= LARGEST)
        is_wrong |= channel.times < 0.0
        is_wrong[1:] |= channel.times[1:] <= channel.times[:-1]
        for place in np.flatnonzero(is_wrong)[:1].tolist():
            where = f"track '{name}', key {place + 1}"
            entry = {"time": times[place], "value": values[place]}
            self.time(entry, times[place - 1] if place else None, where=where)
            self.number(entry, "value", where=where)
        return channel
