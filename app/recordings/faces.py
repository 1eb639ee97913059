"""Several faces in one table: the rows of the one that is asked for."""

from __future__ import annotations

from dataclasses import replace

from ..errors import UserError
from .request import Request
from .table import Table

COLUMNS = ("face_id", "identity", "face_idx", "faceid", "face")
MOST_LISTED = 8  # faces in a message


def only_one(source: str, request: Request) -> None:
    """UserError where a face is asked for in a file that names none."""
    if request.face is not None:
        raise UserError(f"{source}: names no faces; leave out the face '{request.face}'")


def one_face(table: Table, request: Request) -> Table:
    """The rows of the face that is asked for, or of the one that most rows show.

    UserError for a face that is not there. Faces are called as the file calls them.
    """
    places = table.places
    column = next((places[name] for name in COLUMNS if name in places), None)
    if column is None:
        only_one(table.source, request)
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
