"""Read-only arrays for callers."""

import dataclasses
from typing import TypeVar

import numpy as np
import numpy.typing as npt

Scalar = TypeVar("Scalar", bound=np.generic)


def read_only(array: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """Return a read-only view of an array; the array itself if it is read-only.

    Compiled code uses vertex indices that were checked once. If a caller changed a number
    afterwards, compiled code could read beyond the end of an array.
    """
    if not array.flags.writeable:
        return array
    view = array.view()
    view.flags.writeable = False
    return view


def make_read_only(record: object) -> None:
    """Replace the arrays of a frozen dataclass by read-only views, for `__post_init__`."""
    for field in dataclasses.fields(record):  # type: ignore[arg-type]
        value = getattr(record, field.name)
        if isinstance(value, np.ndarray):
            object.__setattr__(record, field.name, read_only(value))
