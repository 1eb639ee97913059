"""Arrays and options for refiners: rows of `create` and of `refine`, by name.

A row of CREATE changes the arguments of a good call, one of FRAMES makes the arguments of a frame.
A name with a star is of something odd that is accepted.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np

from risorius import refine
from tests.meshes import irregular

MESH = irregular(1, columns=5, rows=4, holes=1)
FACES, POSITIONS = MESH.faces, MESH.vertices
V, F = len(POSITIONS), len(FACES)


def changed(array: Any, place: Any, value: Any) -> Any:
    """A copy with one entry changed."""
    copy = np.array(array)
    copy[place] = value
    return copy


def masked(array: Any) -> Any:
    """An array with one entry masked."""
    mask = np.zeros(array.shape, bool)
    mask[0, 0] = True
    return np.ma.masked_array(array, mask)


def circular() -> Any:
    """A list that holds itself."""
    endless: list[Any] = []
    endless.append(endless)
    return endless


def rows(dtype: Any, *shape: int) -> Any:
    """An array of a shape and type."""
    return np.zeros(shape, dtype)


MESHES: dict[str, Callable[[], dict[str, Any]]] = {
    "faces: None": lambda: {"faces": None},
    "faces: a word": lambda: {"faces": "faces"},
    "faces: floats": lambda: {"faces": FACES.astype(float)},
    "faces: quads": lambda: {"faces": rows(np.int32, 5, 4)},
    "faces: negative": lambda: {"faces": changed(FACES, (0, 0), -1)},
    "faces: huge": lambda: {"faces": changed(FACES.astype(np.int64), (0, 0), 2**40)},
    "faces: no integer at all": lambda: {"faces": [[0, 1, 2**70]]},
    "faces: masked": lambda: {"faces": masked(FACES)},
    "positions: two columns": lambda: {"rest_positions": POSITIONS[:, :2]},
    "positions: NaN": lambda: {"rest_positions": changed(POSITIONS, (2, 1), np.nan)},
    "positions: too large": lambda: {"rest_positions": POSITIONS * 1e12},
    "positions: too few": lambda: {"rest_positions": POSITIONS[:3]},
    "positions: masked": lambda: {"rest_positions": masked(POSITIONS)},
    "uv: too few": lambda: {"uv": rows(float, V - 1, 2)},
    "face_uv: alone": lambda: {"face_uv": FACES},
    "face_uv: beyond": lambda: {"uv": rows(float, 3, 2), "face_uv": FACES},
    "attributes: a list": lambda: {"attributes": [POSITIONS]},
    "attributes: NaN": lambda: {"attributes": {"x": POSITIONS * np.nan}},
    "attributes: corners beyond": lambda: {"attributes": {"x": (POSITIONS[:2], FACES)}},
    "*attributes: name is a number": lambda: {"attributes": {7: POSITIONS}},
    "*faces: none": lambda: {"faces": []},
    "*faces: unsigned bytes": lambda: {"faces": FACES.astype(np.uint8)},
    "*faces: other byte order": lambda: {"faces": FACES.astype(">i4")},
    "*faces: all the same": lambda: {"faces": rows(np.int32, F, 3)},
    "*positions: whole numbers": lambda: {"rest_positions": np.round(POSITIONS).astype(int)},
    "*positions: read only": lambda: {"rest_positions": np.broadcast_to(1.0, (V, 3))},
    "*nothing": lambda: {"faces": [], "rest_positions": np.zeros((0, 3))},
}  # fmt: skip

OPTIONS: dict[str, dict[str, Any]] = {
    "threshold_once: NaN": {"threshold_once": np.nan},
    "threshold_once: negative": {"threshold_once": -1.0},
    "threshold_once: above twice": {"threshold_once": 0.5},
    "threshold_once: a huge whole": {"threshold_once": 10**400},
    "threshold_twice: 1e300": {"threshold_twice": 1e300},
    "criterion: unknown": {"criterion": "bend"},
    "criterion: circular": {"criterion": circular()},
    "scheme: unknown": {"scheme": "round"},
    "scheme: an array": {"scheme": np.array(["loop", "cubic"])},
    "detail: alone": {"detail": (POSITIONS, FACES)},
    "detail: missing": {"scheme": "detail"},
    "detail: no triangles": {"scheme": "detail", "detail": (POSITIONS, [])},
    "detail: beyond": {"scheme": "detail", "detail": (POSITIONS[:3], FACES)},
    "*detail: of no area": {"scheme": "detail", "detail": (POSITIONS * 0.0, FACES)},
    "blend: a number": {"blend": 2},
    "blend: and coherent": {"blend": True, "coherent": True},
    "unknown option": {"sharpness": 1},
    "levels of another": {"levels": 1},
}

STREAMS: dict[str, Callable[[], Any]] = {
    "stream: an array": lambda: POSITIONS,
    "stream: too short": lambda: stream(vertices=rows(np.float32, 3, 6)),
    "stream: too short a source": lambda: stream(source=rows(np.int32, 3)),
    "stream: doubles": lambda: stream(vertices=rows(float, 5000, 6)),
    "stream: every other": lambda: stream(triangles=rows(np.uint32, 9000, 3)[::2]),
    "stream: read only": lambda: stream(vertices=np.broadcast_to(np.float32(0), (5000, 6))),
    "stream: not aligned": lambda: stream(vertices=not_aligned()),
    "stream: None": lambda: stream(source=None),
}


def stream(**arrays: Any) -> Any:
    """A stream with room for every frame, but for what is given."""
    good = {
        "vertices": rows(np.float32, 5000, 6),
        "triangles": rows(np.uint32, 5000, 3),
        "source": rows(np.int32, 5000),
    }
    return SimpleNamespace(**{**good, **arrays})


def not_aligned() -> Any:
    """Rows that begin at an odd address."""
    return np.zeros(5000 * 24 + 1, np.uint8)[1:].view(np.float32).reshape(5000, 6)


FRAMES: dict[str, Callable[[], Any]] = {
    "None": lambda: None,
    "too few": lambda: POSITIONS[1:],
    "two columns": lambda: POSITIONS[:, :2],
    "whole numbers": lambda: POSITIONS.astype(int),
    "NaN": lambda: changed(POSITIONS, (1, 2), np.nan),
    "infinite": lambda: changed(POSITIONS, (1, 2), -np.inf),
    "1e300": lambda: changed(POSITIONS, (1, 2), 1e300),
    "masked": lambda: masked(POSITIONS),
    "*1e14": lambda: changed(POSITIONS, (1, 2), 1e14),
    "*all at one place": lambda: POSITIONS * 0.0,
    "*smallest": lambda: np.full((V, 3), 5e-324),
    "*flat on a line": lambda: POSITIONS * (1, 0, 0),
    "*other byte order": lambda: POSITIONS.astype(">f4"),
    "*every other of twice": lambda: np.repeat(POSITIONS, 2, axis=0)[::2],
    "*read only": lambda: np.broadcast_to(POSITIONS[0], (V, 3)),
    "*a matrix": lambda: POSITIONS.view(np.ndarray).view(np.recarray),
}

VIEWS: dict[str, Any] = {
    "view: a point": (0.0, 0.0, 5.0),
    "view: two numbers": refine.View((0.0, 5.0)),
    "view: NaN": refine.View((0.0, np.nan, 5.0)),
    "view: focal negative": refine.View((0.0, 0.0, 5.0), -1.0),
}
