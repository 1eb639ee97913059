"""A table in a text: names above columns, whatever stands between them.

Numbers are read by `numpy.loadtxt`, whose parser is compiled: ten minutes of 60 frames a second
(36 000 rows of 63 columns) take about 0.7 s. pandas and polars need 0.2 s, but bring 80 MB and more
for one function, and stop or guess at rows that are too short, decimal commas, blanks and NaN,
which we find and tell of by line and column here. The csv module alone took 2 to 3 s.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import UserError, counted
from .take import Array

DELIMITERS = ",;\t|"
UNIT_SEPARATOR = "\x1f"  # stands between cells that were quoted: it is in no cell
LONGEST_NAME = 80  # [characters] of a column; what is longer is no header
LARGEST = 1e30  # what is larger is no measurement; nanoseconds since 1970 are 1.8e18
MOST_LINES = 4  # that a quoted cell may go on for
NO_NUMBER = ("", "nan", "na", "n/a", "null", "none", "-", "inf", "-inf", "#n/a")


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
        try:
            values = np.loadtxt(
                self.lines, delimiter=self.delimiter, usecols=columns, comments=None, ndmin=2
            )
        except ValueError:  # not all are numbers: cell by cell
            values = self._numbers_one_by_one(columns)
        return np.where(np.abs(values) < LARGEST, values, np.nan)

    def _numbers_one_by_one(self, columns: Sequence[int]) -> Array:
        """The same, slower, with a note of the first cell that holds something else."""
        values = np.full((len(self.lines), len(columns)), np.nan)
        count, first = 0, ""
        for row, line in enumerate(self.lines):
            cells = line.split(self.delimiter)
            for place, column in enumerate(columns):
                try:
                    values[row, place] = float(cells[column])
                except ValueError:
                    cell = cells[column].strip()
                    if cell.casefold() in NO_NUMBER:
                        continue
                    count += 1
                    first = first or (
                        f"line {self.line_numbers[row]}, column '{self.names[column]}': "
                        f"'{cell[:20]}'"
                    )
        if count:
            self.notes.append(f"{count} cells hold no number, the first in {first}.")
        return values


def header_of(text: str) -> tuple[tuple[str, ...], str]:
    """The names in the first line that is one, and the delimiter; no names: there is no table."""
    line, start, asked = _first_line(text)
    following = text[start + len(line) :].lstrip("\n ").partition("\n")[0]

    def fit(delimiter: str) -> tuple[bool, int]:
        """How well the line is divided: first into as many cells as the next one."""
        count = line.count(delimiter)
        return 0 < count == following.count(delimiter), count

    delimiter = asked or max(DELIMITERS, key=fit)
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
    _, start, _ = _first_line(text)
    before, notes = text.count("\n", 0, start) + 1, list[str]()
    if '"' in text:
        delimiter_within = UNIT_SEPARATOR
        rows = _unquoted(text[start:], delimiter, len(names), before, notes)
    else:
        delimiter_within = delimiter
        rows = [(number, line) for number, line in enumerate(text[start:].split("\n"))]
    rows = [(before + number, line) for number, line in rows[1:] if line.strip(" \t,;|\x1f")]
    if not rows:
        raise UserError(f"{source}: has a header and no rows below it; nothing was recorded")
    if delimiter != "," and any(re.search(r"\d,\d", line) for _, line in rows[:100]):
        rows = [(number, line.replace(",", ".")) for number, line in rows]
        notes.append("Decimal commas were read as points.")
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


def _first_line(text: str) -> tuple[str, int, str]:
    """The header's line, where it begins, and the delimiter that a line 'sep=;' asked for."""
    asked = ""
    start = 0
    while start < len(text):
        end = text.find("\n", start)
        end = len(text) if end < 0 else end
        line = text[start:end].strip("\ufeff ")
        if line.casefold().startswith("sep=") and line[4:5] and not asked:
            asked = line[4]
        elif line and not line.startswith("#"):
            return line, start, asked
        start = end + 1
    return "", start, asked


def _unquoted(
    text: str, delimiter: str, length: int, before: int, notes: list[str]
) -> list[tuple[int, str]]:
    """The rows of a text with quotes, which may hold delimiters and a few line ends.

    A quote that nothing closes ends with its line, so that it takes no other rows along.
    """
    lines, rows, open_quotes, start = text.splitlines(keepends=True), [], list[int](), 0
    while start < len(lines):
        for end in range(start + 1, min(start + MOST_LINES, len(lines)) + 1):
            if "".join(lines[start:end]).count('"') % 2 == 0:
                cells = _cells(lines[start:end], delimiter)
                if end == start + 1 or len(cells) == length:
                    break
        else:
            open_quotes.append(before + start)
            end = start + 1
            cells = _cells(lines[start:end], delimiter)
        rows.append((end - 1, UNIT_SEPARATOR.join(cells)))
        start = end
    if open_quotes:
        first = f"Line {open_quotes[0]} opens a quotation mark that nothing closes"
        more = f", and so do {len(open_quotes) - 1} more" if len(open_quotes) > 1 else ""
        notes.append(f"{first}{more}.")
    return rows


def _cells(lines: list[str], delimiter: str) -> list[str]:
    """The cells of one row; none where one of them is longer than the csv module bears."""
    try:
        return next(csv.reader(lines, delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:
        return []


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
