"""A table in a text: names above columns, with commas between cells.

Numbers are read by `numpy.loadtxt`, whose parser is compiled: ten minutes of 60 frames a second
(36 000 rows of 63 columns) take about 0.7 s. pandas and polars need 0.2 s, but bring 80 MB and more
for one function, and stop or guess at rows that are too short, which we find and tell of here. The
csv module alone took 2 to 3 s.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..errors import UserError, counted
from .take import Array, Request

LONGEST_NAME = 80  # [characters] of a column; what is longer is no header
LARGEST = 1e30  # what is larger is no measurement; nanoseconds since 1970 are 1.8e18
FACE_COLUMNS = ("face_id", "identity", "face_idx", "faceid", "face")
MOST_LISTED = 8  # faces in a message


@dataclass
class Table:
    """Rows of cells under names.

    source: the file, for error texts.
    names: of the columns, as the file spells them, without blanks around.
    lines: the text of each row; all have as many cells as there are names.
    line_numbers: of each row in the file, counted from 1.
    notes: what was found odd, each one sentence.
    """

    source: str
    names: tuple[str, ...]
    lines: list[str]
    line_numbers: list[int]
    notes: list[str] = field(default_factory=list)

    @property
    def places(self) -> dict[str, int]:
        """Name without capitals -> number of the first column that is called so."""
        return {name.casefold(): number for number, name in reversed([*enumerate(self.names)])}

    def cells(self, column: int) -> list[str]:
        """The text in one column."""
        return [line.split(",", column + 1)[column].strip() for line in self.lines]

    def numbers_of(self, places: Mapping[str, int]) -> dict[str, Array]:
        """Name -> the numbers in its column, shape (rows,); NaN where there is none."""
        return dict(zip(places, self.numbers([*places.values()]).T, strict=True))

    def numbers(self, columns: Sequence[int]) -> Array:
        """The numbers in some columns, shape (rows, columns); NaN where there is none."""
        if not columns or not self.lines:
            return np.empty((len(self.lines), len(columns)))
        told: dict[str, Any] = {"delimiter": ",", "usecols": columns, "comments": None}
        try:
            values = np.loadtxt(self.lines, ndmin=2, **told)
        except ValueError:  # not all are numbers
            values = np.genfromtxt(self.lines, **told).reshape(len(self.lines), len(columns))
        none = np.argwhere(~(np.abs(values) < LARGEST))
        for row, place in none[:1]:
            self.notes.append(
                f"{len(none)} cells hold no usable number, the first in line "
                f"{self.line_numbers[row]}, column '{self.names[columns[place]]}'."
            )
        return np.where(np.abs(values) < LARGEST, values, np.nan)


def header_of(text: str) -> tuple[str, ...]:
    """The names in the first line that is one; none: there is no table."""
    first = next((line for line in text.split("\n") if _is_row(line)), "")
    names = tuple(name.strip() for name in first.split(","))
    is_header = all(len(name) <= LONGEST_NAME for name in names) and any(
        re.search(r"[^\W\d]", name) for name in names
    )
    return names if is_header else ()


def table_in(text: str, *, source: str) -> Table:
    """The table in a text, but a row at its end that is torn. UserError for other wrong rows."""
    names, notes = header_of(text), list[str]()
    rows = [(number, line) for number, line in enumerate(text.split("\n"), 1) if _is_row(line)][1:]
    if len(rows) > 1 and rows[-1][1].count(",") + 1 < len(names):
        notes.append(f"The last row, line {rows.pop()[0]}, is torn and was left out.")
    if not rows:
        raise UserError(f"{source}: has a header and no rows below it; nothing was recorded")
    for number, line in rows:
        if (count := line.count(",") + 1) != len(names):
            raise UserError(
                f"{source}: line {number} has {counted(count, 'cell')}, the header has "
                f"{len(names)} names; each row needs as many"
            )
    numbers, lines = zip(*rows, strict=True)
    return Table(source, names, [*lines], [*numbers], notes)


def _is_row(line: str) -> bool:
    """Whether a line has cells: it is no comment, and not empty."""
    return bool(line.strip(" ,")) and not line.startswith("#")


def one_face(table: Table, request: Request) -> Table:
    """The rows of the face that is asked for, or of the one that most rows show.

    UserError for a face that is not there. Faces are called as the file calls them.
    """
    places = table.places
    column = next((places[name] for name in FACE_COLUMNS if name in places), None)
    if column is None:
        request.refuse_face(table.source)
        return table
    cells = table.cells(column)
    counts: dict[str, int] = {}
    for cell in cells:
        if cell and cell.casefold() != "nan":
            counts[cell] = counts.get(cell, 0) + 1
    often = sorted(counts, key=lambda face: (-counts[face], face))
    if request.face is not None and request.face not in counts:
        listed = ", ".join(f"'{face}'" for face in often[:MOST_LISTED])
        more = ", ..." if len(often) > MOST_LISTED else ""
        there = f"in it are {listed}{more}" if often else "no row of it names one"
        raise UserError(f"{table.source}: no face '{request.face}'; {there}")
    if len(counts) < 2:
        return table
    face = request.face or often[0]
    kept = [row for row, cell in enumerate(cells) if cell == face]
    why = "" if request.face else ", the one seen most"
    return replace(
        table,
        lines=[table.lines[row] for row in kept],
        line_numbers=[table.line_numbers[row] for row in kept],
        notes=[
            *table.notes,
            f"{len(counts)} faces are in the file; taken was '{face}'{why} ({len(kept)} rows).",
        ],
    )
