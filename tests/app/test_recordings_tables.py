"""Tables as people and programs write them: separators, quotes, decimal commas, encodings."""

import csv
import io

import numpy as np
import pytest
from pytest import approx

from risorius.app.recordings.reading import is_recording, read_take

from .recording_files import has_note, table

JAW = np.sin(np.arange(180) / 30.0) ** 2
COLUMNS = {"timestamp": np.arange(180) / 60.0, "jawOpen": JAW, "mouthSmile_L": JAW / 2.0}


def cells(columns=COLUMNS):
    """The cells of the header and of the rows."""
    return list(csv.reader(io.StringIO(table(columns))))


def rewritten(separator=",", quoting=csv.QUOTE_MINIMAL, quote='"'):
    """The table with other separators and quotes."""
    file = io.StringIO()
    writer = csv.writer(file, delimiter=separator, quoting=quoting, quotechar=quote)
    writer.writerows(cells())
    return file.getvalue()


def german(quoting=csv.QUOTE_MINIMAL, separator=";"):
    """The table with decimal commas."""
    file = io.StringIO()
    writer = csv.writer(file, delimiter=separator, quoting=quoting)
    for row in cells():
        writer.writerow([cell.replace(".", ",") for cell in row])
    return file.getvalue()


def of_r():
    """The table as written by R's write.csv: a column of row names, quotes around all names."""
    header, *rows = cells()
    lines = [",".join(f'"{name}"' for name in ("", *header))]
    lines += [",".join((f'"{number}"', *row)) for number, row in enumerate(rows, 1)]
    return "\n".join(lines)


def aligned(*, has_row_names=False):
    """The table in columns of equal width, as by pandas' `to_string`."""
    rows = [[str(number), *row] for number, row in enumerate(cells(), -1)]
    rows[0][0] = ""
    begin = 0 if has_row_names else 1
    lines = ["".join(f"{cell:>14}" for cell in row[begin:]) for row in rows]
    return "\n".join(lines)


def of_r_table():
    """The table as written by R's write.table: row names without a header."""
    return of_r().replace('"",', "", 1)


TEXTS = {
    "all quoted": (lambda: rewritten(quoting=csv.QUOTE_ALL), "quotes around cells"),
    "names quoted": (lambda: rewritten(quoting=csv.QUOTE_NONNUMERIC), "quotes around cells"),
    "single quotes": (lambda: rewritten(quoting=csv.QUOTE_ALL, quote="'"), "quotes around cells"),
    "R": (of_r, "quotes around cells"),
    "R's write.table": (of_r_table, "one cell more than the header"),
    "semicolons": (lambda: rewritten(";"), "semicolons between cells."),
    "tabs": (lambda: rewritten("\t"), "tabs between cells."),
    "bars": (lambda: rewritten("|"), "bars between cells."),
    "blanks": (lambda: rewritten(" "), "blanks between cells."),
    "runs of blanks": (lambda: rewritten(" ").replace(" ", "   "), "blanks between cells."),
    "aligned": (aligned, "blanks between cells."),
    "aligned, with names of rows": (lambda: aligned(has_row_names=True), "blanks between cells."),
    "blanks, quoted": (lambda: rewritten(" ", csv.QUOTE_ALL), "blanks between cells, quotes"),
    "decimal commas, blanks": (lambda: german(separator=" "), "blanks between cells, decimal"),
    "R's write.table with blanks": (
        lambda: of_r_table().replace(",", " "),
        "one cell more than the header",
    ),
    "semicolons, quoted": (lambda: rewritten(";", csv.QUOTE_ALL), "semicolons between cells"),
    "decimal commas": (german, "semicolons between cells, decimal commas"),
    "decimal commas, tabs": (lambda: german(separator="\t"), "tabs between cells, decimal commas"),
    "decimal commas, quoted": (
        lambda: german(csv.QUOTE_ALL, ","),
        "commas between cells, quotes around cells, decimal commas",
    ),
    "a spreadsheet's first line": (lambda: "sep=;\n" + german(), "decimal commas"),
    "a comma at the end of rows": (
        lambda: table(COLUMNS).replace("\n", ",\n").replace(",\n", "\n", 1),
        "",
    ),
}


@pytest.mark.parametrize("kind", TEXTS)
def test_layouts(kind, tmp_path):
    """Times and values are the same with all separators and quotes; the guess is reported."""
    make, note = TEXTS[kind]
    path = tmp_path / "take.csv"
    path.write_text(make(), encoding="utf-8")
    assert is_recording(path)
    take = read_take(path)
    assert take.duration == approx(179 / 60.0, abs=1e-5)
    assert take.channels.keys() == {"jawOpen", "mouthSmileLeft"}
    assert take.channels["jawOpen"] == approx(JAW, abs=1e-6)
    assert not take.unknown
    assert has_note(take.notes, note) or not note


