"""Reading of a table from a text: names above columns, with commas, tabs or blanks between cells.

Plain lines stay as they are. The csv module divides other lines, with blanks between cells, quoted
cells or decimal commas; their cells are joined again with `CELL_SEPARATOR` between them.

`numpy.loadtxt`, whose parser is compiled, reads the numbers: ten minutes at 60 frames a second
(36000 rows of 63 columns) take about 0.7 s. pandas and polars need 0.2 s, but they are 80 MB or
more for one function, and they stop or guess at short rows, which this module finds and reports.
The csv module alone took 2 to 3 s.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from risorius.geometry.arrays import Floats64

from ..errors import UserError
from ..text import counted
from .take import TakeRequest

LARGEST_NUMBER = 1e30  # a larger number is an error; nanoseconds since 1970 are 1.8e18
FACE_COLUMNS = ("face_id", "identity", "face_idx", "faceid", "face")
MOST_LISTED = 8  # faces that a message lists
DELIMITERS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}
CELL_SEPARATOR = "\x1f"  # the unit separator of ASCII, which no cell holds
DECIMAL_COMMA = re.compile(r"[-+]?(\d*|\d{1,3}(\.\d{3})+),\d+(e[-+]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True)
class TableLayout:
    """How the cells of a table are written.

    delimiter: the character between cells. quote: the character around cells that may hold the
    delimiter. is_quoted: whether any cell has quotes. has_decimal_commas: whether 0,5 is a half.
    has_percents: whether 50% is a half.
    """

    delimiter: str = ","
    quote: str = '"'
    is_quoted: bool = False
    has_decimal_commas: bool = False
    has_percents: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether lines can be split at their delimiters without the csv module."""
        is_written_oddly = self.is_quoted or self.has_decimal_commas or self.has_percents
        return not is_written_oddly and self.delimiter != " "

    @property
    def notes(self) -> list[str]:
        """A sentence on the layout for the report; [] for plain cells between commas."""
        if self.is_plain and self.delimiter == ",":
            return []
        guessed = [f"{DELIMITERS[self.delimiter]} between cells"]
        if self.is_quoted:
            guessed.append("quotes around cells")
        if self.has_decimal_commas:
            guessed.append("decimal commas")
        if self.has_percents:
            guessed.append("percent signs")
        return [f"The table was read with {', '.join(guessed)}."]

    def rows_of(self, numbered: Sequence[tuple[int, str]]) -> Iterator[tuple[int, list[str]]]:
        """Yield the number of the first line, and the cells, of each row that is not empty."""
        lines = (line for _, line in numbered)
        if self.delimiter == " ":  # several blanks or a tab separate cells like one blank
            lines = (line.replace("\t", " ").strip() for line in lines)
        reader = csv.reader(
            (f"{line}\n" for line in lines),
            delimiter=self.delimiter,
            quotechar=self.quote,
            skipinitialspace=True,
        )
        begun = 0
        for cells in reader:
            if any(cell.strip() for cell in cells):
                yield numbered[begun][0], cells
            begun = reader.line_num

    def clean(self, cell: str) -> str:
        """Return a cell with a decimal point, without line ends and without blanks at its ends."""
        cell = " ".join(cell.replace(CELL_SEPARATOR, " ").split())
        if self.has_decimal_commas and DECIMAL_COMMA.fullmatch(cell.rstrip(" %")):
            cell = cell.replace(".", "").replace(",", ".")
        return without_percent(cell)


def without_percent(cell: str) -> str:
    """Return `0.12` for `12%`, and any other cell unchanged."""
    if not cell.endswith("%"):
        return cell
    try:
        return repr(float(cell.rstrip(" %")) / 100.0)
    except ValueError:
        return cell


