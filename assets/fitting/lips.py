"""Separate lips that are joined in a mesh, so that muscles can part them.

There are two cases. In the first, the file has doubled vertices along the lips, which the reader
merged; `lips_parted` separates them again. In the second, skin covers the mouth; `lip_cut` cuts it
along the landmarks of the inner lips, 60 to 67. Vertices on this line are doubled, except at its
two ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy

from ...geometry.arrays import Flags, Floats64, Integers, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.sides import sides_of
from ..meshes import Mesh
from .smooth_paths import distances_from, smooth_path

UPPER_LIP_CHAIN = (60, 61, 62, 63, 64)
LOWER_LIP_CHAIN = (60, 67, 66, 65, 64)
OUTER_MIDDLES = (51, 57)  # landmarks on the outer borders of the upper and the lower lip


def lips_line(landmarks: Floats64) -> Floats64:
    """Return the line between the lips, from right to left, (5, 3); landmarks: (68, 3)."""
    return (landmarks[list(UPPER_LIP_CHAIN)] + landmarks[list(LOWER_LIP_CHAIN)]) / 2.0


def lips_parted(mesh: Mesh, landmarks: Floats64) -> Mesh | None:
    """Separate merged vertices of a mesh where its lips touch; None if no vertex was merged there.

    A file doubles vertices along seams of its texture, and the reader merges them. Between lips
    they must stay separate. landmarks: points [unit of the mesh], (68, 3).
    """
    if mesh.corners is None or mesh.same is None:
        return None
    line = lips_line(landmarks)
    # Greatest distance of touching lips from the line between them, relative to the distance of the
    # outer eye corners.
    most_gap = 0.01
    right_eye_corner, left_eye_corner = landmarks[[36, 45]]
    near = most_gap * float(np.linalg.norm(left_eye_corner - right_eye_corner))
    from_line = distances_from(mesh.vertices, line)
    mouth_corners = scipy.spatial.cKDTree(line[[0, -1]])
    from_corner, _ = mouth_corners.query(mesh.vertices)
    is_lip = (from_line < near) & (from_corner >= near)
    same = np.where(is_lip, np.arange(len(mesh.vertices)), mesh.same)
    if np.array_equal(same, mesh.same):
        return None
    return replace(mesh, faces=same[mesh.corners].astype(np.int32), same=same)


@dataclass(frozen=True)
class LipCut:
    """A cut between the lips of a mesh; it doubles vertices.

    sources: the file's vertices that are doubled, (n,). The new vertices come after the last vertex
        of the file.
    below: triangles of the lower lip at the cut, which get the new vertices, (k, 3). Each row holds
        vertex indices of the file in rising order.
    landmarks: vertex indices of the landmarks in the cut mesh, (68,).
    points: points of the landmarks [unit of the mesh], (68, 3).
    """

    sources: Integers
    below: Integers
    landmarks: Integers32
    points: Floats64

    @property
    def in_words(self) -> str:
        """Report the cut to the user in one line."""
        return f"its lips were sealed: they are cut apart, {len(self.sources)} vertices are doubled"

    def applied(self, mesh: Mesh) -> Mesh:
        """Cut the mesh of the file."""
        count = len(mesh.vertices)
        corners = mesh.file_corners.copy()
        rows = np.flatnonzero(self.is_below(corners))
        new_index = np.arange(count)
        new_index[self.sources] = count + np.arange(len(self.sources))
        corners[rows] = new_index[corners[rows]]
        same = mesh.used_vertices
        # New vertices that coincide are merged.
        _, first, number = np.unique(same[self.sources], return_index=True, return_inverse=True)
        same = np.concatenate([same, count + first[number]])
        faces = mesh.faces.copy()
        faces[rows] = same[corners[rows]]
        doubled = np.concatenate([np.arange(count), self.sources])
        return replace(
            mesh,
            vertices=mesh.vertices[doubled],
            faces=faces,
            colours=None if mesh.colours is None else mesh.colours[doubled],
            has_colour=None if mesh.has_colour is None else mesh.has_colour[doubled],
            same=same,
            corners=corners.astype(np.int32),
        )

    def is_below(self, triangles: Integers) -> Flags:
        """Whether each triangle of the file (F, 3) gets new vertices; flags (F,)."""
        known = set(map(tuple, self.below.tolist()))
        touched = np.flatnonzero(np.isin(triangles, self.sources).any(axis=1))
        found = np.zeros(len(triangles), np.bool_)
        rows = np.sort(triangles[touched], axis=1).tolist()
        found[touched] = [tuple(row) in known for row in rows]
        return found


def lip_cut(mesh: Mesh, indices: Integers32, landmarks: Floats64) -> LipCut | None:
    """Find the cut between joined lips.

    Returns None if the lips are apart, or if no path of edges runs between them. indices: vertex
    indices of the landmarks, (68,). landmarks: points [unit of the mesh], (68, 3).
    """
    line = lips_line(landmarks)
    gaps = landmarks[list(UPPER_LIP_CHAIN)] - landmarks[list(LOWER_LIP_CHAIN)]
    most_gap = 0.12  # greatest gap between lips, relative to the distance of the mouth's corners
    width = np.linalg.norm(line[-1] - line[0])
    if np.linalg.norm(gaps, axis=1).max() > most_gap * width:
        return None
    path = smooth_path(mesh.vertices, mesh.faces, line)
    if path is None or len(path) < 5:  # with fewer edges, a mouth has no shape
        return None
    inner = path[1:-1]
    parts = _sides_of_path(mesh.faces, path)
    if len(parts) != 2:
        return None
    upper_middle, lower_middle = landmarks[list(OUTER_MIDDLES)]
    up = upper_middle - lower_middle
    heights = []
    for part in parts:
        centroid = mesh.vertices[mesh.faces[part]].mean(axis=(0, 1))
        heights.append(float(centroid @ up))
    below = parts[int(np.argmin(heights))]
    corners = mesh.file_corners
    same = mesh.used_vertices
    used = np.unique(corners[below])
    sources = used[np.isin(same[used], inner)]
    indices = indices.copy()
    points = np.array(landmarks, np.float64)
    new: dict[int, int] = {}
    for place, source in enumerate(sources):
        new.setdefault(int(same[source]), len(same) + place)
    on_path = scipy.spatial.cKDTree(mesh.vertices[inner])
    for upper, lower, place in zip(
        UPPER_LIP_CHAIN[1:4], LOWER_LIP_CHAIN[1:4], line[1:4], strict=True
    ):
        vertex = int(inner[on_path.query(place)[1]])
        indices[upper] = vertex
        indices[lower] = new[vertex]
        points[[upper, lower]] = mesh.vertices[vertex]
    for corner, vertex in ((UPPER_LIP_CHAIN[0], path[0]), (UPPER_LIP_CHAIN[-1], path[-1])):
        indices[corner] = vertex
        points[corner] = mesh.vertices[vertex]
    return LipCut(sources, np.sort(corners[below], axis=1), indices, points)


def _sides_of_path(faces: Integers32, path: Integers) -> list[Integers]:
    """Return the triangles at a path's inner vertices, in a group for each side of the path."""
    strip = np.flatnonzero(np.isin(faces, path[1:-1]).any(axis=1))
    sides = np.sort(sides_of(faces[strip]), axis=1)
    owner = np.tile(np.arange(len(strip)), 3)
    steps = {tuple(sorted(step)) for step in pairwise(path.tolist())}
    links = []
    first: dict[tuple[int, ...], int] = {}
    for side, triangle in zip(map(tuple, sides.tolist()), owner.tolist(), strict=True):
        if side in steps:
            continue
        if side in first:
            links.append((first[side], triangle))
        first[side] = triangle
    part = pieces_of(np.array(links or [(0, 0)]), len(strip))
    return [strip[part == number] for number in range(part.max() + 1)]
