"""Reading of a file into a Take; its content determines the format, never its name.

`TABLE_KINDS` and `DOCUMENT_KINDS` list the formats, the most special first. A new format needs a
row here, with a function that recognises it and a function that reads it.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from risorius.schema import parsed_json

from ..errors import UserError
from ..files import read_bytes
from . import mediapipe_json, named_columns, openface, pyfeat, speech
from .table import Table, header_of, table_in
from .take import Take, TakeRequest

ReadsTable = Callable[[Table, TakeRequest], Take]
ReadsDocument = Callable[[Any, str, TakeRequest], Take]

# For each kind of table: a test of the columns' names, and a reader.
TABLE_KINDS: Sequence[tuple[Callable[[tuple[str, ...]], bool], ReadsTable]] = (
    (named_columns.is_live_link, named_columns.read),
    (pyfeat.recognises, pyfeat.read),
    (openface.recognises, openface.read),
    (named_columns.recognises, named_columns.read),
)
# For each kind of JSON: a test of the document, and a reader.
DOCUMENT_KINDS: Sequence[tuple[Callable[[Any], bool], ReadsDocument]] = (
    (speech.recognises_tracks, speech.read_tracks),
    (speech.recognises_cues, speech.read_cues),
    (mediapipe_json.recognises_weights, mediapipe_json.read_weights),
    (mediapipe_json.recognises, mediapipe_json.read),
)
LONGEST_FILE = 2**29  # [bytes]; ten minutes of py-feat's 2183 columns are about as long
BEGINNING_SIZE = 2**16  # [bytes] read to recognise a recording; a header of 2183 names fits
NOT_IN_TEXT = re.compile("[\x00-\x08\x0e-\x1a\x1c-\x1f]")  # characters of no text and no table
JSON_START = re.compile(r"\s*(\{|\[\s*(\[\s*)*[\{\]])")  # no TOML script begins like this
FACE_KEY = re.compile(
    r'"(category_?name|(face_?)?blend_?shapes|mouthcues|viseme_set|facsnames|jaw_?open|'
    r'eyeblink_?l(eft)?|mouthsmile_?l(eft)?|(viseme_)?(pp|sil))"',
    re.IGNORECASE,
)


def read_take(path: Path, *, face: str | None = None, rate: float | None = None) -> Take:
    """Read the take in a file of another program.

    face: name of the face, if a file holds several; by default the face in most frames.
    rate: frames a second, if the file's own times are wrong or missing.

    Raises UserError with the file, the fault, its place, and the allowed values.
    """
    if rate is not None and not 1.0 <= rate <= 1000.0:
        raise UserError(f"rate {rate:g}: must be from 1 to 1000 frames a second")
    text, encoding = read_recording(path)
    take = _read_text(text, path, TakeRequest(face, rate))
    if encoding == "UTF-8":
        return take
    return replace(take, notes=(f"The text was read as {encoding}.", *take.notes))


def _read_text(text: str, path: Path, request: TakeRequest) -> Take:
    """Read the take in a text; raise UserError as in `read_take`."""
    known_kinds = (
        "Live Link Face, OpenFace and py-feat tables, tables with ARKit or AU names above columns, "
        "MediaPipe JSON, OpenFaceFX and Rhubarb tracks"
    )
    if JSON_START.match(text):
        try:
            document = parsed_json(text)
        except ValueError as error:
            raise UserError(f"{path}: is {error}") from None
        for recognises, read in DOCUMENT_KINDS:
            if recognises(document):
                return read(document, str(path), request)
        raise UserError(f"{path}: is JSON without shapes of a face; known are {known_kinds}")
    names = header_of(text)
    for is_known, read_table in TABLE_KINDS:
        if is_known(names):
            return read_table(table_in(text, source=str(path)), request)
    raise UserError(f"{path}: {_unknown_kind(names)}; known are {known_kinds}")


def is_recording(path: Path) -> bool:
    """Whether a file looks like a recording, by its first lines; `read_take` reports faults.

    False for scripts, heads and binary files.
    """
    text = read_beginning(path)
    if JSON_START.match(text):
        return bool(FACE_KEY.search(text))
    names = header_of(text)
    return any(recognises(names) for recognises, _ in TABLE_KINDS)


def _unknown_kind(names: tuple[str, ...]) -> str:
    """Describe a file of an unknown kind, for an error text."""
    if len(names) < 2:
        return "is neither a table nor JSON"
    listed = ", ".join(f"'{name}'" for name in names[:4])
    return f"is a table of which no column is known ({listed}, ...)"


def read_recording(path: Path) -> tuple[str, str]:
    """Read the whole text of a file; return the text and its encoding.

    Raises UserError for a missing file, a file that is too long, and a file without text.
    """
    content = read_bytes(path, what="recording", longest=LONGEST_FILE)
    if not content.strip():
        raise UserError(f"{path}: is empty; a recording is a table (CSV) or JSON")
    text, encoding = _decoded(content)
    if text is None:
        raise UserError(
            f"{path}: is not a text file; a recording of a face is a table (CSV) or JSON, no film "
            "and no sound, which --sound adds"
        )
    return text, encoding


def read_beginning(path: Path) -> str:
    """Read the first lines of a file; return "" for a missing file, or a file without text."""
    try:
        content = read_bytes(path, what="recording", longest=LONGEST_FILE, first=BEGINNING_SIZE)
    except UserError:
        return ""
    return _decoded(content)[0] or ""


def _decoded(content: bytes) -> tuple[str | None, str]:
    """Decode bytes to a text with "\\n" as line ends; return the text and its encoding.

    The text is None if the bytes are not text. The bytes may end inside a character.
    """
    codec, encoding = _encoding_of(content)
    text = content.decode(codec, errors="replace")
    if NOT_IN_TEXT.search(text, 0, BEGINNING_SIZE):
        return None, encoding
    return text.replace("\r\n", "\n").replace("\r", "\n"), encoding


def _encoding_of(content: bytes) -> tuple[str, str]:
    """Detect the encoding of a text from its mark or bytes; return Python's codec and a name."""
    if content.startswith((codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE)):
        return "utf-32", "UTF-32"
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16", "UTF-16"
    # In UTF-16 without a mark, every second byte of Western text is 0.
    for codec, first in (("utf-16-be", 0), ("utf-16-le", 1)):
        beginning = content[first:BEGINNING_SIZE:2]
        if 2 * beginning.count(0) > len(beginning):
            return codec, "UTF-16"
    try:
        codecs.getincrementaldecoder("utf-8-sig")().decode(content)
    except UnicodeDecodeError:
        return "cp1252", "Windows-1252 (Latin-1)"
    return "utf-8-sig", "UTF-8"
