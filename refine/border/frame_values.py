"""Values that change from frame to frame: a frame may bring new numbers for attributes.

Kähler, Haber, Seidel 2003, section 4.4, carry texture coordinates through splits linearly along
edges. We treat attributes in the same way (corner_values.py). Most keep their bound values; heat,
strain or the depth of wrinkles change in each frame. A changing attribute is bound like the others,
which reserves its columns and rows. Each frame then writes new numbers there.
"""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32
from ..mesh.validation import as_array
from .corner_values import CornerValues

FrameValuesLike = Mapping[str, npt.ArrayLike]
"""Values of a frame by the names of attributes, in the shapes in which they were bound."""


class FrameValues:
    """Writes the values of each frame into the bound table."""

    def __init__(self, bound: CornerValues) -> None:
        """`bound`: the table that every frame with values rewrites."""
        self._bound = bound
        self._at_binding = bound.values.copy()
        self._are_given = False

    def update(self, given: FrameValuesLike | None) -> bool:
        """Write the values of a frame into the table; return whether the table has changed.

        Attributes that are missing in a frame take their bound values. Raises ValueError for a name
        that was not bound, another shape, and numbers that are not finite in single precision.
        """
        if not given and not self._are_given:
            return False
        self._bound.values[:] = self._at_binding
        self._are_given = bool(given)
        for name, values in (given or {}).items():
            self._write(name, values)
        return True

    def _write(self, name: str, given: npt.ArrayLike) -> None:
        bound = self._bound
        if name not in bound.columns:
            raise ValueError(_unknown(name, list(bound.columns)))
        columns = bound.columns[name]
        shape = (bound.own_lengths[name], columns.stop - columns.start)
        wanted = f"numbers of shape {shape}, as that attribute was bound"
        array = as_array(f"values[{name!r}]", given, wanted)
        if array.shape != shape or array.dtype.kind not in "fiu":
            raise ValueError(
                f"values[{name!r}] must be {wanted}, got {array.dtype} of shape {array.shape}"
            )
        with np.errstate(over="ignore"):
            single: Floats32 = array.astype(np.float32, copy=False)
        if not np.isfinite(single).all():
            bad = int(np.isfinite(single).all(axis=1).argmin())
            raise ValueError(
                f"values[{name!r}] must be finite as single precision, but row {bad} is "
                f"{array[bad]}"
            )
        rows = bound.own_rows[name]
        bound.values[:, columns] = single if rows is None else single[rows]


def refuse(given: FrameValuesLike | None) -> None:
    """Raise ValueError if a frame has values although no attribute was bound."""
    for name in given or ():
        raise ValueError(_unknown(name, []))


def _unknown(name: str, bound: list[str]) -> str:
    there_are = f"bound are {bound}" if bound else "no attribute was bound"
    return (
        f"values[{name!r}] is not an attribute of this refiner; {there_are}; bind it by "
        f"attributes={{{name!r}: values at rest}}"
    )
