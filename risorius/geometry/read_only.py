"""Arrays that are passed to callers, who must not write them."""

import dataclasses
from typing import TypeVar

import numpy as np
import numpy.typing as npt

Scalar = TypeVar("Scalar", bound=np.generic)


def read_only(array: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """View an array so that it cannot be written through the view; itself where it cannot be.

    Compiled code reads by numbers of vertices that were checked once. A change of one of them
    afterwards would let it read beyond the end of an array.
    """
    if not array.flags.writeable:
        return array
    view = array.view()
    view.flags.writeable = False
    return view


def make_read_only(record: object) -> None:
    """Put read-only views in the place of the arrays of a frozen dataclass, for `__post_init__`."""
    for field in dataclasses.fields(record):  # type: ignore[arg-type]
        value = getattr(record, field.name)
        if isinstance(value, np.ndarray):
            object.__setattr__(record, field.name, read_only(value))
