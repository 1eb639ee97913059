"""Animation scripts: keyframes of controls over time, in a TOML file.

A script is a list of poses and, beside them, tracks::

    title = "Hello"              # optional
    scene = "face"               # optional: face (default) or plane
    camera = "three-quarter"     # optional: a named view
    duration = 4.0               # optional [s]; the default is the time of the last key

    [[pose]]                     # a whole pose: what it does not name is 0
    time = 0.0                   # [s]

    [[pose]]
    time = 1.0
    easing = "smooth"            # how this pose is approached, see app/easing.py
    name = "joy"                 # optional: the label of this key pose on a contact sheet
    joy = 1.0                    # a control of any layer: an expression, an action unit,
    jaw_open = 0.1               # a viseme, a muscle, the jaw, the gaze

    [tracks]                     # single channels, added to the poses (a blink, a glance)
    blink = [
        { time = 2.0, value = 0 },
        { time = 2.12, value = 1, easing = "ease-in" },
        { time = 2.3, value = 0 },
    ]

Before its first key a channel keeps that key's value, after its last key the last one's.
`docs/scripts.md` is the user's page of this format.
"""

from __future__ import annotations

import bisect
import difflib
import functools
import itertools
import sys
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import Any, TypeVar

import click

from .easing import EASINGS
from .errors import UserError, in_one_line
from .inputs import read_text
from .script_bounds import excess_in

Limits = Mapping[str, tuple[float, float]]  # the lowest and highest value of each control

LONGEST_FILE = 2**24  # [bytes]; a day of speech has less, and /dev/zero has no end
SOON_READ = 2**20  # [bytes]; a longer script is said to be read, about a second for each megabyte
LARGEST = 86_400.0  # of any number in a script; as a time [s] it is a day
DECIMALS = 6  # of numbers that come from sliders and clocks
TOP_LEVEL_KEYS = ("title", "scene", "camera", "duration", "pose", "tracks")
POSE_KEYS = ("time", "easing", "name")
TRACK_KEYS = ("time", "value", "easing")


@dataclass(frozen=True)
class Key:
    """One keyframe of one channel: at `time` [s] it has `value`, approached by `easing`."""

    time: float
    value: float
    easing: str = "smooth"


@dataclass(frozen=True)
class Channel:
    """The keys of one control, in the order of time."""

    keys: tuple[Key, ...]

    def value(self, time: float) -> float:
        """The eased value at `time` [s]; constant before the first and after the last key."""
        previous, following, share = _between(self.keys, time)
        return previous.value + (following.value - previous.value) * share


@dataclass(frozen=True)
class Pose:
    """A whole pose at `time` [s]: what it does not name is 0; approached by `easing`."""

    time: float
    values: Mapping[str, float] = field(default_factory=dict)
    easing: str = "smooth"
    name: str | None = None  # one that has a name gets a picture on a contact sheet


