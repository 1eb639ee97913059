"""Read the surface of a PLY file: points with their colours, polygons, and strips of triangles.

trimesh ignores strips, does not read binary polygons of several sizes, and reads colours under one
name and in one size only.

Source: Turk 1994, "The PLY polygon file format"; the names of colours and strips are taken from
programs that write such files.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64, Integers64, Unsigned8
from .topology import strip_triangles
from .user_files import MOST_FILE_VERTICES, plain_text


@dataclass(frozen=True)
class PlySurface:
    """The surface of a PLY file.

    vertices: shape (V, 3), in the order of the file. faces: shape (F, 3); polygons become fans.
    colours: colours of the vertices, shape (V, 3), uint8, or None.
    """

    vertices: Floats64
    faces: Integers64
    colours: Unsigned8 | None


class _Lists(NamedTuple):
    """Lists of numbers, one for each row, one after another."""

    lengths: Integers64  # (n,)
    values: npt.NDArray[Any]  # all of them


class _Property(NamedTuple):
    name: str
    kind: str
    length: str | None  # the kind of a list's length; None: not a list


@dataclass
class _Element:
    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)


def read_ply(content: bytes) -> PlySurface:
    """The surface in a file. Raises AssetError or any other error for a broken file."""
    end_of_header = re.compile(rb"\bend_header[ \t]*(\r\n|\n|\r)")
    end = end_of_header.search(content)
    if end is None:
        raise ValueError("its header has no end")
    elements, form = _header(plain_text(content[: end.start()]))
    data = content[end.end() :]
    is_text = form == "ascii"
    body = _Numbers(data) if is_text else _Bytes(data, ">" if "big" in form else "<")
    read = {element.name: _rows(element, body) for element in elements}
    points = read["vertex"]
    vertices = np.column_stack([points[axis] for axis in "xyz"]).astype(np.float64)
    faces = [np.zeros((0, 3), np.int64)]
    if "face" in read:
        faces.append(_fan_triangles(_corners(read["face"])))
    if "tristrips" in read:
        faces += _strip_triangles(_corners(read["tristrips"]))
    return PlySurface(vertices, np.vstack(faces), _colours(points))


def _header(text: bytes) -> tuple[list[_Element], str]:
    """The elements of the file, in its order, and the form of its numbers."""
    first, *lines = text.decode().split("\n")
    if first.strip() != "ply":
        raise ValueError("it does not begin with ply")
    elements: list[_Element] = []
    form = "ascii"
    kinds_of_numbers = {
        **dict.fromkeys(("char", "int8"), "i1"),
        **dict.fromkeys(("uchar", "uint8"), "u1"),
        **dict.fromkeys(("short", "int16"), "i2"),
        **dict.fromkeys(("ushort", "uint16"), "u2"),
        **dict.fromkeys(("int", "int32"), "i4"),
        **dict.fromkeys(("uint", "uint32"), "u4"),
        **dict.fromkeys(("float", "float32"), "f4"),
        **dict.fromkeys(("double", "float64"), "f8"),
    }
    for line in lines:
        match line.split():
            case ["format", name, *_]:
                form = name
            case ["element", name, count]:
                elements.append(_Element(name, int(count)))
            case ["property", "list", length, kind, name]:
                elements[-1].properties.append(
                    _Property(name, kinds_of_numbers[kind], kinds_of_numbers[length])
                )
            case ["property", kind, name]:
                elements[-1].properties.append(_Property(name, kinds_of_numbers[kind], None))
    return elements, form


class _Numbers:
    """Numbers in text, taken one after another."""

    def __init__(self, text: bytes) -> None:
        self._numbers = np.fromstring(plain_text(text), np.float64, sep=" ")
        self.place = 0

    def read(self, kind: str, count: int) -> npt.NDArray[Any]:
        """Read the next `count` numbers of a kind."""
        found = self._numbers[self.place : self.place + count]
        if not 0 <= count == len(found):
            raise ValueError("the file ends too early")
        self.place += count
        return found.astype(kind)

    def table(self, kinds: list[str], count: int) -> list[npt.NDArray[Any]]:
        """Read the next `count` rows of numbers of some kinds; return them by columns."""
        columns = self.read("f8", len(kinds) * count).reshape(count, len(kinds)).T
        return [column.astype(kind) for column, kind in zip(columns, kinds, strict=True)]


class _Bytes:
    """Numbers in bytes, taken one after another."""

    def __init__(self, data: bytes, order: str) -> None:
        self._data = data
        self._order = order
        self.place = 0

    def read(self, kind: str, count: int) -> npt.NDArray[Any]:
        """Read the next `count` numbers of a kind."""
        return self._rows(np.dtype(self._order + kind), count)

    def table(self, kinds: list[str], count: int) -> list[npt.NDArray[Any]]:
        """Read the next `count` rows of numbers of some kinds; return them by columns."""
        columns = [(str(place), self._order + kind) for place, kind in enumerate(kinds)]
        rows = np.dtype(columns)
        found = self._rows(rows, count)
        return [found[name] for name in rows.names or ()]

    def _rows(self, kind: np.dtype[Any], count: int) -> npt.NDArray[Any]:
        if count < 0 or self.place + count * kind.itemsize > len(self._data):
            raise ValueError("the file ends too early")
        found = np.frombuffer(self._data, kind, count, self.place)
        self.place += found.nbytes
        return found


def _rows(element: _Element, body: _Numbers | _Bytes) -> dict[str, Any]:
    """The columns of an element by name: arrays (n,), or lists."""
    if not 0 <= element.count <= 3 * MOST_FILE_VERTICES:
        raise ValueError(f"{element.count} times '{element.name}' are too many")
    if element.count:
        start = body.place
        lengths = [len(each) for each in _row(element, body)]
        body.place = start
        most_corners = 16  # of a polygon: its lists are read at once, those of strips are not
        columns = (
            _table(element, lengths, body) if max(lengths, default=0) <= most_corners else None
        )
        if columns is not None:
            return columns
        body.place = start
    rows = [_row(element, body) for _ in range(element.count)]
    columns = {}
    for place, each in enumerate(element.properties):
        found = [row[place] for row in rows]
        values = np.concatenate([np.zeros(0, each.kind), *found])
        sizes = np.array([len(row) for row in found], np.int64)
        columns[each.name] = values if each.length is None else _Lists(sizes, values)
    return columns


def _row(element: _Element, body: _Numbers | _Bytes) -> list[npt.NDArray[Any]]:
    """One row: the numbers of each list, and one number for each other property."""
    row = []
    for each in element.properties:
        length = 1 if each.length is None else int(body.read(each.length, 1)[0])
        row.append(body.read(each.kind, length))
    return row


def _table(element: _Element, lengths: list[int], body: _Numbers | _Bytes) -> dict[str, Any] | None:
    """All rows at once, if all their lists have these lengths; else None."""
    kinds = []
    for each, length in zip(element.properties, lengths, strict=True):
        if each.length is not None:
            kinds.append(each.length)
        kinds += [each.kind] * length
    try:
        found = body.table(kinds, element.count)
    except ValueError:  # other lists are too short
        return None
    columns: dict[str, Any] = {}
    for each, length in zip(element.properties, lengths, strict=True):
        if each.length is None:
            columns[each.name] = found.pop(0)
            continue
        sizes = found.pop(0).astype(np.int64)
        if (sizes != length).any():
            return None
        values = [found.pop(0) for _ in range(length)]
        # The column of sizes keeps the number of rows where the lists are empty.
        rows = np.column_stack([sizes, *values])[:, 1:]
        columns[each.name] = _Lists(sizes, rows.ravel())
    return columns


def _corners(columns: dict[str, Any]) -> _Lists:
    """The lists of vertex indices among the columns of polygons or strips."""
    lists = {name: each for name, each in columns.items() if isinstance(each, _Lists)}
    named = [each for name, each in lists.items() if name in ("vertex_indices", "vertex_index")]
    found = [*named, *lists.values()][0]
    return _Lists(found.lengths, found.values.astype(np.int64))


def _fan_triangles(polygons: _Lists) -> Integers64:
    """Triangles around the first corner of each polygon, shape (F, 3)."""
    starts = np.cumsum(polygons.lengths) - polygons.lengths
    counts = np.maximum(polygons.lengths - 2, 0)
    first = np.repeat(starts, counts)
    earlier = np.repeat(np.cumsum(counts) - counts, counts)  # triangles of earlier polygons
    number = np.arange(counts.sum()) - earlier  # of a triangle in its polygon
    second = first + number + 1
    corners = np.stack([first, second, second + 1], axis=1)
    triangles: Integers64 = polygons.values[corners]
    return triangles


def _strip_triangles(strips: _Lists) -> list[Integers64]:
    """The triangles of each strip; a number below 0 ends a strip within a list."""
    ends = np.cumsum(strips.lengths)
    parts = np.split(strips.values, ends[:-1])
    pieces = [piece for part in parts for piece in np.split(part, np.flatnonzero(part < 0))]
    return [strip_triangles(piece[piece >= 0]) for piece in pieces]


def _colours(points: dict[str, Any]) -> Unsigned8 | None:
    """The colours of vertices, shape (V, 3): shares, or integers of 8 or 16 bits."""
    names_of_colours = (
        ("red", "green", "blue"),
        ("r", "g", "b"),
        ("diffuse_red", "diffuse_green", "diffuse_blue"),
    )
    for names in names_of_colours:
        if all(name in points for name in names):
            found = np.nan_to_num(np.column_stack([points[name] for name in names]))
            greatest = found.max(initial=0)
            if found.dtype.kind == "f" and greatest <= 1.0:
                found = 255.0 * found
            elif greatest > 255:
                found = found / 257.0
            colours: Unsigned8 = np.rint(found).clip(0, 255).astype(np.uint8)
            return colours
    return None
