"""Named tuples of arrays."""

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

Record = TypeVar("Record", bound=tuple[Any, ...])


def joined(records: Sequence[Record]) -> Record:
    """Concatenate the arrays of named tuples of one kind, at least one, field by field."""
    columns = zip(*records, strict=True)
    return type(records[0])(*(np.concatenate(column) for column in columns))
