"""Arrays for callers, who must not write them."""

import dataclasses
from typing import TypeVar

import numpy as np
import numpy.typing as npt

Scalar = TypeVar("Scalar", bound=np.generic)


def read_only(array: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """A view of an array that cannot be written; the array itself if it is read-only.

    Compiled code uses vertex numbers that were checked once. If one were changed afterwards, it
    could read beyond the end of an array.
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
