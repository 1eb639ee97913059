"""Texture coordinates and attributes: the values of triangle corners besides positions.

They are checked and joined into one table, with one row for each distinct corner. They are copied,
so that later changes to the caller's arrays have no effect.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32, Integers64
from ..mesh.validation import as_array, checked_indices

AttributeLike = npt.ArrayLike | tuple[npt.ArrayLike, npt.ArrayLike]
"""Values of each vertex, shape (V, k), or values (A, k) and the row of each corner (F, 3)."""


class Values(TypedDict, total=False):
    """The arguments of all built-in refiners besides the mesh (see `registry.create`).

    A refiner that takes them has `**values: Unpack[Values]` in its signature.
    """

    uv: npt.ArrayLike | None
    """Texture coordinates, shape (U, 2)."""
    face_uv: npt.ArrayLike | None
    """The texture coordinate of each corner, shape (F, 3)."""
    attributes: Mapping[str, AttributeLike] | None
    """Other values of vertices or corners, by name."""
    crease_angle: float | None
    """Edges whose two triangles form a larger angle than this at rest [degrees] stay sharp; None:
    none.
    """


@dataclass(frozen=True)
class CornerValues:
    """Texture coordinates and attributes side by side: one row per distinct corner."""

    values: Floats32
    """Shape (A, k)."""
    corners: Integers64 | None
    """Row of every corner, shape (F, 3); None if vertex v has row v."""
    columns: Mapping[str, slice]
    """The columns of each attribute among the k columns."""
    has_uv: bool
    """Whether the first two columns are texture coordinates."""
    own_rows: Mapping[str, Integers64 | None]
    """For each attribute: the row of its own array that each row of the table shows, (A,); None:
    the same row.
    """
    own_lengths: Mapping[str, int]
    """For each attribute: the number of rows of its own array."""


def checked_corner_values(
    faces: Integers64,
    vertex_count: int,
    *,
    uv: npt.ArrayLike | None = None,
    face_uv: npt.ArrayLike | None = None,
    attributes: Mapping[str, AttributeLike] | None = None,
) -> CornerValues | None:
    """Join texture coordinates and attributes into one table; None if there are none."""
    if uv is None and face_uv is not None:
        raise ValueError("face_uv points into uv, but uv is None; pass both or neither")
    tables: list[Floats32] = []
    indices: list[Integers64 | None] = []
    columns: dict[str, slice] = {}
    lengths: dict[str, int] = {}
    if uv is not None:
        values, corners = _checked_values("uv", uv, "face_uv", face_uv, faces, vertex_count)
        if values.shape[1] != 2:
            raise ValueError(f"uv must be numbers of shape (U, 2), got shape {values.shape}")
        tables = [values]
        indices = [corners]
    if attributes is not None and not isinstance(attributes, Mapping):
        raise ValueError(
            "attributes must be arrays by name, as in {'colour': array of shape (V, 3)}, "
            f"got {type(attributes).__name__}"
        )
    for name, given in (attributes or {}).items():
        what = f"attributes[{name!r}]"
        pair = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
        values, corners = _checked_values(what, pair[0], f"{what}[1]", pair[1], faces, vertex_count)
        start = sum(table.shape[1] for table in tables)
        columns[name] = slice(start, start + values.shape[1])
        lengths[name] = len(values)
        tables.append(values)
        indices.append(corners)
    if not tables:
        return None
    has_uv = uv is not None
    if all(corners is None for corners in indices):
        joined = np.concatenate(tables, axis=1)
        return CornerValues(
            values=joined,
            corners=None,
            columns=columns,
            has_uv=has_uv,
            own_rows=dict.fromkeys(columns),
            own_lengths=lengths,
        )
    rows = np.stack([faces if corners is None else corners for corners in indices], axis=2)
    different, number = _different_rows(rows.reshape(-1, len(tables)))
    table = [values[different[:, k]] for k, values in enumerate(tables)]
    own_rows = {name: different[:, has_uv + k] for k, name in enumerate(columns)}
    return CornerValues(
        values=np.concatenate(table, axis=1),
        corners=number.reshape(-1, 3),
        columns=columns,
        has_uv=has_uv,
        own_rows=own_rows,
        own_lengths=lengths,
    )


def _different_rows(rows: Integers64) -> tuple[Integers64, Integers64]:
    """Return the different rows of (n, k) numbers from 0 on, sorted, and the number of each row.

    `np.unique` of rows takes four times as long, because it compares them byte by byte.
    """
    first = np.zeros(1, np.int64)
    number = np.zeros(len(rows), np.int64)
    for column in rows.T:
        pairs = number * (column.max(initial=0) + 1) + column
        _, first, number = np.unique(pairs, return_index=True, return_inverse=True)
    return rows[first], number


def _checked_values(
    what: str,
    values: npt.ArrayLike,
    what_corners: str,
    corners: npt.ArrayLike | None,
    faces: Integers64,
    vertex_count: int,
) -> tuple[Floats32, Integers64 | None]:
    wanted = "numbers of shape " + (
        "(U, 2)" if what == "uv" else "(V, k), or a tuple of such values and the row of each corner"
    )
    array = as_array(what, values, wanted)
    if array.ndim != 2 or array.shape[1] == 0 or array.dtype.kind not in "fiu":
        raise ValueError(f"{what} must be {wanted}, got {array.dtype} of shape {array.shape}")
    with np.errstate(over="ignore"):
        table = np.array(array, dtype=np.float32)
    is_finite = np.isfinite(table).all(axis=1)
    if not is_finite.all():
        bad = int(is_finite.argmin())
        raise ValueError(
            f"{what} must be finite as single precision, but row {bad} is {array[bad]} "
            f"({np.count_nonzero(~is_finite)} such rows in all)"
        )
    if corners is None:
        if len(array) != vertex_count:
            raise ValueError(
                f"{what} without {what_corners} needs one row per vertex ({vertex_count}), got "
                f"{len(array)}; pass {what_corners}, shape (F, 3), if corners have values of their "
                "own"
            )
        return table, None
    rows = checked_indices(what_corners, corners, len(array), what)
    if len(rows) != len(faces):
        raise ValueError(
            f"{what_corners} must have one row per triangle ({len(faces)}), got {len(rows)}"
        )
    return table, rows
