"""The file with the 68 landmarks of a head: JSON, vertex numbers or coordinates.

    {"landmarks": [1225, 1888, ...]}              vertex numbers, counted from 0
    {"landmarks": [[-73.6, 36.8, 36.6], ...]}     points on the mesh, in its own unit

The key may be called anything, other keys are left alone, and the bare list will do.
Source: Sagonas et al. 2013, "300 Faces in-the-Wild Challenge" (the order of the points).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from ..meshes import Mesh
from ..model import AssetError, FloatArray, IndexArray
from .soundness import ways
from .warp import nearest_on

COUNT = 68
LONGEST_FILE = 2**24  # [bytes] that are read
FARTHEST = 0.05  # of the distance between the outer eye corners: a point off the mesh is a mistake
OUTER_EYE_CORNERS = [36, 45]
OUTER_LIPS = ((50, 51, 52), (56, 57, 58))  # upper, lower
INNER_LIPS = ((61, 62, 63), (65, 66, 67))


def read_landmarks(path: Path, mesh: Mesh) -> tuple[IndexArray, FloatArray]:
    """The 68 landmarks of a mesh: vertex numbers (68,), int32, and points (68, 3) [its unit].

    Where the file holds points, they lie between vertices and the numbers are the nearest ones.

    Raises AssetError for a file that is missing or no JSON, another count, and a point that is not
    on the mesh.
    """
    try:
        with path.open("rb") as file:
            document = json.loads(file.read(LONGEST_FILE).decode("utf-8-sig"))
    except FileNotFoundError:
        raise AssetError(f"{path}: no such landmark file") from None
    except (OSError, ValueError, RecursionError) as error:
        raise AssetError(f"{path}: not readable as JSON: {error}") from None
    found = _list_in(document)
    if found is None:
        raise AssetError(
            f'{path}: holds no list; it must be {{"landmarks": [...]}} with {COUNT} vertex numbers '
            "or points [x, y, z]"
        )
    if len(found) != COUNT:
        raise AssetError(f"{path}: {len(found)} landmarks; it must be the {COUNT} iBug points")
    if all(isinstance(entry, int) and not isinstance(entry, bool) for entry in found):
        numbers = _numbers(path, found, len(mesh.vertices))
        return numbers, mesh.vertices[numbers]
    points = _points(path, found)
    return _nearest(path, points, mesh), points


def _list_in(document: Any) -> list[Any] | None:
    """The list of landmarks: the document itself, or the longest list in it."""
    if isinstance(document, list):
        return document
    if not isinstance(document, dict):
        return None
    lists = [entry for entry in document.values() if isinstance(entry, list)]
    return max(lists, key=len, default=None)


def _numbers(path: Path, found: list[Any], count: int) -> IndexArray:
    for place, number in enumerate(found):
        if not 0 <= number < count:
            raise AssetError(
                f"{path}: landmark {place} is vertex {number}; the mesh has vertices "
                f"0 to {count - 1}"
            )
    return np.array(found, dtype=np.int32)


def _points(path: Path, found: list[Any]) -> FloatArray:
    try:
        points = np.array(found, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.zeros(0)
    if points.shape != (COUNT, 3) or not np.isfinite(points).all():
        raise AssetError(
            f"{path}: every landmark must be a vertex number, or every one a point [x, y, z]"
        )
    return points


def _nearest(path: Path, points: FloatArray, mesh: Mesh) -> IndexArray:
    """The vertices nearest to points; each point must be near the mesh.

    Where lips touch, the nearest vertex may be on the other lip. So a point inside of the lips goes
    to the nearest vertex that is nearer, along the skin, to the outside of its own lip.
    """
    on_mesh = nearest_on(points, np.zeros_like(points), mesh.vertices, mesh.faces)
    distance = np.linalg.norm(on_mesh.carry(mesh.vertices) - points, axis=1)
    allowed = FARTHEST * float(np.linalg.norm(np.diff(points[OUTER_EYE_CORNERS], axis=0)))
    if distance.max() > allowed:
        place = int(distance.argmax())
        raise AssetError(
            f"{path}: landmark {place} lies {distance[place]:.3g} units off the mesh; allowed are "
            f"{allowed:.3g} (a twentieth of the eyes' distance): are unit and axes the mesh's?"
        )
    numbers: IndexArray = cKDTree(mesh.vertices).query(points)[1].astype(np.int32)
    to_upper, to_lower = (
        ways(mesh.vertices, mesh.faces, numbers[list(lip)]).min(axis=0) for lip in OUTER_LIPS
    )
    for lip, is_own in zip(INNER_LIPS, (to_upper < to_lower, to_lower < to_upper), strict=True):
        own = np.flatnonzero(is_own)
        if len(own):
            numbers[list(lip)] = own[cKDTree(mesh.vertices[own]).query(points[list(lip)])[1]]
    return numbers
