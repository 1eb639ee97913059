"""Shapes in JSON: what MediaPipe's face landmarker answers, and what Audio2Face exports.

A face is a list of `{"category_name": "jawOpen", "score": 0.2}` (`categoryName` on web pages; a
score may be a text), or simply `{"jawOpen": 0.2}`. A frame holds one or several of them, under
`faceBlendshapes` or `blendshapes`, perhaps beside a time stamp and the head's matrix. A recording
is a list of frames, under `frames` or not. NVIDIA's Audio2Face has `facsNames` and rows of
`weightMat`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .gaps import whole_take
from .named_columns import is_calibrated, shares
from .names import HEAD_ANGLES, shape_of
from .table import LARGEST
from .take import Array, Request, Take
from .timing import find_times

# All without capitals and underscores, see `_plain`.
FACES = ("faceblendshapes", "blendshapes", "categories")
MATRICES = ("facialtransformationmatrixes", "facialtransformationmatrices", "matrix")
RATES = ("fps", "exportfps")


def recognises(document: Any) -> bool:
    """Whether there are shapes in the first frames of the document."""
    return any(_faces(frame) for frame in _frames(document)[:1000])


def read(document: Any, source: str, request: Request) -> Take:
    """The take in the document."""
    request.refuse_face(source)
    notes: list[str] = []
    frames = _frames(document)
    shapes, unknown = _shapes([_faces(frame) for frame in frames], notes)
    keyed = [_plain(frame) for frame in frames]
    times = _times(keyed, request.rate, _rate(document), notes)
    shapes = shares(shapes, notes)
    return whole_take(
        "MediaPipe JSON",
        source,
        times,
        shapes | _head(keyed),
        notes=notes,
        unknown=unknown,
        is_calibrated=is_calibrated(shapes, notes),
    )


def recognises_weights(document: Any) -> bool:
    """Whether the document is what Audio2Face exports."""
    keys = _plain(document)
    return all(isinstance(keys.get(name), list) for name in ("facsnames", "weightmat"))


def read_weights(document: Any, source: str, request: Request) -> Take:
    """The take in `{"facsNames": ["jawOpen", ...], "weightMat": [[0.2, ...], ...]}`."""
    request.refuse_face(source)
    keys, notes = _plain(document), list[str]()
    rows = [row if isinstance(row, list) else [] for row in keys["weightmat"]]
    found: dict[str, Array] = {}
    unknown = []
    for place, name in enumerate(map(str, keys["facsnames"])):
        if shape := shape_of(name):
            found[shape] = np.array([_number(dict(enumerate(row)).get(place)) for row in rows])
        else:
            unknown.append(name)
    times = _times([{}] * len(rows), request.rate, _rate(document), notes)
    shapes = shares(found, notes)
    return whole_take("Audio2Face", source, times, shapes, notes=notes, unknown=unknown)


def _frames(document: Any) -> list[Any]:
    """What stands for the frames."""
    if isinstance(document, dict):
        frames = _plain(document).get("frames")
        return frames if isinstance(frames, list) else [document]
    if isinstance(document, list):
        return [document] if document and all(map(_category, document)) else document
    return []


def _faces(frame: Any) -> list[dict[str, float]]:
    """Name as it is written -> score of each face in what stands for a frame."""
    if isinstance(frame, dict):
        plain = {key: item for key, item in frame.items() if not isinstance(item, dict | list)}
        found = {key: _number(item) for key, item in plain.items() if shape_of(key)}
        return [found] if found else _faces(_first(_plain(frame), FACES))
    if isinstance(frame, list):
        categories = [_category(item) for item in frame]
        if categories and all(categories):
            return [dict(filter(None, categories))]
        return [face for item in frame for face in _faces(item)]
    return []


def _category(item: Any) -> tuple[str, float] | None:
    """Name and score, where the item is one category; the name is as written."""
    keys = _plain(item)
    name, score = keys.get("categoryname"), keys.get("score")
    return (name, _number(score)) if isinstance(name, str) and score is not None else None


def _shapes(
    frames: Sequence[list[dict[str, float]]], notes: list[str]
) -> tuple[dict[str, Array], list[str]]:
    """Shape -> values, shape (frames,), NaN where there is no face; and names that none has."""
    if (most := max(map(len, frames), default=0)) > 1:
        notes.append(f"Up to {most} faces are in a frame; the first was taken.")
    values, unknown = dict[str, Array](), dict[str, None]()
    for row, faces in enumerate(frames):
        for written, score in faces[0].items() if faces else ():
            name = shape_of(written)
            if name is not None:
                values.setdefault(name, np.full(len(frames), np.nan))[row] = score
            elif written != "_neutral":
                unknown[written] = None
    return values, list(unknown)[:1000]


def _head(frames: Sequence[Mapping[str, Any]]) -> dict[str, Array]:
    """The head's angles from MediaPipe's 4 x 4 matrices; x to the subject's left, y up, z ahead."""
    angles = np.full((3, len(frames)), np.nan)
    for row, frame in enumerate(frames):
        matrix = _matrix(_first(frame, MATRICES))
        if matrix is not None:
            ahead = matrix[:, 2] / (np.linalg.norm(matrix[:, 2]) or 1.0)
            angles[0, row] = math.degrees(math.atan2(ahead[0], ahead[2]))
            angles[1, row] = math.degrees(math.asin(max(-1.0, min(1.0, ahead[1]))))
            angles[2, row] = math.degrees(math.atan2(matrix[0, 1], matrix[1, 1]))
    return dict(zip(HEAD_ANGLES, angles, strict=True)) if np.isfinite(angles).any() else {}


def _matrix(value: Any) -> Array | None:
    """The rotation, shape (3, 3), in 4 rows, or in 16 numbers by columns, as pages have them."""
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, dict):
        value = value.get("data")
    try:
        matrix = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return None
    if matrix.shape not in ((4, 4), (16,)) or not np.isfinite(matrix).all():
        return None
    return (matrix if matrix.ndim == 2 else matrix.reshape(4, 4).T)[:3, :3]


def _times(
    frames: Sequence[Mapping[str, Any]], rate: float | None, written_rate: float | None,
    notes: list[str],
) -> Array:  # fmt: skip
    """Times of the frames, by their keys, else by the rate that the document has."""
    names = dict.fromkeys(key for frame in frames for key, value in frame.items() if value != "")

    def texts(name: str) -> list[str]:
        values = [frame.get(name) for frame in frames]
        return [value.strip() if isinstance(value, str) else "" for value in values]

    def numbers(name: str) -> Array:
        return np.array([_number(frame.get(name)) for frame in frames])

    return find_times([*names], texts, numbers, len(frames), rate, notes, written_rate)


def _rate(document: Any) -> float | None:
    """The frames a second that the document has."""
    rate = _number(_first(_plain(document), RATES))
    return rate if 1.0 <= rate <= 1000.0 else None


def _plain(item: Any) -> dict[str, Any]:
    """A table under keys without capitals and underscores; an empty one for what is none."""
    if not isinstance(item, dict):
        return {}
    return {key.casefold().replace("_", ""): value for key, value in item.items()}


def _first(keys: Mapping[str, Any], names: Sequence[str]) -> Any:
    """The value under the first of the names that is there; None where none is."""
    return next((keys[name] for name in names if name in keys), None)


def _number(value: Any) -> float:
    """A number, also one in quotes; NaN for what is none."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return math.nan
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return math.nan
    return number if abs(number) < LARGEST else math.nan