@dataclass(frozen=True)
class Script:
    """A performance: what each control does over `duration` seconds."""

    title: str
    duration: float
    source: str = field(compare=False)  # the file it came from, for error texts
    scene: str = "face"
    camera: str | None = None
    poses: tuple[Pose, ...] = ()  # in the order of time
    tracks: dict[str, Channel] = field(default_factory=dict)
    preface: str = ""  # the lines of comment with which the file begins

    @functools.cached_property
    def posed_names(self) -> tuple[str, ...]:
        """The controls that any pose names."""
        return tuple(sorted({name for pose in self.poses for name in pose.values}))

    def posed(self, time: float) -> dict[str, float]:
        """What the poses alone make of each control that they name, at `time` [s]."""
        values = dict.fromkeys(self.posed_names, 0.0)
        if self.poses:
            previous, following, share = _between(self.poses, time)
            for name in {**previous.values, **following.values}:
                before = previous.values.get(name, 0.0)
                values[name] = before + (following.values.get(name, 0.0) - before) * share
        return values

    @property
    def key_poses(self) -> tuple[Pose, ...]:
        """The poses that have a name."""
        return tuple(pose for pose in self.poses if pose.name is not None)

    def at(self, time: float) -> dict[str, float]:
        """The value of every channel that the script names, at `time` [s]."""
        values = self.posed(time)
        for name, channel in self.tracks.items():
            values[name] = values.get(name, 0.0) + channel.value(time)
        return values

    def check(self, limits: Limits) -> None:
        """Raise UserError if the script names what the scene does not have, or asks too much.

        What tracks add to poses may be negative, and is cut off with them; no single key may be
        further from 0 than can have an effect.
        """
        for name in (*self.posed_names, *self.tracks):
            if name not in limits:
                hint = suggestion(name, limits, self.scene)
                raise UserError(f"{self.source}: unknown name '{name}'; {hint}")
        for pose in self.poses:
            when = f" at {pose.time:g} s" if len(self.poses) > 1 else ""
            for name, value in pose.values.items():
                self._check_value(name, value, when, *limits[name])
        for name, channel in self.tracks.items():
            low, high = limits[name]
            for key in channel.keys:
                when = f" at {key.time:g} s" if len(channel.keys) > 1 else ""
                self._check_value(f"track '{name}'", key.value, when, low - high, high - low)

    def _check_value(self, what: str, value: float, when: str, low: float, high: float) -> None:
        if not low <= value <= high:
            raise UserError(
                f"{self.source}: {what} is {value:g}{when}; it must be from {low:g} to {high:g}"
            )


Timed = TypeVar("Timed", Key, Pose)


def _between(keys: Sequence[Timed], time: float) -> tuple[Timed, Timed, float]:
    """The keys before and after `time` [s], and the eased share of the way between them.

    Before the first and after the last key both are that one.
    """
    after = bisect.bisect_right(keys, time, key=attrgetter("time"))
    if after in (0, len(keys)):
        outermost = keys[0 if after == 0 else -1]
        return outermost, outermost, 0.0
    previous, following = keys[after - 1], keys[after]
    share = (time - previous.time) / (following.time - previous.time)
    return previous, following, EASINGS[following.easing](share)


def rounded(number: float) -> float:
    """A time or a value as programs write it into scripts: no digits that nobody meant."""
    return round(float(number), DECIMALS)


def suggestion(name: str, allowed: Iterable[str], scene: str) -> str:
    """The end of an error text: the names that were probably meant, or where to find all."""
    near = difflib.get_close_matches(name, list(allowed), n=3)
    if near:
        return f"did you mean {' or '.join(near)}?"
    option = "" if scene == "face" else f" --scene {scene}"
    return f"`risorius controls{option}` lists every control"


def load_script(path: Path) -> Script:
    """Read a script file. Raises UserError with the file and the line or key that is wrong."""
    try:
        text = read_text(path, what="script", longest=LONGEST_FILE)
    except FileNotFoundError:
        raise UserError(f"{path}: no such script") from None
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
    ends = [channel.keys[-1].time for channel in tracks.values()]
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

    def easing(self, table: Mapping[str, Any], *, where: str) -> str:
        """The name of an easing that there is."""
        value = table.get("easing", "smooth")
        if not isinstance(value, str) or value not in EASINGS:
            raise self.fail(f"{where}: easing {value!r}; allowed are {', '.join(EASINGS)}")
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
        channels: dict[str, Channel] = {}
        for name, entries in tables.items():
            if not isinstance(entries, list) or not entries:
                raise self.fail(f"track '{name}' must be a list of {{ time = .., value = .. }}")
            keys: list[Key] = []
            for number, entry in enumerate(entries, start=1):
                where = f"track '{name}', key {number}"
                if not isinstance(entry, dict):
                    raise self.fail(f"{where} must be written {{ time = .., value = .. }}")
                self.only(entry, TRACK_KEYS, where=where)
                time = self.time(entry, keys[-1].time if keys else None, where=where)
                value = self.number(entry, "value", where=where)
                keys.append(Key(time, value, self.easing(entry, where=where)))
            channels[name] = Channel(tuple(keys))
        return channels
