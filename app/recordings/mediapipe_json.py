"""Shapes in JSON: results of MediaPipe's face landmarker, and exports of Audio2Face.

A face is a list of `{"category_name": "jawOpen", "score": 0.2}` (`categoryName` on web pages; a
score may be a text), or simply `{"jawOpen": 0.2}`. A frame holds one or several faces, under
`faceBlendshapes` or `blendshapes`, perhaps beside a time stamp and the head's matrix. A recording
is a list of frames, under `frames` or not. Other documents name shapes once, above rows of numbers:
NVIDIA's Audio2Face has `facsNames` and `weightMat`, tables have `columns` and `data`. In a third
kind, each shape has a list over time: `{"time": [0.0, 0.1], "jawOpen": [0.2, 0.3]}`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from risorius.geometry.arrays import Floats64

from .gaps import take_from_rows
from .head_pose import head_of
from .names import angle_of, shape_of
from .table import LARGEST_NUMBER, without_percent
from .take import Take, TakeRequest
from .timing import find_times, is_frame, stamp_of
from .values import is_calibrated, is_flag, rows_without_face, shares, without_rows

# Keys without capitals and underscores, see `_plain`.
FACE_KEYS = ("faceblendshapes", "blendshapes", "categories")
FRAME_KEYS = ("frames", "results", "data", "recording", "samples", "records", "weights")
RATE_KEYS = ("fps", "exportfps", "framerate")
MOST_LEVELS = 4  # nested tables that are searched for a face


def recognises(document: Any) -> bool:
    """Whether the first frames of the document have shapes."""
    return any(_faces(frame) for frame in _frames(document)[:1000])


def read(document: Any, source: str, request: TakeRequest) -> Take:
    """Return the take in the document."""
    request.refuse_face(source)
    return _take_of(_frames(document), "MediaPipe JSON", document, source, request)


def recognises_weights(document: Any) -> bool:
    """Whether the document names shapes once, above rows of weights, like Audio2Face's exports."""
    return bool(_named_rows(document))


def read_weights(document: Any, source: str, request: TakeRequest) -> Take:
    """Return the take in `{"facsNames": ["jawOpen", ...], "weightMat": [[0.2, ...], ...]}`.

    Frames may have a time and other values beside the weights: `{"weights": [0.2], "time": 0.0}`.
    """
    request.refuse_face(source)
    kind = "Audio2Face" if "facsnames" in _with_plain_keys(document) else "JSON of weights"
    return _take_of(_named_rows(document), kind, document, source, request)


def _take_of(
    frames: Sequence[Any], kind: str, document: Any, source: str, request: TakeRequest
) -> Take:
    """Return the take in frames; each frame is a table with a face, or a list of faces."""
    notes: list[str] = []
    shapes, unknown = _shapes([_faces(frame) for frame in frames], notes)
    keyed = [_values_beside_faces(frame) for frame in frames]
    times = _times(keyed, request.rate, _frame_rate(document), notes)
    head, used = head_of(keyed, notes)
    lost = rows_without_face(_keys(keyed), lambda name: _texts(keyed, name), len(frames))
    shapes = shares(without_rows(shapes, lost), notes)
    left_out = [key for key in _keys(keyed) if key not in used and _is_left_out(key)]
    return take_from_rows(
        kind,
        source,
        times,
        shapes | without_rows(head, lost),
        notes=notes,
        unknown=[*unknown, *left_out],
        is_calibrated=kind != "Audio2Face" and is_calibrated(shapes, notes),
    )


def _named_rows(document: Any) -> list[Any]:
    """Return the frames of a document that names its shapes once; [] for another document."""
    tables = _tables(document)
    listed_names = (
        "facsnames", "names", "blendshapenames", "shapenames", "keys", "channels", "columns",
        "columnnames", "header", "headers", "fields", "blendshapes", "shapes",
    )  # fmt: skip
    lists = [table.get(key) for key in listed_names for table in tables]
    names = next(filter(_are_names, lists), None)
    if names is None:
        return _frames_over_time(_columns(document))
    row_keys = ("weightmat", *FRAME_KEYS, "rows", "values")
    lists = [table.get(key) for key in row_keys for table in tables]
    rows = next((each for each in lists if isinstance(each, list) and each is not names), [])
    beside = {
        key: values
        for key, values in _columns(document).items()
        if len(values) == len(rows) and (angle_of(key) or not _is_left_out(_plain_name(key)))
    }
    return [
        {key: values[place] for key, values in beside.items()} | _named_row(names, row)
        for place, row in enumerate(rows)
    ]


