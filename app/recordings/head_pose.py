"""Read the head's rotation in JSON files of shapes: named angles, quaternions, matrices.

Three numbers without names are not read, because programs disagree about their order. Axes of
quaternions and matrices are MediaPipe's: x to the subject's left, y up, z ahead.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from risorius.geometry.arrays import Floats64
from risorius.geometry.transforms import angles_of

from .angles import in_degrees
from .names import HEAD_ANGLES, angle_of, letters_of

MATRIX_KEYS = ("facialtransformationmatrixes", "facialtransformationmatrices", "matrix")
POSE_KEY = re.compile(
    r"(head|face|facial)?(rotations?|pose|angles?|euler(angles?)?|orientation|quat(ernion)?"
    r"|transform(ation)?(matrix)?|matrix)$|head$"
)
ANGLE_NAME = re.compile(
    r"(?:head)?(yaw|pitch|roll)(?:angle)?(?:in)?(?:deg(?:rees)?|rad(?:ians)?)?$"
)


def is_pose(key: str) -> bool:
    """Whether a key, without capitals and underscores, may hold the turn of the head."""
    return key in MATRIX_KEYS or bool(POSE_KEY.match(key))


def head_of(
    frames: Sequence[Mapping[str, Any]], notes: list[str]
) -> tuple[dict[str, Floats64], set[str]]:
    """Return angles of head and eyes [degrees], each of shape (frames,), and their keys.

    frames: keys without capitals and underscores -> values.
    """
    named = _named_angles(frames)
    if named:
        found, used = named
        notes.append(
            "Angles were assumed to grow downward and to the subject's right, as in ARKit."
        )
        return in_degrees(found, {}, notes), used
    keys = dict.fromkeys(key for frame in frames for key in frame if is_pose(key))
    for key in sorted(keys, key=lambda key: key not in MATRIX_KEYS):
        values = [frame.get(key) for frame in frames]
        matrices = [_matrix(value) for value in values]
        if all(matrix is None for matrix in matrices):
            matrices = _matrices_of_quaternions(values, key, notes)
        if any(matrix is not None for matrix in matrices):
            unknown = (math.nan, math.nan, math.nan)
            turns = [unknown if matrix is None else angles_of(matrix) for matrix in matrices]
            angles = np.array(turns).T
            return dict(zip(HEAD_ANGLES, angles, strict=True)), {key}
    return {}, set()


def _named_angles(
    frames: Sequence[Mapping[str, Any]],
) -> tuple[dict[str, Floats64], set[str]] | None:
    """Return named angles in the file's units, beside shapes or in a table, and their keys."""
    found: dict[str, Floats64] = {}
    used: set[str] = set()
    for row, frame in enumerate(frames):
        for key, value in frame.items():
            if isinstance(value, dict) and is_pose(key):
                inner = {letters_of(each): angle for each, angle in value.items()}
                if not any(ANGLE_NAME.match(each) for each in inner):
                    continue
            elif ANGLE_NAME.match(key) or angle_of(key):
                inner = {key: value}
            else:
                continue
            for each, angle in inner.items():
                match = ANGLE_NAME.match(each)
                name = f"head_{match[1]}" if match else angle_of(each)
                if name is None or not _is_number(angle):
                    continue
                used.add(key)
                found.setdefault(name, np.full(len(frames), np.nan))[row] = float(angle)
    return (found, used) if found else None


def _matrices_of_quaternions(
    values: Sequence[Any], key: str, notes: list[str]
) -> list[Floats64 | None]:
    """Convert quaternions to rotation matrices; None for a value that is not a quaternion."""
    quaternions = [_quaternion(value) for value in values]
    known = np.array([each for each in quaternions if each is not None])
    if not len(known):
        return [None] * len(values)
    has_names = any(isinstance(value, dict) for value in values)
    # A head is never upside down, so the scalar is the largest number.
    is_scalar_first = not has_names and bool(
        np.median(np.abs(known[:, 0])) > np.median(np.abs(known[:, 3]))
    )
    order = "w, x, y, z" if is_scalar_first else "x, y, z, w"
    notes.append(
        f"'{key}' was read as quaternions {order}, with x to the subject's left, y up and z ahead."
    )
    roll = -1 if is_scalar_first else 0
    matrices: list[Floats64 | None] = []
    for each in quaternions:
        if each is None:
            matrices.append(None)
        else:
            rotation = Rotation.from_quat(np.roll(each, roll))
            matrices.append(np.asarray(rotation.as_matrix()))
    return matrices


def _quaternion(value: Any) -> Floats64 | None:
    """Return the four numbers of a quaternion in their written order, or None."""
    if isinstance(value, dict):
        parts = {letters_of(each).removeprefix("q"): number for each, number in value.items()}
        value = [parts.get(each) for each in "xyzw"]
    if not isinstance(value, list) or len(value) != 4 or not all(map(_is_number, value)):
        return None
    found = np.array(value, dtype=np.float64)
    return found if 0.9 < float(np.linalg.norm(found)) < 1.1 else None


def _matrix(value: Any) -> Floats64 | None:
    """Read a rotation, shape (3, 3), from 3 or 4 rows, or from 16 numbers by columns; or None."""
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, dict):
        value = value.get("data")
    try:
        matrix = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return None
    if matrix.shape not in ((4, 4), (16,), (3, 3)) or not np.isfinite(matrix).all():
        return None
    return (matrix if matrix.ndim == 2 else matrix.reshape(4, 4).T)[:3, :3]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e30
