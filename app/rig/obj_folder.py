"""An avatar as a folder of OBJs, one a shape, for programs that make targets of meshes.

All have the same vertices in the same order: `neutral.obj` at rest, and each other where its shape
is at 1. An OBJ that was brought keeps its lines, but for those of vertices that a shape moves. Any
other head, and one whose lips were sealed, is written as triangles, body by body: in the unit of
its file, the built-in one in metres.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from risorius.geometry.arrays import Floats64

from .avatar import Avatar, FileHead
from .surface import METRES

OWN = re.compile(r"\w[\w.]*\.obj")  # names of files in such a folder
VERTEX = re.compile(rb"(?m)^[ \t]*v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)")


def write_obj_folder(avatar: Avatar, folder: Path) -> None:
    """Write all of them."""
    file = avatar.file
    text = None
    is_kept = file is not None and file.head.lip_cut is None
    if is_kept and file is not None and file.path.suffix.lower() == ".obj":
        text = file.path.read_bytes()
    for name, changes in _shapes(avatar):
        path = folder / f"{name}.obj"
        if text is None or file is None:
            path.write_text(_triangles(avatar, changes), encoding="utf-8")
        else:
            path.write_bytes(_rewritten(text, file, changes[0]))


def _shapes(avatar: Avatar) -> Iterator[tuple[str, list[Floats64]]]:
    """Each file's name, and how far the vertices of each body are from rest [mm], (V, 3)."""
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


def _rewritten(text: bytes, file: FileHead, change: Floats64) -> bytes:
    """An OBJ with other coordinates for the vertices that are moved [mm], (V, 3)."""
    assert file.painted is not None
    moved = file.head.to_millimetres.inverse.vectors(change)
    points = file.painted.mesh.vertices + moved
    is_moved = np.abs(change).max(axis=1) > 0.0
    numbers = iter(range(len(points)))

    def line(found: re.Match[bytes]) -> bytes:
        """The line of the next vertex."""
        number = next(numbers)
        if not is_moved[number]:
            return found[0]
        return ("v " + " ".join(f"{each:.9g}" for each in points[number])).encode()

    return VERTEX.sub(line, text)


def _triangles(avatar: Avatar, changes: list[Floats64]) -> str:
    """All bodies as one OBJ, a group each."""
    lines = []
    first = 1
    file = avatar.file
    for shaped, change in zip(avatar.shapes, changes, strict=True):
        points = shaped.body.rest + change
        if file is None:
            points = METRES * points
        else:
            points = file.head.to_millimetres.inverse.points(points)
        lines.append(f"g {shaped.body.name}")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (shaped.body.faces + first).tolist()]
        first += len(points)
    return "\n".join(lines) + "\n"
