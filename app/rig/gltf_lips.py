"""Cut sealed lips in the primitives of a glTF file by doubling the vertices along the cut.

A doubled vertex has all attributes of its original, and its displacements by shapes of the file. A
cut primitive gets new arrays, because other primitives may use the old arrays.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from risorius.assets.fitting.lips import LipCut
from risorius.assets.gltf import StoredPiece
from risorius.assets.gltf_file import GltfFile
from risorius.geometry.arrays import Integers

from .glb import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, Glb


def vertices_of(pieces: Sequence[StoredPiece], cut: LipCut | None) -> list[Integers]:
    """Return the vertex indices of each piece in the mesh; vertices of a cut come last."""
    found: list[Integers] = []
    start = 0
    total = sum(piece.count for piece in pieces)
    for piece in pieces:
        numbers = np.arange(start, start + piece.count)
        if cut is not None:
            is_own = (cut.sources >= start) & (cut.sources < start + piece.count)
            numbers = np.append(numbers, total + np.flatnonzero(is_own))
        found.append(numbers)
        start += piece.count
    return found


def cut_primitives(
    glb: Glb,
    file: GltfFile,
    pieces: Sequence[StoredPiece],
    vertices: Sequence[Integers],
    cut: LipCut,
) -> None:
    """Double the vertices of the primitives that a cut crosses.

    file: the file from which `glb` was made. vertices: vertex indices of each piece, see
    `vertices_of`.
    """
    done = set()
    for piece, numbers in zip(pieces, vertices, strict=True):
        place = (piece.mesh, piece.primitive)
        if len(numbers) == piece.count or place in done:
            continue
        done.add(place)
        primitive = glb.parts["meshes"][piece.mesh]["primitives"][piece.primitive]
        start = int(numbers[0])
        doubled = cut.sources[numbers[piece.count :] - sum(each.count for each in pieces)] - start
        rows = np.append(np.arange(piece.count), doubled)
        for attributes in (primitive["attributes"], *primitive.get("targets", [])):
            for name, accessor in attributes.items():
                attributes[name] = _rows_of(glb, file, accessor, rows, name)
        triangles = piece.triangles.copy()
        is_below = cut.is_below(triangles + start)
        new = np.arange(piece.count)
        new[doubled] = piece.count + np.arange(len(doubled))
        triangles[is_below] = new[triangles[is_below]]
        kind = np.uint16 if len(rows) <= np.iinfo(np.uint16).max else np.uint32
        primitive["indices"] = glb.accessor(triangles.astype(kind).ravel(), ELEMENT_ARRAY_BUFFER)
        primitive["mode"] = 4  # triangles replace a strip or a fan


def _rows_of(glb: Glb, file: GltfFile, accessor: int, rows: Integers, name: str) -> int:
    """Add an accessor with some rows of another accessor; bone numbers stay integers."""
    values = file.values(accessor)[rows]
    if values.shape[1] == 1:  # a scalar attribute of some program
        values = values[:, 0]
    if not name.startswith("JOINTS"):
        values = values.astype(np.float32)
    return glb.accessor(values, ARRAY_BUFFER, is_bounded=name == "POSITION")
