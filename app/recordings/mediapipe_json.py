"""Shapes in JSON: what MediaPipe's face landmarker answers, as programs and web pages write it.

A picture is a list of `{"category_name": "jawOpen", "score": 0.2}` (also `categoryName` or `name`;
scores may be texts), or simply `{"jawOpen": 0.2}`. A recording is a list of those, or of frames
`{"timestamp": 33, "faceBlendshapes": ...}`, under "frames" or not; or one list of numbers for each
shape; or `facsNames` with rows of `weightMat`, as NVIDIA's Audio2Face exports.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..errors import UserError
from .faces import only_one
from .gaps import whole_take
from .named_columns import is_calibrated, shares
from .names import HEAD_ANGLES
from .request import Request
from .spelling import shape_of
from .table import LARGEST
from .take import Array, Take
from .timing import FRAMES, STAMPS, frame_times, stamp_times

NAMES = ("category_name", "categoryName", "name")  # of a category
SCORES = ("score", "value", "weight")
# The other keys without capitals and underscores.
LISTS = ("frames", "results", "data", "recording", "samples")
SHAPES = ("blendshapes", "faceblendshapes", "categories", "shapes", "weights", "scores", "arkit",
          "coefficients", "values")  # fmt: skip
MATRICES = ("facialtransformationmatrixes", "facialtransformationmatrices", "matrix", "transform",
            "facialtransformationmatrix")  # fmt: skip
RATES = ("fps", "framerate", "exportfps", "samplerate")
TIMES = tuple(dict.fromkeys(name.replace("_", "") for name in STAMPS))
NUMBERS = tuple(dict.fromkeys(name.replace("_", "") for name in FRAMES))
SHAPE_ROWS = (("facsnames", "weightmat"), ("names", "weights"), ("blendshapenames", "weights"))
Shapes = dict[str, float]


def recognises(document: Any) -> bool:
    """Whether there are shapes in the first frames of the document."""
    if _columns(document) is not None:
        return True
    frames, _ = _frames(document)
    return any(_faces(frame) for frame in frames[:1000])


def read(document: Any, source: str, request: Request) -> Take:
    """The take in the document."""
    notes: list[str] = []
    unknown: list[str] = []
    table = _columns(document)
    if table is not None:
        only_one(source, request)
        shapes, stamps, given = table
    else:
        frames, given = _frames(document)
        faces = [_faces(frame) for frame in frames]
        shapes = _channels(faces, _index_of_face(faces, source, request, notes), unknown)
        keyed = [_keys(frame) if isinstance(frame, dict) else {} for frame in frames]
        stamps = {
            key: np.array([_number(keys.get(key)) for keys in keyed])
            for key in (*TIMES, *NUMBERS)
            if any(key in keys for keys in keyed)
        }
        shapes |= _head(keyed)
    count = len(next(iter(shapes.values())))
    times = _times(stamps, count, request.rate, given, notes)
    head = {name: values for name, values in shapes.items() if name in HEAD_ANGLES}
    shapes = shares({name: values for name, values in shapes.items() if name not in head}, notes)
    return whole_take(
        "MediaPipe JSON" if table is None else "JSON of shapes",
        source,
        times,
        shapes | head,
        notes=notes,
        unknown=unknown,
        is_calibrated=is_calibrated(shapes, notes),
    )


def _frames(document: Any) -> tuple[list[Any], float | None]:
    """What stands for the frames, and the frame rate where the document tells it."""
    if isinstance(document, dict):
        keys = _keys(document)
        rate = _number(_first(keys, RATES))
        given = rate if 1.0 <= rate <= 1000.0 else None
        frames = _first(keys, LISTS)
        if isinstance(frames, list):
            return frames, given
        shapes = _first(keys, SHAPES)
        if isinstance(shapes, list) and shapes and _category(shapes[0]) is None:
            return shapes, given
        return [document], given
    if isinstance(document, list):
        is_picture = bool(document) and all(_category(item) is not None for item in document)
        return ([document] if is_picture else document), None
    return [], None


def _faces(value: Any) -> list[Shapes]:
    """The shapes of each face in what stands for a frame."""
    if isinstance(value, dict):
        found = {
            shape: number
            for key, item in value.items()
            if not isinstance(item, dict | list)
            and (shape := shape_of(key))
            and math.isfinite(number := _number(item))
        }
        return [found] if found else _faces(_first(_keys(value), SHAPES))
    if isinstance(value, list):
        categories = [_category(item) for item in value]
        if categories and all(category is not None for category in categories):
            return [{name: score for name, score in filter(None, categories)}]
        return [face for item in value for face in _faces(item)]
    return []


def _category(item: Any) -> tuple[str, float] | None:
    """Name and score, where the item is one category; the name is as written."""
    if not isinstance(item, dict):
        return None
    name = next((item[key] for key in NAMES if key in item), None)
    score = next((item[key] for key in SCORES if key in item), None)
    if not isinstance(name, str) or not isinstance(score, str | int | float):
        return None
    return name, _number(score)


def _index_of_face(
    faces: Sequence[list[Shapes]], source: str, request: Request, notes: list[str]
) -> int:
    """Which face of each frame is taken: they are counted from 0."""
    most = max(len(each) for each in faces)
    if request.face is None:
        if most > 1:
            notes.append(f"Up to {most} faces are in a frame; taken was '0', the first.")
        return 0
    if request.face not in [str(number) for number in range(most)]:
        listed = ", ".join(f"'{number}'" for number in range(most))
        raise UserError(f"{source}: no face '{request.face}'; in it are {listed}")
    return int(request.face)


def _channels(faces: Sequence[list[Shapes]], face: int, unknown: list[str]) -> dict[str, Array]:
    """Shape -> values, shape (frames,), NaN where there is no face."""
    values: dict[str, Array] = {}
    for row, several in enumerate(faces):
        if face >= len(several):
            continue
        for spelled, score in several[face].items():
            name = shape_of(spelled)
            if name is None:
                if spelled not in unknown and spelled != "_neutral" and len(unknown) < 1000:
                    unknown.append(spelled)
                continue
            if name not in values:
                values[name] = np.full(len(faces), np.nan)
            values[name][row] = score
    return values


def _columns(
    document: Any,
) -> tuple[dict[str, Array], dict[str, Array], float | None] | None:
    """Shapes, time stamps and rate of a document that lists numbers; None for another one."""
    if not isinstance(document, dict):
        return None
    _, rate = _frames(document)
    keys = _keys(document)
    for names_key, rows_key in SHAPE_ROWS:
        names, rows = keys.get(names_key), keys.get(rows_key)
        if isinstance(names, list) and isinstance(rows, list) and rows:
            shapes = {}
            for place, name in enumerate(names):
                if isinstance(name, str) and (shape := shape_of(name)):
                    shapes[shape] = np.array(
                        [
                            _number(row[place])
                            if isinstance(row, list) and place < len(row)
                            else math.nan
                            for row in rows
                        ]
                    )
            if shapes:
                return shapes, {}, rate
    inner = _first(keys, SHAPES)
    columns = inner if isinstance(inner, dict) else document
    lists = {
        shape: values
        for key, values in columns.items()
        if isinstance(values, list) and values and (shape := shape_of(key))
    }
    if not lists or any(isinstance(item, dict | list) for item in next(iter(lists.values()))):
        return None
    count = min(len(values) for values in lists.values())
    stamps = {
        key: np.array([_number(value) for value in values[:count]])
        for key, values in _keys(document | columns).items()
        if isinstance(values, list) and key in (*TIMES, *NUMBERS) and len(values) >= count
    }
    shapes = {
        shape: np.array([_number(value) for value in values[:count]])
        for shape, values in lists.items()
    }
    return shapes, stamps, rate


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
    """The rotation, shape (3, 3), in 16 numbers by rows, or by columns as pages have them."""
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, dict):
        value = value.get("data")
    if isinstance(value, list) and len(value) == 4:
        value = [number for row in value if isinstance(row, list) for number in row]
    if not isinstance(value, list) or len(value) != 16:
        return None
    matrix = np.array([_number(number) for number in value]).reshape(4, 4)
    if not np.isfinite(matrix).all():
        return None
    is_by_columns = not matrix[:3, 3].any() and bool(matrix[3, :3].any())
    return (matrix.T if is_by_columns else matrix)[:3, :3]


def _times(
    stamps: Mapping[str, Array], count: int, rate: float | None, given: float | None,
    notes: list[str],
) -> Array:  # fmt: skip
    """Times from the stamps of the frames, else from the rate."""
    if rate is None:
        for key in TIMES:
            if key in stamps and (times := stamp_times(stamps[key], notes)) is not None:
                return times
    if given is not None and rate is None:
        notes.append(f"{given:g} frames a second, as the file says.")
    frame = next((stamps[key] for key in NUMBERS if key in stamps), None)
    return frame_times(frame, count, rate or given, notes)


def _keys(item: Mapping[str, Any]) -> dict[str, Any]:
    """The same under keys without capitals and underscores."""
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
