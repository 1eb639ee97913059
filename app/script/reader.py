"""A script file -> a Script, or the file and the line or key that is wrong."""

from __future__ import annotations

import io
import itertools
import os
import re
import sys
from array import array
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import click
import numpy as np
import numpy.typing as npt

from risorius.schema import MadeFrom, Record, parsed_toml, quoted, read

from ..errors import UserError, in_one_line
from ..files import read_text
from .easing import ALLOWED
from .model import EASING_NUMBERS, LARGEST, LONGEST_FILE, Channel, Key, Number, Pose, Script

SOON_READ = 2**20  # [bytes]; a longer script is said to be read
# A TOML parser makes a table for each part of a key, and looks at all parts of one again for each
# of them, so that a few kilobytes of dots could take hours. Lines of keys in quotes are cheap.
LONGEST_BARE = 2**22  # [characters] outside of quotes and comments
# Strings and comments, in which dots mean nothing. No text makes this slow: what has been taken is
# not given back, and each kind of string can be unfinished once.
QUOTED = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+"""|' r"'''.*?'''|"
    r'"(?:[^"\\\n]|\\.)*+"|' r"'[^'\n]*+'|#[^\n]*+",
    re.DOTALL,
)  # fmt: skip
LONG_KEY = re.compile(r"(?:\.[^.=,\n\[\]{}]*+){3}")  # of more than three parts; a script needs two


def _channel(entries: Any) -> Channel:
    """A channel of a list of tables, or of lines of text."""
    if isinstance(entries, str) and entries.strip():
        return _channel_of_lines(entries)
    if not isinstance(entries, list) or not entries:
        raise ValueError(
            f"was {quoted(entries)}, must be a list of {{time = .., value = ..}}, or lines of a "
            "time and a value in quotes"
        )
    keys = read(list[Key], entries, "key")
    _check_order("key", [key.time for key in keys])
    return Channel.of(keys)


def _channel_of_lines(text: str) -> Channel:
    """A channel from lines of a time, a value and, where it is not linear, an easing.

    A take has half a million of them: numbers are put into arrays, and checked there.
    """
    times, values, easings = array("d"), array("d"), array("H")
    for number, words in enumerate(filter(None, map(str.split, io.StringIO(text))), start=1):
        try:
            time, value, easing = words if len(words) == 3 else (*words, "linear")
            times.append(float(time))
            values.append(float(value))
            easings.append(EASING_NUMBERS[easing])
        except (ValueError, KeyError):
            raise ValueError(
                f"key {number}: was {quoted(' '.join(words))}, must be a time, a value and perhaps "
                f"an easing: {ALLOWED}"
            ) from None
    channel = Channel(times, values, easings)
    is_wrong = ~(np.abs(channel.values) <= LARGEST) | ~(channel.times <= LARGEST)
    for place in np.flatnonzero(is_wrong | (channel.times < 0.0))[:1].tolist():
        read(Key, {"time": times[place], "value": values[place]}, f"key {place + 1}")
    _check_order("key", channel.times)
    return channel


def _check_order(what: str, times: npt.ArrayLike) -> None:
    """ValueError unless each time [s] comes after the one before it."""
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
    """What a script file may say."""

    title: str | None = None
    scene: str = "face"
    camera: str | None = None
    sound: str | None = None
    duration: Number | None = None
    pose: Annotated[tuple[Pose, ...], MadeFrom(list[Pose], _poses)] = ()
    tracks: dict[str, Annotated[Channel, MadeFrom(Any, _channel)]] = field(default_factory=dict)


def load_script(path: Path) -> Script:
    """Read a script file. Raises UserError with the file and the line or key that is wrong."""
    text = read_text(path, what="script", longest=LONGEST_FILE)
    if len(text) > SOON_READ and sys.stderr.isatty():
        click.echo(f"... reading {in_one_line(path)}, {len(text) >> 20} MB", err=True)
    return parse_script(text, source=str(path))


def parse_script(text: str, *, source: str) -> Script:
    """Turn the TOML text of a script into a Script; `source` names it in error texts."""
    bare = QUOTED.sub(lambda found: "_" + "\n" * found[0].count("\n"), text)
    if len(bare) > LONGEST_BARE:
        most = f"{LONGEST_BARE >> 20} MB outside of quotes, where long tracks have lines"
        raise UserError(f"{source}: has more than {most}")
    if long_key := LONG_KEY.search(bare):
        line = bare.count("\n", 0, long_key.start()) + 1
        raise UserError(f"{source}: line {line}: a key has more than 3 parts with dots between")
    try:
        document = parsed_toml(text)
    except ValueError as error:
        raise UserError(f"{source}: {error}") from None
    file = read(_File, document, source, error=UserError)
    ends = [float(channel.times[-1]) for channel in file.tracks.values()]
    ends += [pose.time for pose in file.pose[-1:]]
    if not ends:
        raise UserError(f"{source}: no [[pose]] and no [tracks]: a script needs at least one key")
    duration = max(ends) if file.duration is None else file.duration
    if duration <= 0.0:
        raise UserError(
            f"{source}: duration is {duration:g} s; it must be above 0: "
            "write duration = 1.0, or a key after 0 s"
        )
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
        poses=file.pose,
        tracks=file.tracks,
        preface=preface_of(text),
    )


def preface_of(text: str) -> str:
    """The lines of comment with which a file begins; programs that write it anew keep them."""
    comments = itertools.takewhile(lambda line: line.startswith("#"), text.split("\n"))
    return "\n".join(comments)
