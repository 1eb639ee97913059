"""A file -> a Take: its format is recognised from what it holds, never from its name.

`TABLES` lists the formats, the most special first. A new one is a module with `recognises(names)`
and `read(table, request)`, and a row here.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from ..errors import UserError
from . import live_link, named_columns
from .request import Request
from .table import Table, header_of, table_in
from .take import Take
from .text import read_beginning, read_recording


class TableFormat(NamedTuple):
    """A kind of table: whether the names of columns are its own, and how it is read."""

    recognises: Callable[[tuple[str, ...]], bool]
    read: Callable[[Table, Request], Take]


TABLES = (
    TableFormat(live_link.recognises, live_link.read),
    TableFormat(named_columns.recognises, named_columns.read),
)
KNOWN = "Live Link Face (CSV), OpenFace, py-feat, or ARKit and AU names above columns"


def read_take(path: Path, *, face: str | None = None, rate: float | None = None) -> Take:
    """The take in a file that another program wrote.

    face: which one, where a file holds several; the default is the one seen in most frames.
    rate: frames a second, where the file's own times are wrong or missing.

    Raises UserError: which file, what is wrong, where, and what is allowed.
    """
    if rate is not None and not 1.0 <= rate <= 1000.0:
        raise UserError(f"rate {rate:g}: must lie within 1 and 1000 frames a second")
    text = read_recording(path)
    names, _ = header_of(text)
    for table_format in TABLES:
        if table_format.recognises(names):
            table = table_in(text, source=str(path))
            return table_format.read(table, Request(face, rate))
    raise UserError(f"{path}: is no recording that is known; known are {KNOWN}")


def is_recording(path: Path) -> bool:
    """Whether a file looks like a recording, by its first lines; `read_take` tells what is wrong.

    False for scripts, heads and what is no text.
    """
    names, _ = header_of(read_beginning(path))
    return any(each.recognises(names) for each in TABLES)
