"""Checks of everything that is handed to a refiner, with errors that say what to do.

All raise ValueError with: which argument, what it was, what is allowed. What passes is copied, so
that later changes to the caller's arrays cannot reach a frame.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..jit import njit

LARGEST = 1e15
"""No coordinate may be larger: cross products of edges have to stay finite in single precision."""
SIZES = 1e-6, 1e9
"""Sizes of a mesh, longest side of its box, in which single precision tells normals from rounding.
Measured: sheets with edges of a fortieth of that are refined as ever from 1e-7 to 1e9."""

AttributeLike = npt.ArrayLike | tuple[npt.ArrayLike, npt.ArrayLike]
"""Values of each vertex, shape (V, k), or values (A, k) and the row of each corner (F, 3)."""


@dataclass(frozen=True)
class CornerValues:
    """Texture coordinates and attributes side by side: one row per different corner."""

    values: npt.NDArray[np.float32]
    """Shape (A, k)."""
    corners: npt.NDArray[np.int64] | None
    """Row of every corner, shape (F, 3); None if vertex v has row v."""
    columns: Mapping[str, slice]
    """Where the attributes are among the k columns."""
    has_uv: bool
    """Whether the first two columns are texture coordinates."""


def check_lent(name: str, array: object, dtype: type[np.generic], needed: tuple[int, ...]) -> None:
    """Raise ValueError unless `array` can be filled with at least `needed` rows."""
    if (
        isinstance(array, np.ndarray)
        and array.dtype == dtype
        and array.ndim == len(needed)
        and len(array) >= needed[0]
        and array.shape[1:] == needed[1:]
        and array.flags.c_contiguous
        and array.flags.aligned
        and array.flags.writeable
    ):
        return
    if isinstance(array, np.ndarray):
        got = f"{array.dtype} of shape {array.shape}"
        got += "" if array.flags.c_contiguous else ", not contiguous"
        got += "" if array.flags.writeable else ", read-only"
        got += "" if array.flags.aligned else ", not aligned"
    else:
        got = type(array).__name__
    columns = "".join(f", {size}" for size in needed[1:])
    raise ValueError(
        f"stream.{name} must be a writable C-contiguous {np.dtype(dtype)} array of shape "
        f"(>= {needed[0]}{columns}), got {got}; see vertex_capacity, triangle_capacity and "
        "vertex_columns of the refiner"
    )


def checked_positions(
    rest_positions: npt.ArrayLike, name: str = "rest_positions"
) -> npt.NDArray[np.float64]:
    """Return positions, shape (V, 3), as a copy in double precision."""
    positions = as_array(name, rest_positions, "numbers of shape (V, 3)")
    if positions.ndim != 2 or positions.shape[1] != 3 or positions.dtype.kind not in "fiu":
        raise ValueError(
            f"{name} must be numbers of shape (V, 3), "
            f"got {positions.dtype} of shape {positions.shape}"
        )
    checked = np.array(positions, dtype=np.float64, order="C")
    is_good = np.abs(checked) < LARGEST
    if not is_good.all():
        bad = np.flatnonzero(~is_good.all(axis=1))
        raise ValueError(
            f"{name} must be finite and below {LARGEST:g}, but vertex {bad[0]} is "
            f"{positions[bad[0]]} ({len(bad)} such vertices in all); repair the mesh before "
            "binding it"
        )
    size = float(np.ptp(checked, axis=0).max()) if len(checked) else 0.0
    if size != 0.0 and not SIZES[0] <= size <= SIZES[1]:
        raise ValueError(
            f"{name} must extend over {SIZES[0]:g} to {SIZES[1]:g} (or lie all at one place), but "
            f"extend over {size:g}; take another unit of length, at binding and in all frames"
        )
    return checked


def as_array(name: str, given: npt.ArrayLike, wanted: str) -> npt.NDArray[Any]:
    """Return what was given as an array; raises ValueError if it is ragged or has masked entries.

    `wanted`: what it should be, for the error.
    """
    try:
        array = np.asarray(given)
    except ValueError as error:  # numpy's own words for rows of unequal length
        raise ValueError(f"{name} must be {wanted}, but is no array: {error}") from None
    if np.ma.is_masked(given):
        raise ValueError(f"{name} must be {wanted}, but has masked entries; fill them first")
    return array


def checked_indices(
    name: str, indices: npt.ArrayLike, limit: int, target: str
) -> npt.NDArray[np.int64]:
    """Return triangles, shape (F, 3), as a copy; all indices are from 0 to `limit` - 1."""
    return as_indices(name, indices, limit, target).astype(np.int64)


def as_indices(
    name: str, indices: npt.ArrayLike, limit: int, target: str
) -> npt.NDArray[np.integer]:
    """Do the same without a copy, if it can be done without."""
    array = as_array(name, indices, "integers of shape (F, 3)")
    if array.shape in ((0,), (0, 3)):
        return np.zeros((0, 3), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise ValueError(
            f"{name} must be integers of shape (F, 3), got {array.dtype} of shape {array.shape}; "
            "cut polygons into triangles first"
        )
    if not (array.min() >= 0 and array.max() < limit):
        bad = np.flatnonzero(((array < 0) | (array >= limit)).any(axis=1))
        raise ValueError(
            f"{name} must hold indices from 0 to {limit - 1} into {target}, "
            f"but triangle {bad[0]} is {array[bad[0]].tolist()}"
        )
    return array


def checked_corner_values(
    uv: npt.ArrayLike | None,
    face_uv: npt.ArrayLike | None,
    attributes: Mapping[str, AttributeLike] | None,
    faces: npt.NDArray[np.int64],
    vertex_count: int,
) -> CornerValues | None:
    """Join texture coordinates and attributes into one table; None if there are none."""
    if uv is None and face_uv is not None:
        raise ValueError("face_uv points into uv, but uv is None; pass both or neither")
    tables: list[npt.NDArray[np.float32]] = []
    indices: list[npt.NDArray[np.int64] | None] = []
    columns: dict[str, slice] = {}
    if uv is not None:
        values, corners = _checked_values("uv", uv, "face_uv", face_uv, faces, vertex_count)
        if values.shape[1] != 2:
            raise ValueError(f"uv must be numbers of shape (U, 2), got shape {values.shape}")
        tables, indices = [values], [corners]
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
        tables.append(values)
        indices.append(corners)
    if not tables:
        return None
    if all(corners is None for corners in indices):
        return CornerValues(np.concatenate(tables, axis=1), None, columns, uv is not None)
    rows = np.stack([faces if corners is None else corners for corners in indices], axis=2)
    different, number = np.unique(rows.reshape(-1, len(tables)), axis=0, return_inverse=True)
    table = [values[different[:, k]] for k, values in enumerate(tables)]
    return CornerValues(
        np.concatenate(table, axis=1), number.reshape(-1, 3), columns, uv is not None
    )


def _checked_values(
    what: str,
    values: npt.ArrayLike,
    what_corners: str,
    corners: npt.ArrayLike | None,
    faces: npt.NDArray[np.int64],
    vertex_count: int,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int64] | None]:
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


def not_finite(positions: npt.NDArray[np.floating]) -> str:
    """Say which of the positions of a frame are no numbers below LARGEST."""
    bad = np.flatnonzero(~(np.abs(positions) < LARGEST).all(axis=1))
    return (
        f"positions must be finite and below {LARGEST:g}, but vertex {bad[0]} is "
        f"{positions[bad[0]]} ({len(bad)} such vertices in all); what moves the mesh has blown up"
    )


@njit
def round_finite(positions: npt.NDArray[np.float64], points: npt.NDArray[np.float32]) -> int:
    """Write positions, shape (V, 3), as single precision; return how many numbers are too large.

    That is NaN, or not below LARGEST: 0 unless what moves the mesh has blown up.
    """
    finite = 0  # counted, not left early: so the loop takes several at a time
    for v in range(positions.shape[0]):
        for i in range(3):
            points[v, i] = positions[v, i]
            finite += abs(positions[v, i]) < LARGEST
    return int(3 * positions.shape[0] - finite)
