"""A recording of a face by any program as channels over time, and options for its reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from risorius.geometry.arrays import Floats64

from ..errors import UserError


@dataclass(frozen=True)
class TakeRequest:
    """face: name of the face, if a file has several. rate: replaces the file's rate [1 / s]."""

    face: str | None = None
    rate: float | None = None

    def refuse_face(self, source: str) -> None:
        """Raise UserError if a face is named and the file names none."""
        if self.face is not None:
            raise UserError(f"{source}: names no faces; leave out the face '{self.face}'")


@dataclass(frozen=True)
class Take:
    """Channels over time, with the names and units of names.py, not yet calibrated.

    kind: the program that wrote it ("Live Link Face", "OpenFace 2", ...).
    source: the file, for error messages.
    times: time of each frame [s], shape (T,), from 0 and strictly rising; T is at least 1.
    channels: name -> values, shape (T,); finite.
    is_calibrated: whether the neutral face was already subtracted.
    notes: values that were guessed, skipped or left out, each one sentence.
    unknown: unknown columns in the file's spelling.
    has_keys: whether rows are keys with straight lines between them, and not frames.
    sound: the sound file that the recording names, if it exists.
    """

    kind: str
    source: str
    times: Floats64
    channels: Mapping[str, Floats64]
    is_calibrated: bool = False
    notes: tuple[str, ...] = ()
    unknown: tuple[str, ...] = field(default=(), repr=False)
    has_keys: bool = False
    sound: Path | None = None

    @property
    def duration(self) -> float:
        """The duration of the take [s]."""
        return float(self.times[-1])