@dataclass
class Table:
    """A table with named columns.

    source: the file, for error messages.
    names: names of the columns in the file's spelling, without surrounding blanks.
    lines: the text of each row; all have as many cells as there are names.
    line_numbers: number of each row in the file, counted from 1.
    delimiter: the character between the cells of `lines`.
    notes: sentences on oddities of the file.
    """

    source: str
    names: tuple[str, ...]
    lines: list[str]
    line_numbers: list[int]
    delimiter: str = ","
    notes: list[str] = field(default_factory=list)

    @property
    def places(self) -> dict[str, int]:
        """Name in lower case -> index of the first column with this name."""
        return {name.casefold(): number for number, name in reversed([*enumerate(self.names)])}

    def cells(self, column: int) -> list[str]:
        """Return the text of each row in one column."""
        return [line.split(self.delimiter, column + 1)[column].strip() for line in self.lines]

    def cells_of(self, name: str) -> list[str]:
        """Return the text of each row in the first column of this name; case is ignored."""
        return self.cells(self.places[name.casefold()])

    def numbers_of(self, places: Mapping[str, int]) -> dict[str, Floats64]:
        """Return name -> numbers in its column, shape (rows,); NaN for cells without a number."""
        return dict(zip(places, self.numbers([*places.values()]).T, strict=True))

    def numbers(self, columns: Sequence[int]) -> Floats64:
        """Return the numbers in some columns, (rows, columns); NaN for cells without a number."""
        if not columns or not self.lines:
            return np.empty((len(self.lines), len(columns)))
        form: dict[str, Any] = {
            "delimiter": self.delimiter, "usecols": columns, "comments": None
        }  # fmt: skip
        try:
            values = np.loadtxt(self.lines, ndmin=2, **form)
        except ValueError:  # not all are numbers
            values = np.genfromtxt(self.lines, **form).reshape(len(self.lines), len(columns))
        none = np.argwhere(~(np.abs(values) < LARGEST_NUMBER))
        for row, place in none[:1]:
            self.notes.append(
                f"{counted(len(none), 'cell')} {'holds' if len(none) == 1 else 'hold'} no usable "
                f"number, the first in line "
                f"{self.line_numbers[row]}, column '{self.names[columns[place]]}'."
            )
        return np.where(np.abs(values) < LARGEST_NUMBER, values, np.nan)


def header_of(text: str) -> tuple[str, ...]:
    """Return the names in the header of a table; () if the text is not a table."""
    first = next((line for _, line in _lines_of(text) if not _is_empty(line)), "")
    return _names_in(first, _layout_of(text, first))


def _names_in(header: str, layout: TableLayout) -> tuple[str, ...]:
    """Return the names in the first row; () if it is not a header."""
    names = tuple(cell.strip() for cell in _cells_of(header, layout))
    longest_name = 80  # [characters] of a column's name; a longer one is not a name
    are_short = all(len(name) <= longest_name for name in names)
    has_letters = any(re.search(r"[^\W\d]", name) for name in names)
    return names if are_short and has_letters else ()


def table_in(text: str, *, source: str) -> Table:
    """Read the table in a text; leave out an incomplete last row, and refuse other wrong rows."""
    numbered = [(number, line) for number, line in _lines_of(text) if not _is_empty(line)]
    layout = _layout_of(text, numbered[0][1])
    names = _names_in(numbered[0][1], layout)
    notes = layout.notes
    if layout.is_plain:
        delimiter = layout.delimiter
        rows = [(number, line.count(delimiter) + 1, line) for number, line in numbered[1:]]
    else:
        delimiter = CELL_SEPARATOR
        rows = _cleaned(numbered[1:], layout, notes)
    if len(rows) > 1 and rows[-1][1] < len(names):
        notes.append(f"The last row, line {rows.pop()[0]}, is torn and was left out.")
    if not rows:
        raise UserError(f"{source}: has a header and no rows below it; nothing was recorded")
    counts = {count for _, count, _ in rows}
    if counts == {len(names) + 1}:  # row names without a header, or a delimiter at the end
        is_at_end = all(not line.rpartition(delimiter)[2].strip() for _, _, line in rows)
        names = (*names, "") if is_at_end else ("", *names)
        if not is_at_end:
            notes.append("Rows have one cell more than the header: the first has no name.")
    for number, count, _ in rows:
        if count != len(names):
            raise UserError(
                f"{source}: line {number} has {counted(count, 'cell')}, the header has "
                f"{len(names)} names; each row needs as many"
            )
    notes += repeated_columns(names)
    numbers, _, lines = zip(*rows, strict=True)
    return Table(
        source=source,
        names=names,
        lines=[*lines],
        line_numbers=[*numbers],
        delimiter=delimiter,
        notes=notes,
    )


def repeated_columns(names: Sequence[str]) -> list[str]:
    """Return a note on columns with equal names; case counts: OpenFace has `x_0` and `X_0`."""
    counts = Counter(name for name in names if name)
    repeated = [name for name, count in counts.items() if count > 1]
    if not repeated:
        return []
    listed = ", ".join(f"'{name}'" for name in repeated[:MOST_LISTED])
    more = ", ..." if len(repeated) > MOST_LISTED else ""
    return [f"Several columns have one name, and the first of each counts: {listed}{more}."]


def _lines_of(text: str) -> Iterator[tuple[int, str]]:
    """Yield numbers and texts of lines, without comments and without a spreadsheet's `sep=;`."""
    for number, line in enumerate(text.split("\n"), 1):
        if not line.startswith("#") and not re.fullmatch(r"\s*\"?sep=.\"?\s*", line, re.IGNORECASE):
            yield number, line


def _is_empty(line: str) -> bool:
    """Whether all cells of a line are empty."""
    return not line.strip(" ,;\t|\"'")


