"""Write an avatar as a folder of OBJs, one per shape, for programs that make targets of meshes.

All files have the same vertices in the same order. `neutral.obj` is the head at rest; every other
file has one shape at 1. A user's OBJ keeps its lines, except for moved vertices, and for polygons
at a cut between sealed lips. Its material libraries and their textures are copied. Any other head
is written as triangles, body by body, in the unit of its file; the built-in head is in metres.
"""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path, PureWindowsPath

import numpy as np

from risorius.assets.errors import AssetError
from risorius.assets.fitting.lips import LipCut
from risorius.assets.user_files import path_beside, read_file, text_with_names
from risorius.assets.wavefront import joined_lines, maps_of
from risorius.geometry.arrays import Floats64

from .avatar import Avatar, FileHead
from .surface import METRES_PER_MILLIMETRE

OBJ_NAMES = re.compile(r"\w[\w.]*\.obj")  # names of files that this module writes
ELEMENT_LINE = re.compile(rb"(?m)^[ \t]*([vf])[ \t]+([^\r\n#]*)")
VERTEX_LINE = re.compile(rb"(?m)^[ \t]*v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)")


def write_obj_folder(avatar: Avatar, folder: Path) -> None:
    """Write all files of an avatar into a folder."""
    file = avatar.file
    text = None
    if file is not None and file.path.suffix.lower() == ".obj":
        content = file.path.read_bytes()
        is_kept = _has_plain_lines(content, file)
        text = _own_text(content if is_kept else joined_lines(content), file)
        _copy_materials(file, folder, is_kept=is_kept)
    for name, changes in _shapes(avatar):
        path = folder / f"{name}.obj"
        if text is None or file is None:
            path.write_text(_triangles(avatar, changes), encoding="utf-8")
        else:
            path.write_bytes(_moved_obj(text, file, changes[0]))


def _shapes(avatar: Avatar) -> Iterator[tuple[str, list[Floats64]]]:
    """Yield the name of each file, and the displacements [mm] (V, 3) of each body in it."""
    still = [np.zeros_like(shaped.body.rest) for shaped in avatar.shapes]
    yield "neutral", still
    for number, name in enumerate(avatar.names):
        yield (
            name,
            [
                shaped.targets[number].astype(np.float64) if len(shaped.targets) else zeros
                for shaped, zeros in zip(avatar.shapes, still, strict=True)
            ],
        )


def _has_plain_lines(content: bytes, file: FileHead) -> bool:
    """Whether lines of an OBJ can be kept: none continues in the next, and none is UTF-16."""
    is_continued = re.search(rb"\\[ \t]*\r?\n", content) is not None
    return not is_continued and len(VERTEX_LINE.findall(content)) == _count_of(file)


def _count_of(file: FileHead) -> int:
    """Return the number of vertices of a user's OBJ."""
    cut = file.head.lip_cut
    return len(file.body.rest) - (0 if cut is None else len(cut.sources))


def _own_text(content: bytes, file: FileHead) -> bytes:
    """Return the text of a user's OBJ; if its lips are cut, with doubled vertices."""
    cut = file.head.lip_cut
    return content if cut is None else _with_lips_cut(content, cut, _count_of(file))


def _copy_materials(file: FileHead, folder: Path, *, is_kept: bool) -> None:
    """Copy the material libraries of an OBJ, and their textures, to the same paths in a folder.

    Textures that are missing, or lie outside the mesh's folder, are not copied. is_kept: whether
    libraries are copied unchanged, or as UTF-8.
    """
    assert file.painted is not None
    source = file.path.parent
    for name in file.painted.libraries:
        if not path_beside(source, name).exists():
            continue
        library = read_file(path_beside(source, name), kind="material", most=1)
        _write_beside(folder, name, library if is_kept else text_with_names(library))
        for picture in maps_of(library):
            with contextlib.suppress(AssetError):
                content = read_file(path_beside(source, picture), kind="picture", most=100)
                _write_beside(folder, picture, content)