def _tables(document: Any) -> list[dict[str, Any]]:
    """Return the document and the tables in it, such as a header, with plain keys."""
    keys = _with_plain_keys(document)
    return [keys, *(_with_plain_keys(item) for item in keys.values() if isinstance(item, dict))]


def _are_names(item: Any) -> bool:
    """Whether this is a list of texts, and at least one of them names a shape."""
    is_text = isinstance(item, list) and all(isinstance(each, str) for each in item)
    return is_text and any(map(shape_of, item))


def _columns(document: Any, depth: int = MOST_LEVELS) -> dict[str, list[Any]]:
    """Return name -> list over time, from a document and the tables in it.

    pandas' `to_json` writes such a list as a table whose keys are row numbers.
    """
    found: dict[str, list[Any]] = {}
    for key, item in document.items() if isinstance(document, dict) and depth else ():
        values = item
        if isinstance(item, dict) and item and all(map(str.isdecimal, item)):
            values = [*item.values()]
        if isinstance(values, list):
            if not any(isinstance(each, dict | list) for each in values):
                found.setdefault(key, values)
        else:
            found = _columns(item, depth - 1) | found
    return found


def _frames_over_time(columns: Mapping[str, list[Any]]) -> list[Any]:
    """Convert lists over time to frames, as many as the longest list of a shape has values."""
    count = max((len(values) for name, values in columns.items() if shape_of(name)), default=0)
    whole = {
        name: values for name, values in columns.items() if shape_of(name) or len(values) == count
    }
    return [
        {name: values[row] for name, values in whole.items() if row < len(values)}
        for row in range(count)
    ]


def _named_row(names: Sequence[str], row: Any) -> dict[str, Any]:
    """Return the frame of a row of weights, or of a table with weights and other keys."""
    if not isinstance(row, dict):
        cells = dict(zip(names, row if isinstance(row, list) else [], strict=False))
        shapes = {name: cell for name, cell in cells.items() if shape_of(name)}
        beside = {name: cell for name, cell in cells.items() if not shape_of(name)}
        return beside | {"blendshapes": shapes}
    frame = dict(row)
    # Names for the weights of one frame.
    weight_keys = ("weights", "values", "coefficients", "scores", *FACE_KEYS)
    for key in row:
        if _plain_name(key) in weight_keys and isinstance(row[key], list):
            del frame[key]
            frame["blendshapes"] = dict(zip(names, row[key], strict=False))
            break
    return frame


def _frames(document: Any) -> list[Any]:
    """Return the frames of a document; a document with a face of its own is one frame."""
    if isinstance(document, list):
        return [document] if document and all(map(_category, document)) else document
    if not isinstance(document, dict):
        return []
    keys = _with_plain_keys(document)
    if isinstance(keys.get("frames"), list):
        return list(keys["frames"])
    if not _faces(document, depth=1):
        for key in FRAME_KEYS:
            rows = keys.get(key)
            if isinstance(rows, list) and any(_faces(row) for row in rows[:1000]):
                return rows
    return [document]


def _faces(frame: Any, depth: int = MOST_LEVELS) -> list[dict[str, float]]:
    """Return the faces in a frame, each as written name -> score; depth: levels of tables."""
    if isinstance(frame, dict):
        plain = {key: item for key, item in frame.items() if not isinstance(item, dict | list)}
        found = {key: _number(item) for key, item in plain.items() if shape_of(key)}
        if found:
            return [found]
        keys = _with_plain_keys(frame)
        faces = _faces(_first_value(keys, FACE_KEYS), depth)
        if faces or depth <= 1:
            return faces
        inner = (_faces(item, depth - 1) for key, item in keys.items() if key not in FACE_KEYS)
        return next(filter(None, inner), [])
    if isinstance(frame, list):
        categories = [_category(item) for item in frame]
        if categories and all(categories):
            return [dict(filter(None, categories))]
        return [face for item in frame for face in _faces(item, depth)]
    return []


def _values_beside_faces(frame: Any, depth: int = MOST_LEVELS) -> dict[str, Any]:
    """Return the keys and values of a frame without its faces, also from tables with faces."""
    if isinstance(frame, list):
        frame = frame[0] if len(frame) == 1 else {}
    keys = _with_plain_keys(frame)
    found: dict[str, Any] = {}
    for key, value in keys.items():
        if shape_of(key) or key in FACE_KEYS or value in ("", None) or value == []:
            continue
        if depth > 1 and isinstance(value, dict | list) and _faces(value, depth - 1):
            found = _values_beside_faces(value, depth - 1) | found
        else:
            found[key] = value
    return found


