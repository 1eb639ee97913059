"""Mapping: from the channels of a recording to the controls of the face, by a table.

The table is TOML that users copy and edit; mapping.toml is the one that comes along, and says what
may stand in it. Where a recording tells the same thing twice, only one of the two moves the face,
see `chosen`.
"""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np

from risorius.schema import MadeFrom, Within, parsed_toml, read

from ..errors import UserError
from ..files import NoSuchFileError, read_text
from .names import ARKIT, EYE_ANGLES, HEAD_ANGLES, VISEMES
from .take import Array

Value = TypeVar("Value", float, Array)

LONGEST_FILE = 2**18  # [bytes]
GREATEST_SHARE = 2.0  # a share beyond it is a slip of the pen
_ACTION_UNIT = re.compile(r"(AU[0-9]{1,2})(_left|_right)?")
_SHAPE_OF_UNIT = {  # which shapes, by the beginning of their names, tell what an action unit tells
    "AU1": "browInnerUp", "AU2": "browOuterUp", "AU4": "browDown", "AU5": "eyeWide",
    "AU6": "cheekSquint", "AU7": "eyeSquint", "AU9": "noseSneer", "AU10": "mouthUpperUp",
    "AU12": "mouthSmile", "AU14": "mouthDimple", "AU15": "mouthFrown", "AU16": "mouthLowerDown",
    "AU17": "mouthShrug", "AU18": "mouthPucker", "AU20": "mouthStretch", "AU22": "mouthFunnel",
    "AU23": "mouthPress", "AU24": "mouthPress", "AU25": "jawOpen", "AU26": "jawOpen",
    "AU27": "jawOpen", "AU28": "mouthRoll", "AU34": "cheekPuff", "AU43": "eyeBlink",
    "AU45": "eyeBlink", "AU46": "eyeBlink",
}  # fmt: skip
_SHAPES = frozenset(ARKIT)
CHANNELS = (*ARKIT, *VISEMES, *HEAD_ANGLES, *EYE_ANGLES)  # that recordings may have, but units
Share = Annotated[float, Within(-GREATEST_SHARE, GREATEST_SHARE)]
_LOOKS_OF_ANGLE = {
    f"eye_{angle}_{side.lower()}": frozenset(f"eyeLook{way}{side}" for way in ways)
    for angle, ways in (("yaw", ("In", "Out")), ("pitch", ("Up", "Down")))
    for side in ("Left", "Right")
}


def _channel(name: str) -> str:
    """The name of a channel, see names.py; ValueError for another."""
    if name not in CHANNELS and not _ACTION_UNIT.fullmatch(name):
        raise ValueError(
            "no recording has such a channel; rows are named as mouthSmileLeft, AU12, viseme_PP, "
            "head_yaw"
        )
    return name


Channel = Annotated[str, MadeFrom(str, _channel)]


@dataclass(frozen=True)
class MappingTable:
    """Channel -> {control: share}; what has no row moves the control of its own name."""

    rows: Mapping[str, Mapping[str, float]]
    source: str = ""  # the file, for error texts

    def controls(self, channels: Mapping[str, Value]) -> dict[str, Value]:
        """The values of the controls that the channels move: arrays or numbers, as given.

        Nothing is cut off; the scene does that.
        """
        controls: dict[str, Value] = {}
        for channel in chosen(channels):
            value = channels[channel]
            for control, share in self.row(channel).items():
                part = value * share
                controls[control] = controls[control] + part if control in controls else part
        return controls

    def row(self, channel: str) -> Mapping[str, float]:
        """What the channel moves: {control: share}."""
        return self.rows.get(channel, {channel: 1.0})

    def check(self, controls: Container[str]) -> None:
        """Raise UserError if a row names what is no control of the face."""
        for channel, row in self.rows.items():
            for control in row:
                if control not in controls:
                    raise UserError(
                        f"{self.source}: row '{channel}': there is no control called '{control}'; "
                        "`risorius controls` lists every control"
                    )


def chosen(channels: Mapping[str, Any]) -> tuple[str, ...]:
    """The channels that move the face, where some tell the same thing twice.

    Eyes by their angles: these have a sign and know no limit, and eyeLook shapes are made of them.
    A tracker that measures no angle leaves it at 0; then the shapes count. An action unit only
    where no shape of ARKit tells the same: shapes know left from right.
    """
    left_out: set[str] = set()
    for angle, looks in _LOOKS_OF_ANGLE.items():
        if angle in channels and not looks.isdisjoint(channels):
            left_out |= looks if np.any(channels[angle]) else {angle}
    shapes = tuple(name for name in channels if name in _SHAPES)
    for name in channels:
        unit = _ACTION_UNIT.fullmatch(name) if shapes else None
        twin = _SHAPE_OF_UNIT.get(unit[1]) if unit else None
        if twin and any(shape.startswith(twin) for shape in shapes):
            left_out.add(name)
    return tuple(name for name in channels if name not in left_out)


@cache
def usual_mapping() -> MappingTable:
    """The mapping that comes along."""
    return parse_mapping(mapping_text(), source="mapping.toml")


def mapping_text() -> str:
    """The table that comes along, to be copied and edited."""
    return (files(__package__) / "mapping.toml").read_text("utf-8")


def load_mapping(path: Path | None) -> MappingTable:
    """The mapping in a file, over the usual one. Raises UserError with file and row."""
    if path is None:
        return usual_mapping()
    try:
        text = read_text(path, what="mapping", longest=LONGEST_FILE)
    except NoSuchFileError:
        raise UserError(
            f"{path}: no such mapping; `risorius convert --mapping-table > {path.name}` writes one"
        ) from None
    own = parse_mapping(text, source=str(path))
    return MappingTable({**usual_mapping().rows, **own.rows}, own.source)


def parse_mapping(text: str, *, source: str) -> MappingTable:
    """Turn the TOML text of a table into a MappingTable; `source` names it in error texts."""
    try:
        table = parsed_toml(text)
    except ValueError as error:
        raise UserError(f"{source}: {error}") from None
    return MappingTable(
        read(dict[Channel, dict[str, Share]], table, source, error=UserError), source
    )
