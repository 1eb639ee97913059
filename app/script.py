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
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .easing import EASINGS
from .errors import UserError

Limits = Mapping[str, tuple[float, float]]  # the lowest and highest value of each control

LONGEST_FILE = 2**24  # [bytes]; a day of speech has less, and /dev/zero has no end
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
        after = bisect.bisect_right([key.time for key in self.keys], time)
        if after == 0:
            return self.keys[0].value
        if after == len(self.keys):
            return self.keys[-1].value
        previous, following = self.keys[after - 1], self.keys[after]
        fraction = (time - previous.time) / (following.time - previous.time)
        eased = EASINGS[following.easing](fraction)
        return previous.value + (following.value - previous.value) * eased


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
    def channels(self) -> dict[str, Channel]:
        """What the poses make together, control by control."""
        names = sorted({name for pose in self.poses for name in pose.values})
        return {
            name: Channel(tuple(Key(p.time, p.values.get(name, 0.0), p.easing) for p in self.poses))
            for name in names
        }

    @property
    def key_poses(self) -> tuple[Pose, ...]:
        """The poses that have a name."""
        return tuple(pose for pose in self.poses if pose.name is not None)

    def at(self, time: float) -> dict[str, float]:
        """The value of every channel that the script names, at `time` [s]."""
        values = {name: channel.value(time) for name, channel in self.channels.items()}
        for name, channel in self.tracks.items():
            values[name] = values.get(name, 0.0) + channel.value(time)
        return values

    def check(self, limits: Limits) -> None:
        """Raise UserError if the script names what the scene does not have, or asks too much.

        What tracks add to poses may be negative, and is cut off with them; no single key may be
        further from 0 than can have an effect.
        """
        for name in (*self.channels, *self.tracks):
            if name not in limits:
                hint = suggestion(name, limits, self.scene)
                raise UserError(f"{self.source}: unknown name '{name}'; {hint}")
        for name, channel in self.channels.items():
            self._check_values(name, channel, *limits[name])
        for name, channel in self.tracks.items():
            low, high = limits[name]
            self._check_values(f"track '{name}'", channel, low - high, high - low)

    def _check_values(self, what: str, channel: Channel, low: float, high: float) -> None:
        for key in channel.keys:
            if not low <= key.value <= high:
                when = f" at {key.time:g} s" if len(channel.keys) > 1 else ""
                raise UserError(
                    f"{self.source}: {what} is {key.value:g}{when}; "
                    f"it must be from {low:g} to {high:g}"
                )


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
        with path.open("rb") as file:
            content = file.read(LONGEST_FILE + 1)
        text = content.decode("utf-8-sig")
    except FileNotFoundError:
        raise UserError(f"{path}: no such script") from None
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{path}: cannot be read as a text file: {error}") from None
    if len(content) > LONGEST_FILE:
        raise UserError(f"{path}: is longer than a script may be, {LONGEST_FILE >> 20} MB")
    return parse_script(text, source=str(path))


def parse_script(text: str, *, source: str) -> Script:
    """Turn the TOML text of a script into a Script; `source` names it in error texts."""
    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # numbers too long, lists too deep, too
        raise UserError(f"{source}: not valid TOML: {error}") from None
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
