"""Find triangles that fill the mouth or the eyes of a mesh, so that they can be removed.

A filling lies inside the landmarks of an opening. In masks it is a polygon: it is cut into
triangles, and all its vertices lie on the opening's edge. In scans the front of an eyeball is part
of the skin: there it is a sheet between the lids. The skin loses these triangles and keeps their
vertices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ...geometry.arrays import Flags, Floats64, Integers, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.polylines import arc_lengths
from ...geometry.sides import sides_of
from ..loading import load
from ..meshes import Mesh
from .face_place import placed
from .mesh_validation import COVER_DEPTH, covering

# Landmarks around each opening: the upper chain from corner to corner, then the lower chain back.
OPENING_LANDMARKS = {
    "mouth": ((60, 61, 62, 63, 64), (64, 65, 66, 67, 60)),
    "right eye": ((36, 37, 38, 39), (39, 40, 41, 36)),
    "left eye": ((42, 43, 44, 45), (45, 46, 47, 42)),
}


@dataclass(frozen=True)
class Filling:
    """The triangles of a mesh that fill openings, and the names of the openings."""

    triangles: Integers
    openings: tuple[str, ...]

    @property
    def in_words(self) -> str:
        """Report the filling to the user in one line."""
        *most, last = self.openings
        names = f"{', '.join(most)} and {last} are" if most else f"{last} is"
        count = len(self.triangles)
        return f"its {names} filled by {count} triangles, which are left out; an avatar has them"


def filling_of(mesh: Mesh, indices: Integers32, landmarks: Floats64) -> Filling | None:
    """Find all triangles that fill the mouth or an eye of a mesh; None if there are none.

    indices: vertex indices of the landmarks, (68,). landmarks: points [unit of the mesh], (68, 3).
    """
    to_face = placed(landmarks, load("head"))
    vertices = to_face.points(mesh.vertices)
    points = to_face.points(landmarks)
    piece = pieces_of(mesh.faces, len(mesh.vertices))
    face_piece = np.bincount(piece[indices]).argmax()  # the piece with most landmarks
    own = np.flatnonzero(piece[mesh.faces[:, 0]] == face_piece)
    openings = []
    triangles = []
    for name, chains in OPENING_LANDMARKS.items():
        corners = [number for chain in chains for number in chain[:-1]]
        upper, lower = (_smooth_curve(points[list(chain)]) for chain in chains)
        found = own[_filling(vertices, mesh.faces[own], points[corners], upper, lower)]
        if not len(found) and name.endswith("eye"):
            found = own[_sheet(vertices, mesh.faces[own], points[corners], upper, lower)]
        if len(found):
            openings.append(name)
            triangles.append(found)
    return Filling(np.concatenate(triangles), tuple(openings)) if openings else None


def _smooth_curve(points: Floats64) -> Floats64:
    """Return points (33, 3) of a curve without overshoot through points (n, 3)."""
    place_count = 33
    lengths = arc_lengths(points)
    curve = scipy.interpolate.PchipInterpolator(lengths, points)
    return np.asarray(curve(np.linspace(0.0, lengths[-1], place_count)))


def _filling(
    vertices: Floats64, faces: Integers32, around: Floats64, upper: Floats64, lower: Floats64
) -> Integers:
    """Find the triangles that fill an opening as a polygon with all corners on its edge.

    All points are in the face space [mm], whose z axis points to the viewer.

    around: landmarks of the opening, (n, 3). upper, lower: curves through the landmarks, from the
    first corner to the second and back, (m, 3) each.
    """
    none = np.zeros(0, np.int64)
    edge = np.concatenate([upper[:-1], lower[:-1]])
    centre = edge.mean(axis=0)
    width = float(np.linalg.norm(upper[-1] - upper[0]))
    height = (upper - lower[::-1])[:, 1].mean()
    if height < 0.02 * width:  # shut: no triangle lies in it
        return none
    centroids = vertices[faces].mean(axis=1)
    near = np.flatnonzero(np.linalg.norm(centroids - centre, axis=1) < 0.6 * width)
    used = np.unique(faces[near])
    _, nearest = scipy.spatial.cKDTree(vertices[used]).query(upper[[0, -1]])
    ends = used[nearest]
    for scale in (1.0, 0.9, 0.8):  # smaller curves too, because folds may hang into the opening
        shrunk = centre + scale * (edge - centre)
        inside = near[_is_inside(centroids[near, :2], shrunk[:, :2])]
        # Add triangles outside the curve, between it and a side of the polygon.
        corners = np.append(faces[inside], ends)
        found = np.flatnonzero(np.isin(faces, corners).all(axis=1))
        if _is_polygon(faces[found]):
            return found if _covers_opening(vertices[faces[found]], around, width) else none
    return none


def _sheet(
    vertices: Floats64, faces: Integers32, around: Floats64, upper: Floats64, lower: Floats64
) -> Integers:
    """Find the triangles of a sheet between the lids that covers an eye; see `_filling`."""
    none = np.zeros(0, np.int64)
    edge = np.concatenate([upper[:-1], lower[:-1]])
    centre = around.mean(axis=0)
    width = float(np.linalg.norm(upper[-1] - upper[0]))
    least_height = 0.1  # relative to the width; lids that are nearly shut have no opening
    if (upper - lower[::-1])[:, 1].max() < least_height * width:
        return none
    corners = vertices[faces]
    if not covering(corners, centre).any():
        return none
    centroids = corners.mean(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned = 1.0 if normals[covering(corners, centre), 2].mean() > 0.0 else -1.0
    is_near = (turned * normals[:, 2] > 0.0) & (centroids[:, 2] > centre[2] - COVER_DEPTH)
    near = np.flatnonzero(is_near & (np.linalg.norm(centroids - centre, axis=1) < 0.6 * width))
    for size in (1.0, 0.9, 0.8):  # smaller curves too, because margins of lids are rounded
        shrunk = centre + size * (edge - centre)
        inside = near[_is_inside(centroids[near, :2], shrunk[:, :2])]
        found = _without_teeth(faces, inside)
        if _is_disc(faces[found]):
            return found if _covers_opening(vertices[faces[found]], around, width) else none
    return none


def _covers_opening(corners: Floats64, around: Floats64, width: float) -> bool:
    """Whether triangles (m, 3, 3) have corners near all landmarks (n, 3) of an opening."""
    off = scipy.spatial.cKDTree(corners.reshape(-1, 3)).query(around)[0]
    return bool(off.max() < 0.2 * width)


def _without_teeth(faces: Integers32, found: Integers) -> Integers:
    """Return the largest connected part of a sheet, without triangles attached by one side."""
    most_passes = 5
    for _ in range(most_passes):
        sides = np.sort(sides_of(faces[found]), axis=1)
        _, number, uses = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        shared = (uses[number.ravel()] == 2).reshape(3, -1).sum(axis=0)
        if (shared > 1).all():
            break
        found = found[shared > 1]
    if not len(found):
        return found
    vertex_piece = pieces_of(faces[found], int(faces.max()) + 1)
    piece = vertex_piece[faces[found, 0]]
    largest = np.bincount(piece).argmax()
    return np.asarray(found[piece == largest])


def _is_disc(faces: Integers32) -> bool:
    """Whether triangles form a disc: one sheet with one border that passes no vertex twice."""
    if not len(faces):
        return False
    sides, uses = np.unique(np.sort(sides_of(faces), axis=1), axis=0, return_counts=True)
    border = sides[uses == 1]
    is_simple = len(border) == len(np.unique(border))
    return is_simple and len(np.unique(faces)) - len(sides) + len(faces) == 1


def _is_polygon(faces: Integers32) -> bool:
    """Whether triangles form one polygon with all corners on its edge."""
    sides, uses = np.unique(np.sort(sides_of(faces), axis=1), axis=0, return_counts=True)
    border = sides[uses == 1]
    count = len(faces) + 2  # corners and sides of a polygon with this many triangles
    corner_counts = (len(border), len(np.unique(border)), len(np.unique(faces)))
    return len(faces) > 0 and corner_counts == (count, count, count)


def _is_inside(points: Floats64, polygon: Floats64) -> Flags:
    """Whether each point (n, 2) lies inside a polygon (m, 2); flags (n,)."""
    to_x, to_y = (polygon[:, None] - points).transpose(2, 0, 1)
    angles = np.unwrap(np.arctan2(to_y, to_x), axis=0, period=2.0 * np.pi)
    closing = np.arctan2(to_y[0], to_x[0]) - np.arctan2(to_y[-1], to_x[-1])
    closing -= 2.0 * np.pi * np.rint(closing / (2.0 * np.pi))
    return np.asarray(np.abs(angles[-1] - angles[0] + closing) > np.pi)
