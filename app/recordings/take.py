"""A recording of a face, of any program: channels over time; and the request to a reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from risorius.geometry.arrays import Floats64

from ..errors import UserError


@dataclass(frozen=True)
class TakeRequest:
    """face: the name of a face, if the file has several. rate: replaces the file's [1 / s]."""

    face: str | None = None
    rate: float | None = None

    def refuse_face(self, source: str) -> None:
        """Raise UserError if a face is named and the file names none."""
        if self.face is not None:
            raise UserError(f"{source}: names no faces; leave out the face '{self.face}'")


@dataclass(frozen=True)
class Take:
    """Channels over time, in the names and units of names.py; as recorded, not yet calibrated.

    kind: what wrote it, as a report calls it ("Live Link Face", "OpenFace 2", ...).
    source: the file, for error messages.
    times: of each frame [s], shape (T,), from 0 and strictly rising; T is at least 1.
    channels: name -> values, shape (T,); finite.
    is_calibrated: whether the neutral face was taken away already.
    notes: values that were guessed, skipped or left out, each one sentence.
    unknown: columns that no reader knows, as the file spells them.
    has_keys: whether times are those of keys with straight lines between them, not of frames.
    sound: the file of the sound that the recording names, if it exists.
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
