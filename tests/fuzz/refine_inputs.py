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


def ragged() -> Any:
    """Rows of unequal length."""
    return [[0.0, 0.0, 0.0], [1.0, 0.0]]


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
    "faces: a number": lambda: {"faces": 3},
    "faces: floats": lambda: {"faces": FACES.astype(float)},
    "faces: switches": lambda: {"faces": FACES.astype(bool)},
    "faces: complex": lambda: {"faces": FACES.astype(complex)},
    "faces: objects": lambda: {"faces": FACES.astype(object)},
    "faces: texts": lambda: {"faces": FACES.astype(str)},
    "faces: dates": lambda: {"faces": FACES.astype("datetime64[s]")},
    "faces: flat": lambda: {"faces": FACES.ravel()},
    "faces: quads": lambda: {"faces": rows(np.int32, 5, 4)},
    "faces: three dimensions": lambda: {"faces": FACES[None]},
    "faces: ragged": lambda: {"faces": [[0, 1, 2], [0, 1]]},
    "faces: circular": lambda: {"faces": circular()},
    "faces: negative": lambda: {"faces": changed(FACES, (0, 0), -1)},
    "faces: one too many": lambda: {"faces": changed(FACES, (0, 0), V)},
    "faces: huge": lambda: {"faces": changed(FACES.astype(np.int64), (0, 0), 2**40)},
    "faces: huge, unsigned": lambda: {"faces": changed(FACES.astype(np.uint64), (0, 0), 2**63)},
    "faces: no integer at all": lambda: {"faces": [[0, 1, 2**70]]},
    "faces: masked": lambda: {"faces": masked(FACES)},
    "faces: a mapping": lambda: {"faces": {"a": 1}},
    "positions: None": lambda: {"rest_positions": None},
    "positions: a word": lambda: {"rest_positions": "here"},
    "positions: flat": lambda: {"rest_positions": POSITIONS.ravel()},
    "positions: two columns": lambda: {"rest_positions": POSITIONS[:, :2]},
    "positions: four columns": lambda: {"rest_positions": rows(float, V, 4)},
    "positions: objects": lambda: {"rest_positions": POSITIONS.astype(object)},
    "positions: complex": lambda: {"rest_positions": POSITIONS.astype(complex)},
    "positions: switches": lambda: {"rest_positions": POSITIONS > 0},
    "positions: texts": lambda: {"rest_positions": POSITIONS.astype(str)},
    "positions: NaN": lambda: {"rest_positions": changed(POSITIONS, (2, 1), np.nan)},
    "positions: infinite": lambda: {"rest_positions": changed(POSITIONS, (2, 1), np.inf)},
    "positions: 1e300": lambda: {"rest_positions": changed(POSITIONS, (2, 1), 1e300)},
    "positions: 1e20": lambda: {"rest_positions": changed(POSITIONS, (2, 1), -1e20)},
    "positions: too small": lambda: {"rest_positions": POSITIONS * 1e-12},
    "positions: too large": lambda: {"rest_positions": POSITIONS * 1e12},
    "positions: ragged": lambda: {"rest_positions": ragged()},
    "positions: too few": lambda: {"rest_positions": POSITIONS[:3]},
    "positions: none": lambda: {"rest_positions": POSITIONS[:0]},
    "positions: masked": lambda: {"rest_positions": masked(POSITIONS)},
    "positions: circular": lambda: {"rest_positions": circular()},
    "uv: too few": lambda: {"uv": rows(float, V - 1, 2)},
    "uv: three columns": lambda: {"uv": rows(float, V, 3)},
    "uv: NaN": lambda: {"uv": np.full((V, 2), np.nan)},
    "uv: 1e300": lambda: {"uv": np.full((V, 2), 1e300)},
    "uv: texts": lambda: {"uv": rows("U3", V, 2)},
    "uv: a number": lambda: {"uv": 1.0},
    "face_uv: alone": lambda: {"face_uv": FACES},
    "face_uv: too few": lambda: {"uv": rows(float, V, 2), "face_uv": FACES[1:]},
    "face_uv: beyond": lambda: {"uv": rows(float, 3, 2), "face_uv": FACES},
    "face_uv: floats": lambda: {"uv": rows(float, V, 2), "face_uv": FACES * 1.0},
    "attributes: a list": lambda: {"attributes": [POSITIONS]},
    "attributes: one axis": lambda: {"attributes": {"x": POSITIONS[:, 0]}},
    "attributes: no columns": lambda: {"attributes": {"x": POSITIONS[:, :0]}},
    "attributes: too few": lambda: {"attributes": {"x": POSITIONS[1:]}},
    "attributes: NaN": lambda: {"attributes": {"x": POSITIONS * np.nan}},
    "attributes: texts": lambda: {"attributes": {"x": rows("U3", V, 1)}},
    "attributes: corners beyond": lambda: {"attributes": {"x": (POSITIONS[:2], FACES)}},
    "attributes: three of a pair": lambda: {"attributes": {"x": (POSITIONS, FACES, FACES)}},
    "*attributes: name is a number": lambda: {"attributes": {7: POSITIONS}},
    "*faces: none": lambda: {"faces": []},
    "*faces: unsigned bytes": lambda: {"faces": FACES.astype(np.uint8)},
    "*faces: turned memory": lambda: {"faces": np.asfortranarray(FACES)},
    "*faces: every other": lambda: {"faces": FACES[::2]},
    "*faces: other byte order": lambda: {"faces": FACES.astype(">i4")},
    "*faces: all the same": lambda: {"faces": rows(np.int32, F, 3)},
    "*positions: whole numbers": lambda: {"rest_positions": np.round(POSITIONS).astype(int)},
    "*positions: half precision": lambda: {"rest_positions": POSITIONS.astype(np.float16)},
    "*positions: other byte order": lambda: {"rest_positions": POSITIONS.astype(">f8")},
    "*positions: backwards": lambda: {"rest_positions": POSITIONS[::-1]},
    "*positions: read only": lambda: {"rest_positions": np.broadcast_to(1.0, (V, 3))},
    "*positions: long double": lambda: {"rest_positions": POSITIONS.astype(np.longdouble)},
    "*nothing": lambda: {"faces": [], "rest_positions": np.zeros((0, 3))},
}  # fmt: skip

