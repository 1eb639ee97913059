"""A clip as numpy arrays, in millimetres: for whoever goes on in Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .clip import Clip, Surface
from .formats import Request


def write_npz(clip: Clip, part: Path, _: Request) -> None:
    """Write what a clip holds; docs/export.md lists the names."""
    arrays: dict[str, Any] = {
        "positions": clip.skin.shapes,
        "rest_positions": clip.skin.rest,
        "faces": clip.skin.faces,
        "times": clip.times,
        "frames_per_second": clip.frames_per_second,
        **{name: array for name, array in _rest_of(clip.skin).items() if name.endswith("uv")},
    }
    for surface in clip.surfaces[1:]:
        arrays[f"parts/{surface.name}/rest_positions"] = surface.rest
        arrays[f"parts/{surface.name}/faces"] = surface.faces
        for name, array in _rest_of(surface).items():
            arrays[f"parts/{surface.name}/{name}"] = array
    for kind in ("bones", "controls", "activations"):
        for name, values in getattr(clip, kind).items():
            arrays[f"{kind}/{name}"] = values
    with part.open("wb") as file:
        np.savez_compressed(file, **arrays)


def _rest_of(surface: Surface) -> dict[str, Any]:
    """What not every surface has, by name."""
    names = ("shapes", "matrices", "colours", "uv", "face_uv")
    own = {name: getattr(surface, name) for name in names}
    return {name: array for name, array in own.items() if array is not None}
