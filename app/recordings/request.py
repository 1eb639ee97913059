"""What a reader is asked for, beside the file."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Request:
    """face: which one, where a file has several. rate: frames a second, known better."""

    face: str | None = None
    rate: float | None = None