def _is_left_out(key: str) -> bool:
    """Whether a key of frames has an unknown meaning, which the report mentions."""
    is_known = is_flag(key) or is_frame(key) or stamp_of(key) is not None
    useless_names = ("index", "id", "version", "displayname", "facelandmarks", "landmarks")
    return not (is_known or key in useless_names or key in RATE_KEYS)


def _category(item: Any) -> tuple[str, float] | None:
    """Return name, as written, and score of a category; None for another item."""
    keys = _with_plain_keys(item)
    name_keys = ("categoryname", "name", "shape", "blendshape", "key", "label")  # of a category
    name = _first_value(keys, name_keys)
    score_keys = ("score", "value", "weight")
    score = _first_value(keys, score_keys)
    is_score = score is not None and not isinstance(score, dict | list)
    return (name, _number(score)) if isinstance(name, str) and is_score else None


def _shapes(
    frames: Sequence[list[dict[str, float]]], notes: list[str]
) -> tuple[dict[str, Floats64], list[str]]:
    """Return shape -> values, (frames,), NaN for frames without a face; and unknown names."""
    if (most := max(map(len, frames), default=0)) > 1:
        notes.append(f"Up to {most} faces are in a frame; the first was used.")
    values: dict[str, Floats64] = {}
    spellings: dict[str, str] = {}
    repeated: dict[str, None] = {}
    unknown: dict[str, None] = {}
    for row, faces in enumerate(frames):
        for written, score in faces[0].items() if faces else ():
            name = shape_of(written)
            if name is None:
                if written != "_neutral":
                    unknown[written] = None
            elif spellings.setdefault(name, written) != written:
                repeated[written] = None
            else:
                values.setdefault(name, np.full(len(frames), np.nan))[row] = score
    if repeated:
        listed = ", ".join(f"'{each}'" for each in repeated)
        notes.append(f"These repeat another name, and were left out: {listed}.")
    return values, list(unknown)[:1000]


def _times(
    frames: Sequence[Mapping[str, Any]], rate: float | None, written_rate: float | None,
    notes: list[str],
) -> Floats64:  # fmt: skip
    """Return the times of frames [s], from their keys, or else from the document's rate."""

    def numbers(name: str) -> Floats64:
        return np.array([_number(frame.get(name)) for frame in frames])

    def texts(name: str) -> list[str]:
        return _texts(frames, name)

    return find_times(_keys(frames), texts, numbers, len(frames), rate, notes, written_rate)


def _keys(frames: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return all keys of frames, each key once."""
    return [*dict.fromkeys(key for frame in frames for key in frame)]


def _texts(frames: Sequence[Mapping[str, Any]], name: str) -> list[str]:
    """Return the value of each frame under a key as text; "" for lists and tables."""
    values = [frame.get(name) for frame in frames]
    is_cell = [isinstance(value, bool | int | float | str) for value in values]
    return [
        without_percent(str(value).strip()) if is_one else ""
        for value, is_one in zip(values, is_cell, strict=True)
    ]


def _frame_rate(document: Any) -> float | None:
    """Return the frames per second in the document or its header; None if there are none."""
    rates = [_number(_first_value(table, RATE_KEYS)) for table in _tables(document)]
    return next((rate for rate in rates if 1.0 <= rate <= 1000.0), None)


def _with_plain_keys(item: Any) -> dict[str, Any]:
    """Return a table with keys without capitals and underscores; {} for any other item."""
    if not isinstance(item, dict):
        return {}
    return {_plain_name(key): value for key, value in item.items()}


def _plain_name(key: str) -> str:
    return key.casefold().replace("_", "")


def _first_value(keys: Mapping[str, Any], names: Sequence[str]) -> Any:
    """Return the value of the first name that exists, or None if no name exists."""
    return next((keys[name] for name in names if name in keys), None)


def _number(value: Any) -> float:
    """Read a number, also in quotes or with a percent sign; NaN for any other value."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return math.nan
    try:
        number = float(without_percent(value.strip()) if isinstance(value, str) else value)
    except (ValueError, OverflowError):
        return math.nan
    return number if abs(number) < LARGEST_NUMBER else math.nan