OPTIONS: dict[str, dict[str, Any]] = {
    "threshold_once: NaN": {"threshold_once": np.nan},
    "threshold_once: infinite": {"threshold_once": np.inf},
    "threshold_once: negative": {"threshold_once": -1.0},
    "threshold_once: above twice": {"threshold_once": 0.5},
    "threshold_once: a word": {"threshold_once": "0.02"},
    "threshold_once: None": {"threshold_once": None},
    "threshold_once: complex": {"threshold_once": 1j},
    "threshold_once: an array": {"threshold_once": np.array([0.02, 0.03])},
    "threshold_once: a huge whole": {"threshold_once": 10**400},
    "threshold_twice: a huge whole": {"threshold_twice": 10**400},
    "threshold_twice: NaN": {"threshold_twice": np.nan},
    "threshold_twice: 1e300": {"threshold_twice": 1e300},
    "criterion: unknown": {"criterion": "bend"},
    "criterion: empty": {"criterion": ""},
    "criterion: no list": {"criterion": []},
    "criterion: a number": {"criterion": 3},
    "criterion: None": {"criterion": None},
    "criterion: bytes": {"criterion": b"normal"},
    "criterion: a list of numbers": {"criterion": [1, 2]},
    "criterion: circular": {"criterion": circular()},
    "scheme: unknown": {"scheme": "round"},
    "scheme: None": {"scheme": None},
    "scheme: a number": {"scheme": 1},
    "scheme: a list": {"scheme": ["loop"]},
    "scheme: an array": {"scheme": np.array(["loop", "cubic"])},
    "detail: alone": {"detail": (POSITIONS, FACES)},
    "detail: missing": {"scheme": "detail"},
    "detail: one array": {"scheme": "detail", "detail": POSITIONS},
    "detail: three": {"scheme": "detail", "detail": (POSITIONS, FACES, FACES)},
    "detail: a number": {"scheme": "detail", "detail": 1},
    "detail: a word": {"scheme": "detail", "detail": "ab"},
    "detail: no triangles": {"scheme": "detail", "detail": (POSITIONS, [])},
    "detail: NaN": {"scheme": "detail", "detail": (POSITIONS * np.nan, FACES)},
    "detail: beyond": {"scheme": "detail", "detail": (POSITIONS[:3], FACES)},
    "*detail: of no area": {"scheme": "detail", "detail": (POSITIONS * 0.0, FACES)},
    "blend: a number": {"blend": 2},
    "blend: a word": {"blend": "on"},
    "blend: an array": {"blend": np.array([True, False])},
    "blend: NaN": {"blend": np.nan},
    "blend: and coherent": {"blend": True, "coherent": True},
    "coherent: None": {"coherent": "maybe"},
    "unknown option": {"sharpness": 1},
    "levels of another": {"levels": 1},
}

