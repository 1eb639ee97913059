"""Live Link Face's CSV: timecode, the number of shapes, 52 shapes, three angles of head and eyes.

Columns are found by name: writers disagree about their order, and one adds seven of emotions (68).
"""

from __future__ import annotations

from . import named_columns
from .request import Request
from .table import Table
from .take import Take


def recognises(names: tuple[str, ...]) -> bool:
    """Whether these are the columns of Live Link Face."""
    folded = {name.casefold() for name in names}
    return bool(folded & {"timecode", "blendshapecount"}) and named_columns.recognises(names)


def read(table: Table, request: Request) -> Take:
    """The take in the table."""
    return named_columns.read(table, request, "Live Link Face")