def _layout_of(text: str, header: str) -> TableLayout:
    """Detect the layout of a table from its header and the beginning of its text."""
    quote = "'" if header.lstrip().startswith("'") else '"'
    decimals_sought = 2**16  # characters of the text that are searched for a decimal comma
    sample = [*_lines_of(text[:decimals_sought])]
    best = _with_delimiter(header, sample, quote)
    best = replace(best, is_quoted=quote in text)
    # A comma in a cell can only be found if commas do not separate cells, or if cells are quoted.
    if best.is_plain and best.delimiter == "," and "%" not in text[:decimals_sought]:
        return best
    cells = [cell.strip() for _, row in best.rows_of(sample) for cell in row]
    points = [cell.replace(",", ".") for cell in cells]
    return replace(
        best,
        has_decimal_commas=any(DECIMAL_COMMA.fullmatch(cell.rstrip(" %")) for cell in cells),
        has_percents=any(without_percent(cell) != cell for cell in points),
    )


def _with_delimiter(header: str, sample: Sequence[tuple[int, str]], quote: str) -> TableLayout:
    """Return the layout whose delimiter divides the header and the row below into most cells.

    A row may have one cell more or less than the header: a name of the row, or no cell after the
    last delimiter. Blanks also separate words, so blanks are delimiters only if no other delimiter
    fits, and the row has numbers but the header has none.
    """
    rows = [line for _, line in sample if not _is_empty(line)]
    row = rows[1] if len(rows) > 1 else header
    best = TableLayout(quote=quote)
    worth = (False, 1)
    for delimiter in DELIMITERS:
        layout = TableLayout(delimiter, quote)
        names = _cells_of(header, layout)
        cells = _cells_of(row, layout)
        count = len(names)
        is_alike = count > 1 and abs(len(cells) - count) <= 1
        if delimiter == " ":
            is_table = is_alike and any(map(_is_number, cells)) and not any(map(_is_number, names))
            if worth[1] > 1 or not is_table:
                continue
        if count > 1 and (is_alike, count) > worth:
            best = layout
            worth = (is_alike, count)
    return best


def _is_number(cell: str) -> bool:
    """Whether a cell is a number, perhaps with a decimal comma."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _cells_of(line: str, layout: TableLayout) -> list[str]:
    """Return the cells in one line; [] if a cell is too long for the csv module."""
    try:
        return next((cells for _, cells in layout.rows_of([(1, line)])), [])
    except csv.Error:
        return []


def _cleaned(
    numbered: Sequence[tuple[int, str]], layout: TableLayout, notes: list[str]
) -> list[tuple[int, int, str]]:
    """Return line number, count of cells and text of each row, with `CELL_SEPARATOR` between cells.

    A line with an unclosed quote is left out and noted; no other row is lost.
    """
    rows = _rows_in(numbered, layout)
    if rows is not None and len({count for _, count, _ in rows[:-1]}) <= 1:
        return rows
    alone = [_rows_in([entry], layout) for entry in numbered]
    lost = [str(number) for (number, _), found in zip(numbered, alone, strict=True) if not found]
    if not lost and rows is not None:
        return rows
    listed = ", ".join(lost[:MOST_LISTED]) + (", ..." if len(lost) > MOST_LISTED else "")
    are = "is" if len(lost) == 1 else "are"
    notes.append(
        f"Quotes in {counted(len(lost), 'line')} {are} not closed, and the row was left out: "
        f"line {listed}."
    )
    return [row for found in alone for row in found or ()]


def _rows_in(
    numbered: Sequence[tuple[int, str]], layout: TableLayout
) -> list[tuple[int, int, str]] | None:
    """Return the rows for `_cleaned`; None if a quote is not closed within its row."""
    rows: list[tuple[int, int, str]] = []
    is_closed = True
    try:
        for number, cells in layout.rows_of(numbered):
            is_closed = not cells[-1].endswith("\n")
            if any("\n" in cell and layout.delimiter in cell for cell in cells):
                return None
            rows.append((number, len(cells), CELL_SEPARATOR.join(map(layout.clean, cells))))
    except csv.Error:  # a cell of more than 128 KiB
        return None
    return rows if is_closed else None


def one_face(table: Table, request: TakeRequest) -> Table:
    """Return the rows of the requested face, or of the face in most rows.

    Faces are named as in the file. Raises UserError for a missing face.
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
    why = "" if request.face else ", the face in most rows,"
    return replace(
        table,
        lines=[table.lines[row] for row in kept],
        line_numbers=[table.line_numbers[row] for row in kept],
        notes=[
            *table.notes,
            f"{len(counts)} faces are in the file; '{face}'{why} was used ({len(kept)} rows).",
        ],
    )