def test_a_separator_in_a_name(tmp_path):
    """The delimiter also separates the rows; in quoted names, other separators are text."""
    path = tmp_path / "take.csv"
    path.write_text("head|jawOpen,head|mouthClose\n0.1,0.2\n0.2,0.3\n")
    assert read_take(path).channels.keys() == {"jawOpen", "mouthClose"}
    path.write_text('"time","jawOpen","said; or; sung; or not"\n0,0.1,a\n0.1,0.2,"b, c"\n')
    take = read_take(path)
    assert take.unknown == ("said; or; sung; or not",)
    assert take.channels["jawOpen"] == approx([0.1, 0.2])


@pytest.mark.parametrize(
    "text", ["jawOpen = 0.5\nmouthClose = 0.2\n", "jawOpen is a shape\nand so is mouthClose\n"]
)
def test_words_are_no_table(text, tmp_path):
    """Blanks separate cells only if the cells are numbers."""
    path = tmp_path / "notes"
    path.write_text(text)
    assert not is_recording(path)


def test_a_plain_table_needs_no_word(tmp_path):
    """Commas, decimal points and UTF-8, the usual form, are not reported."""
    path = tmp_path / "take.csv"
    path.write_text(table(COLUMNS), encoding="utf-8-sig")
    assert read_take(path).notes == ()


@pytest.mark.parametrize(
    ("codec", "name"),
    [("utf-16", "UTF-16"), ("utf-16-le", "UTF-16"), ("utf-16-be", "UTF-16"), ("utf-32", "UTF-32"),
     ("latin-1", "Windows-1252"), ("utf-8", ""), ("utf-8-sig", "")],
)  # fmt: skip
def test_encodings(codec, name, tmp_path):
    """Names beyond ASCII are read correctly, and encodings other than UTF-8 are reported."""
    path = tmp_path / "take.csv"
    path.write_bytes(table({"für später": np.ones(180)} | COLUMNS).encode(codec))
    assert is_recording(path)
    take = read_take(path)
    assert take.unknown == ("für später",)
    assert take.channels["jawOpen"] == approx(JAW, abs=1e-6)
    assert has_note(take.notes, f"read as {name}") == bool(name)


def test_json_in_utf_16(tmp_path):
    """JSON files may have the encodings of tables."""
    path = tmp_path / "take.json"
    path.write_text('[{"jawOpen": 0.1}, {"jawOpen": 0.5}]', encoding="utf-16")
    assert is_recording(path)
    take = read_take(path)
    assert take.channels["jawOpen"] == approx([0.1, 0.5])
    assert has_note(take.notes, "read as UTF-16")


def test_a_quoted_text_beside_numbers(tmp_path):
    """A separator, a line end and a doubled quote in a quoted cell belong to its text."""
    path = tmp_path / "take.csv"
    path.write_text('time,note,jawOpen\n0,"a, b",0.1\n0.1,"one\ntwo",0.2\n0.2,"""c""",0.3\n')
    take = read_take(path)
    assert take.channels["jawOpen"] == approx([0.1, 0.2, 0.3])
    assert take.times == approx([0.0, 0.1, 0.2])


@pytest.mark.parametrize("is_first", [True, False])
def test_a_quote_that_is_not_closed(tmp_path, is_first):
    """An unclosed quote loses its own row only, and its line is reported.

    The same holds for two unclosed quotes.
    """
    path = tmp_path / "take.csv"
    broken = '0.1,"0.2\n' if is_first else '"0.1,0.2\n'
    path.write_text(f'time,"jawOpen"\n0,0.1\n{broken}0.2,0.3\n0.3,"0.4\n0.4,0.5\n')
    take = read_take(path)
    assert take.channels["jawOpen"].tolist() == [0.1, 0.3, 0.5]
    assert any("Quotes in 2 lines are not closed" in note for note in take.notes)
    assert any("line 3, 5" in note for note in take.notes)


@pytest.mark.parametrize(
    ("header", "note"),
    [
        ("time,jawOpen,jawOpen", "have one name, and the first of each counts: 'jawOpen'"),
        ("time,jawOpen,JawOpen", "repeat another column, and were left out: 'JawOpen'"),
        ("time,jawOpen,jaw_open", "repeat another column, and were left out: 'jaw_open'"),
        ("time,AU12,AU12", "have one name, and the first of each counts: 'AU12'"),
        ("time,AU12_r,AU12_r", "have one name, and the first of each counts: 'AU12_r'"),
    ],
)
def test_a_column_that_stands_twice(header, note, tmp_path):
    """Of two columns with one name the first counts, and this is reported."""
    path = tmp_path / "take.csv"
    path.write_text(f"{header}\n0,0.1,0.9\n0.1,0.2,0.8\n")
    take = read_take(path)
    (values,) = take.channels.values()
    assert values[0] < values[1]
    assert has_note(take.notes, note)