STREAMS: dict[str, Callable[[], Any]] = {
    "stream: an array": lambda: POSITIONS,
    "stream: a word": lambda: "stream",
    "stream: too short": lambda: stream(vertices=rows(np.float32, 3, 6)),
    "stream: too few triangles": lambda: stream(triangles=rows(np.uint32, 3, 3)),
    "stream: too short a source": lambda: stream(source=rows(np.int32, 3)),
    "stream: too many columns": lambda: stream(vertices=rows(np.float32, 5000, 8)),
    "stream: doubles": lambda: stream(vertices=rows(float, 5000, 6)),
    "stream: signed": lambda: stream(triangles=rows(np.int32, 5000, 3)),
    "stream: unsigned source": lambda: stream(source=rows(np.uint32, 5000)),
    "stream: turned memory": lambda: stream(vertices=rows(np.float32, 6, 5000).T),
    "stream: every other": lambda: stream(triangles=rows(np.uint32, 9000, 3)[::2]),
    "stream: read only": lambda: stream(vertices=np.broadcast_to(np.float32(0), (5000, 6))),
    "stream: not aligned": lambda: stream(vertices=not_aligned()),
    "stream: other byte order": lambda: stream(vertices=rows(">f4", 5000, 6)),
    "stream: lists": lambda: stream(vertices=[[0.0] * 6] * 5000),
    "stream: None": lambda: stream(source=None),
    "stream: no source": lambda: SimpleNamespace(vertices=1, triangles=2),
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
    "a word": lambda: "here",
    "a number": lambda: 1.0,
    "too few": lambda: POSITIONS[1:],
    "too many": lambda: np.concatenate([POSITIONS, POSITIONS]),
    "none": lambda: POSITIONS[:0],
    "two columns": lambda: POSITIONS[:, :2],
    "flat": lambda: POSITIONS.ravel(),
    "three dimensions": lambda: POSITIONS[None],
    "whole numbers": lambda: POSITIONS.astype(int),
    "complex": lambda: POSITIONS.astype(complex),
    "objects": lambda: POSITIONS.astype(object),
    "texts": lambda: POSITIONS.astype(str),
    "switches": lambda: POSITIONS > 0,
    "NaN": lambda: changed(POSITIONS, (1, 2), np.nan),
    "NaN in the last": lambda: changed(POSITIONS, (-1, -1), np.nan),
    "all NaN": lambda: POSITIONS * np.nan,
    "infinite": lambda: changed(POSITIONS, (1, 2), -np.inf),
    "1e300": lambda: changed(POSITIONS, (1, 2), 1e300),
    "1e16": lambda: changed(POSITIONS, (1, 2), 1e16),
    "ragged": ragged,
    "masked": lambda: masked(POSITIONS),
    "circular": circular,
    "*1e14": lambda: changed(POSITIONS, (1, 2), 1e14),
    "*all at one place": lambda: POSITIONS * 0.0,
    "*tiny": lambda: POSITIONS * 1e-300,
    "*smallest": lambda: np.full((V, 3), 5e-324),
    "*minus zero": lambda: np.full((V, 3), -0.0),
    "*mirrored": lambda: POSITIONS * (-1, 1, 1),
    "*flat on a line": lambda: POSITIONS * (1, 0, 0),
    "*half precision": lambda: POSITIONS.astype(np.float16),
    "*single precision": lambda: POSITIONS.astype(np.float32),
    "*long double": lambda: POSITIONS.astype(np.longdouble),
    "*other byte order": lambda: POSITIONS.astype(">f4"),
    "*turned memory": lambda: np.asfortranarray(POSITIONS),
    "*backwards": lambda: POSITIONS[::-1],
    "*every other of twice": lambda: np.repeat(POSITIONS, 2, axis=0)[::2],
    "*read only": lambda: np.broadcast_to(POSITIONS[0], (V, 3)),
    "*lists": lambda: POSITIONS.tolist(),
    "*a matrix": lambda: POSITIONS.view(np.ndarray).view(np.recarray),
}

VIEWS: dict[str, Any] = {
    "view: a point": (0.0, 0.0, 5.0),
    "view: a word": "front",
    "view: two numbers": refine.View((0.0, 5.0)),
    "view: NaN": refine.View((0.0, np.nan, 5.0)),
    "view: infinite": refine.View((0.0, np.inf, 5.0)),
    "view: focal NaN": refine.View((0.0, 0.0, 5.0), np.nan),
    "view: focal negative": refine.View((0.0, 0.0, 5.0), -1.0),
    "view: focal a word": refine.View((0.0, 0.0, 5.0), "far"),  # type: ignore[arg-type]
    "view: focal huge": refine.View((0.0, 0.0, 5.0), 10**400),
    "view: ragged": refine.View(((0.0,), 0.0, 5.0)),  # type: ignore[arg-type]
    "view: None": None,
}