def _write_beside(folder: Path, name: str, content: bytes) -> None:
    """Write a file at the relative path by which another file names it."""
    path = folder / os.path.normpath(PureWindowsPath(name).as_posix())
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def _with_lips_cut(text: bytes, cut: LipCut, count: int) -> bytes:
    """Append the doubled vertices of a cut to an OBJ of `count` vertices.

    Polygons of the lower lip get the new vertices. A polygon that the cut crosses becomes
    triangles.
    """
    below = set(map(tuple, cut.below.tolist()))
    new = {int(source): count + place for place, source in enumerate(cut.sources)}
    rows: list[bytes] = []

    def line(found: re.Match[bytes]) -> bytes:
        """Return the line of the next vertex, or of a polygon."""
        if found[1] == b"v":
            rows.append(found[0].rstrip())
            if len(rows) != count:
                return found[0]
            doubled = [rows[vertex] for vertex in new]
            return b"\n".join([rows[-1], *doubled])
        numbers = []
        others = []
        for corner in found[2].split():
            number, slash, other = corner.partition(b"/")
            vertex = int(number)
            numbers.append(vertex - 1 if vertex > 0 else len(rows) + vertex)
            others.append(slash + other)
        lines = []
        for polygon in _cut_polygons(numbers, below, new):
            words = [b"%d%s" % (vertex + 1, others[place]) for place, vertex in polygon]
            lines.append(b"f " + b" ".join(words))
        return b"\n".join(lines)

    return ELEMENT_LINE.sub(line, text)


def _cut_polygons(
    corners: Sequence[int], below: Collection[tuple[int, ...]], new: Mapping[int, int]
) -> list[list[tuple[int, int]]]:
    """Return a polygon after the cut; if the cut crosses the polygon, return its triangles.

    corners: vertices of the polygon. below: triangles of the lower lip, with sorted vertices. new:
    old vertex -> new vertex for triangles of the lower lip. Each corner of a returned polygon is a
    pair: its position in `corners`, and its vertex.
    """
    pieces = []
    becomes: dict[int, set[int]] = {}
    for place in range(1, len(corners) - 1):
        triangle = (0, place, place + 1)
        is_below = tuple(sorted(corners[each] for each in triangle)) in below
        piece = []
        for each in triangle:
            vertex = corners[each]
            piece.append((each, new.get(vertex, vertex) if is_below else vertex))
        for each, vertex in piece:
            becomes.setdefault(each, set()).add(vertex)
        pieces.append(piece)
    if any(len(vertices) > 1 for vertices in becomes.values()):
        return pieces
    return [[(place, vertex) for place in range(len(corners)) for vertex in becomes[place]]]


def _moved_obj(text: bytes, file: FileHead, change: Floats64) -> bytes:
    """Return an OBJ with moved vertices; change: displacements of the vertices [mm], (V, 3)."""
    assert file.painted is not None
    moved = file.head.to_millimetres.inverse.vectors(change)
    points = file.painted.mesh.vertices + moved
    is_moved = np.abs(change).max(axis=1) > 0.0
    numbers = iter(range(len(points)))

    def line(found: re.Match[bytes]) -> bytes:
        """Return the line of the next vertex."""
        number = next(numbers)
        if not is_moved[number]:
            return found[0]
        return ("v " + " ".join(f"{each:.9g}" for each in points[number])).encode()

    return VERTEX_LINE.sub(line, text)


def _triangles(avatar: Avatar, changes: list[Floats64]) -> str:
    """Return all bodies as one OBJ, with a group for each body."""
    lines = []
    first = 1
    file = avatar.file
    for shaped, change in zip(avatar.shapes, changes, strict=True):
        points = shaped.body.rest + change
        if file is None:
            points = METRES_PER_MILLIMETRE * points
        else:
            points = file.head.to_millimetres.inverse.points(points)
        lines.append(f"g {shaped.body.name}")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (shaped.body.faces + first).tolist()]
        first += len(points)
    return "\n".join(lines) + "\n"
