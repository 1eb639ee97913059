"""A clip as numpy arrays, in millimetres: for whoever goes on in Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..files import cannot_be_written
from .clip import Clip
from .formats import Request


def write_npz(clip: Clip, part: Path, _: Request) -> None:
    """Write positions (N, V, 3), faces (F, 3), times (N,), bones and curves; see docs/export.md."""
    skin = clip.skin
    arrays: dict[str, Any] = {
        "positions": skin.shapes,
        "rest_positions": skin.rest,
        "faces": skin.faces,
        "times": clip.times,
        "frames_per_second": clip.frames_per_second,
    }
    if skin.uv is not None:
        arrays.update(uv=skin.uv, face_uv=skin.face_uv)
    for kind in ("bones", "controls", "activations"):
        for name, values in getattr(clip, kind).items():
            arrays[f"{kind}/{name}"] = values
    with cannot_be_written(part), part.open("wb") as file:
        np.savez_compressed(file, **arrays)
