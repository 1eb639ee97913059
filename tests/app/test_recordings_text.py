"""Recordings as text: line ends, comments, and foreign rows."""

import math
import os

import numpy as np
import pytest
from pytest import approx

from risorius.app.errors import UserError
from risorius.app.recordings.reading import is_recording, read_take

from .recording_files import has_note, live_link, table, take_in

COLUMNS = {"time": np.arange(6) / 30.0, "jawOpen": np.arange(6) / 10.0, "AU4": np.full(6, 0.25)}


def check(path):
    """Check that the file has the table above; return the take's notes."""
    assert is_recording(path)
    take = read_take(path)
    assert take.channels["jawOpen"] == approx(COLUMNS["jawOpen"], abs=1e-6)
    assert take.channels["AU4"] == approx(0.25)
    assert take.times == approx(COLUMNS["time"], abs=1e-6)
    return take.notes


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_line_ends(ending, tmp_path):
    """Line ends of all systems are read."""
    path = tmp_path / "take.csv"
    path.write_bytes(table(COLUMNS).replace("\n", ending).encode())
    check(path)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: f"\n\n{text}\n\n\n",
        lambda text: f"# recorded today, in the studio\n{text}",
        lambda text: text.replace(",", " , "),
        lambda text: text.replace("\n", ",\n"),
    ],
    ids=["empty lines", "comment", "blanks", "comma at the end"],
)
def test_odd_tables(change, tmp_path):
    """Lines that spreadsheets and scripts add are ignored."""
    path = tmp_path / "take.csv"
    assert callable(change)
    path.write_text(change(table(COLUMNS)))
    check(path)


def test_a_torn_last_row(tmp_path):
    """An incomplete last row is left out and reported."""
    path = tmp_path / "take.csv"
    path.write_text(table(COLUMNS) + "0.2,0.6")
    assert has_note(check(path), "The last row, line 8, is torn")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"time,jawOpen\n", "no rows"),
        (bytes(range(256)) * 40, "not a text file"),
        (b"Dear diary,\ntoday I smiled.\n", "known are"),
    ],
)
def test_other_files_are_refused(content, words, tmp_path):
    """Another file is refused in one line with its kind, and the accepted kinds."""
    path = tmp_path / "take.csv"
    path.write_bytes(content)
    with pytest.raises(UserError, match=words):
        read_take(path)


def test_no_file(tmp_path):
    """A missing file, a folder and a pipe are refused at once."""
    os.mkfifo(tmp_path / "pipe")
    for name, words in (("nowhere", "no such recording"), ("", "folder"), ("pipe", "pipe")):
        assert not is_recording(tmp_path / name)
        with pytest.raises(UserError, match=words):
            read_take(tmp_path / name)


def test_a_huge_file(tmp_path):
    """A huge file is refused by its size, without reading."""
    path = tmp_path / "take.csv"
    with path.open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(UserError, match="512 MB"):
        read_take(path)


@pytest.mark.parametrize("rate", [0.0, -1.0, 1e9, math.nan])
def test_a_rate_that_is_none(rate, tmp_path):
    """An invalid rate is refused, and the message has the limits."""
    with pytest.raises(UserError, match="1 to 1000"):
        take_in(tmp_path, live_link(), rate=rate)


@pytest.mark.parametrize(
    "text",
    [
        "[[pose]]\ntime = 0\n",
        "title = 'a, b, c'\n[tracks]\n",
        "# jawOpen, AU12\n[[pose]]\ntime = 0\n",
        '{"landmarks": [1, 2, 3]}',
        "v 0 0 0\nv 1 0 0\nf 1 2 3\n",
    ],
)
def test_files_of_ours_are_no_recordings(text, tmp_path):
    """Scripts, landmarks and heads are not read as recordings, because of their content."""
    path = tmp_path / "take.csv"
    path.write_text(text)
    assert not is_recording(path)
