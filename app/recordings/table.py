"""A table in a text: names above columns, whatever stands between them.

Numbers are read by `numpy.loadtxt`, whose parser is compiled: ten minutes of 60 frames a second
(36 000 rows of 63 columns) take about 0.7 s. pandas and polars need 0.2 s, but bring 80 MB and more
for one function, and stop or guess at rows that are too short, which we find and tell of here. The
csv module alone took 2 to 3 s.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..errors import UserError, counted
from .take import Array, Request

DELIMITERS = ",\t"
UNIT_SEPARATOR = "\x1f"  # stands between cells that were quoted: it is in no cell
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
    delimiter: str
    notes: list[str] = field(default_factory=list)

    @property
    def places(self) -> dict[str, int]:
        """Name without capitals -> number of the first column that is called so."""
        return {name.casefold(): number for number, name in reversed([*enumerate(self.names)])}

    def cells(self, column: int) -> list[str]:
        """The text in one column."""
        return [line.split(self.delimiter, column + 1)[column].strip() for line in self.lines]

    def numbers_of(self, places: Mapping[str, int]) -> dict[str, Array]:
        """Name -> the numbers in its column, shape (rows,); NaN where there is none."""
        return dict(zip(places, self.numbers([*places.values()]).T, strict=True))

    def numbers(self, columns: Sequence[int]) -> Array:
        """The numbers in some columns, shape (rows, columns); NaN where there is none."""
        if not columns or not self.lines:
            return np.empty((len(self.lines), len(columns)))
        told: dict[str, Any] = {"delimiter": self.delimiter, "usecols": columns, "comments": None}
        try:
            values = np.loadtxt(self.lines, ndmin=2, **told)
        except ValueError:  # not all are numbers
            values = np.genfromtxt(self.lines, **told).reshape(len(self.lines), len(columns))
            none = np.argwhere(np.isnan(values))
            for row, place in none[:1]:
                self.notes.append(
                    f"{len(none)} cells hold no number, the first in line "
                    f"{self.line_numbers[row]}, column '{self.names[columns[place]]}'."
                )
        return np.where(np.abs(values) < LARGEST, values, np.nan)


def header_of(text: str) -> tuple[tuple[str, ...], str]:
    """The names in the first line that is one, and the delimiter; no names: there is no table."""
    line, start = _first_line(text)
    following = text[start + len(line) :].lstrip("\n ").partition("\n")[0]

    def fit(delimiter: str) -> tuple[bool, int]:
        """How well the line is divided: first into as many cells as the next one."""
        count = line.count(delimiter)
        return 0 < count == following.count(delimiter), count

    delimiter = max(DELIMITERS, key=fit)
    try:
        names = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:
        return (), delimiter
    is_header = (
        bool(names)
        and all(len(name) <= LONGEST_NAME for name in names)
        and any(re.search(r"[^\W\d]", name) for name in names)
    )
    return tuple(name.strip() for name in names) if is_header else (), delimiter


def table_in(text: str, *, source: str) -> Table:
    """The table in a text. UserError where rows and header do not belong together."""
    names, delimiter = header_of(text)
    _, start = _first_line(text)
    before, notes = text.count("\n", 0, start) + 1, list[str]()
    rows = list(enumerate(text[start:].split("\n")))
    delimiter_within = UNIT_SEPARATOR if '"' in text else delimiter
    if delimiter_within != delimiter:
        rows = [(number, _unquoted(line, delimiter)) for number, line in rows]
    rows = [(before + number, line) for number, line in rows[1:] if line.strip(" \t,;|\x1f")]
    if not rows:
        raise UserError(f"{source}: has a header and no rows below it; nothing was recorded")
    kept = _of_one_length(rows, len(names), delimiter_within, notes)
    if 2 * len(kept) < len(rows):
        fitting = {number for number, _ in kept}
        number, line = next(row for row in rows if row[0] not in fitting)
        raise UserError(
            f"{source}: line {number} has {counted(line.count(delimiter_within) + 1, 'cell')}, the "
            f"header has {len(names)} names, and so it is in most rows; each row needs as many"
        )
    return Table(
        source,
        names,
        [line for _, line in kept],
        [number for number, _ in kept],
        delimiter_within,
        notes,
    )


def _first_line(text: str) -> tuple[str, int]:
    """The header's line, and where it begins."""
    start = 0
    for line in text.splitlines(keepends=True):
        plain = line.strip("\ufeff \n")
        if plain and not plain.startswith("#"):
            return plain, start
        start += len(line)
    return "", start


def _unquoted(line: str, delimiter: str) -> str:
    """A row with quotes, its cells between UNIT_SEPARATOR; "" for what csv cannot read."""
    try:
        return UNIT_SEPARATOR.join(next(csv.reader([line], delimiter=delimiter), []))
    except csv.Error:  # a cell of megabytes
        return ""


def _of_one_length(
    rows: list[tuple[int, str]], length: int, delimiter: str, notes: list[str]
) -> list[tuple[int, str]]:
    """The rows that have as many cells as the header; an empty cell too many at the end is cut."""
    kept, left_out = [], []
    for number, line in rows:
        count = line.count(delimiter) + 1
        if count == length + 1 and line.rstrip().endswith(delimiter.strip() or delimiter):
            line = line[: line.rindex(delimiter)]
            count = length
        if count == length:
            kept.append((number, line))
        else:
            left_out.append(number)
    if left_out and kept:
        what = (
            f"The last row, line {left_out[0]}, is torn and was left out."
            if left_out == [rows[-1][0]]
            else f"{counted(len(left_out), 'row')} of other length "
            f"{'was' if len(left_out) == 1 else 'were'} left out, "
            f"the first in line {left_out[0]}."
        )
        notes.append(what)
    return kept


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
