"""Find triangles that fill the mouth or the eyes of a mesh, so that they can be removed.

A filling lies inside the landmarks of an opening. In masks it is a polygon: it is cut into
triangles, and all its vertices lie on the opening's edge. In scans the front of an eyeball is part
of the skin: there it is a sheet between the lids. The skin loses these triangles and keeps their
vertices.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Flags, Floats64, Integers, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.normals import cross_products
from ...geometry.polylines import arc_lengths
from ...geometry.sides import border_edges, different_pairs, edges_of, numbered_edges, sides_of
from ..loading import load
from ..meshes import Mesh
from .face_place import placed
from .mesh_validation import COVER_DEPTH, covering
from .smooth_paths import smooth_path

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
    faces = mesh.faces[own]
    openings = []
    triangles = []
    for name, chains in OPENING_LANDMARKS.items():
        corners = [number for chain in chains for number in chain[:-1]]
        around = points[corners]
        upper, lower = (_smooth_curve(points[list(chain)]) for chain in chains)
        opening = _Opening(around, upper, lower)
        found = own[_filling(vertices, faces, opening)]
        if not len(found) and name.endswith("eye"):
            found = own[_sheet(vertices, faces, opening)]
        if len(found):
            openings.append(name)
            triangles.append(found)
    if not openings:
        return None
    return Filling(np.concatenate(triangles), tuple(openings))


def _smooth_curve(points: Floats64) -> Floats64:
    """Return points (33, 3) of a curve without overshoot through points (n, 3)."""
    place_count = 33
    lengths = arc_lengths(points)
    curve = scipy.interpolate.PchipInterpolator(lengths, points)
    return np.asarray(curve(np.linspace(0.0, lengths[-1], place_count)))


class _Opening(NamedTuple):
    """The mouth or the opening of an eye, in the face space [mm]; z leads to the viewer."""

    around: Floats64  # (n, 3) landmarks
    upper: Floats64  # (m, 3) curve through the landmarks from the first corner to the second
    lower: Floats64  # (m, 3) curve back to the first corner

    @property
    def edge(self) -> Floats64:
        """Both curves, once around, (2 m - 2, 3)."""
        return np.concatenate([self.upper[:-1], self.lower[:-1]])

    @property
    def width(self) -> float:
        """Distance of the corners [mm]."""
        return float(np.linalg.norm(self.upper[-1] - self.upper[0]))

    @property
    def heights(self) -> Floats64:
        """Heights of the upper curve above the lower one [mm], (m,)."""
        return (self.upper - self.lower[::-1])[:, 1]

    def outlines(self, centre: Floats64) -> list[Floats64]:
        """The edge from the front, (2 m - 2, 2), and smaller ones, shrunk toward a point (3,).

        Folds of skin may hang into the opening, and margins of lids are rounded.
        """
        return [(centre + scale * (self.edge - centre))[:, :2] for scale in (1.0, 0.9, 0.8)]

    def is_covered_by(self, corners: Floats64) -> bool:
        """Whether triangles (k, 3, 3) have corners near all landmarks.

        Paths along the long edges of a coarse mesh meet before the corner of an eye.
        """
        off = scipy.spatial.cKDTree(corners.reshape(-1, 3)).query(self.around)[0]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        edge_share = min(0.5 * float(np.median(sides)), 0.1 * self.width)
        return bool(off.max() < 0.2 * self.width + edge_share)


def _filling(vertices: Floats64, faces: Integers32, opening: _Opening) -> Integers:
    """Find the triangles that fill an opening as a polygon with all corners on its edge."""
    none = np.zeros(0, np.int64)
    if opening.heights.mean() < 0.02 * opening.width:  # shut: no triangle lies in it
        return none
    centre = opening.edge.mean(axis=0)
    centroids = vertices[faces].mean(axis=1)
    distances = np.linalg.norm(centroids - centre, axis=1)
    near = np.flatnonzero(distances < 0.6 * opening.width)
    used = np.unique(faces[near])
    _, nearest = scipy.spatial.cKDTree(vertices[used]).query(opening.upper[[0, -1]])
    ends = used[nearest]
    for outline in opening.outlines(centre):
        inside = near[_is_inside(centroids[near, :2], outline)]
        # Add triangles outside the curve, between it and a side of the polygon.
        corners = np.append(faces[inside], ends)
        found = np.flatnonzero(np.isin(faces, corners).all(axis=1))
        filling = faces[found]
        if _is_polygon(filling):
            return found if opening.is_covered_by(vertices[filling]) else none
    return none


def _sheet(vertices: Floats64, faces: Integers32, opening: _Opening) -> Integers:
    """Find the triangles of a sheet between the lids that covers an eye."""
    none = np.zeros(0, np.int64)
    centre = opening.around.mean(axis=0)
    least_height = 0.1  # relative to the width; lids that are nearly shut have no opening
    if opening.heights.max() < least_height * opening.width:
        return none
    corners = vertices[faces]
    is_cover = covering(corners, centre)
    if not is_cover.any():
        return none
    forward = cross_products(vertices, faces)[:, 2]
    if forward[is_cover].mean() <= 0.0:  # the mesh is inside out
        forward = -forward
    centroids = corners.mean(axis=1)
    is_in_front = centroids[:, 2] > centre[2] - COVER_DEPTH
    is_near = np.linalg.norm(centroids - centre, axis=1) < 0.6 * opening.width
    near = np.flatnonzero((forward > 0.0) & is_in_front & is_near)
    between = _between_paths(vertices, faces, near, opening, is_cover)
    # The paths of a dense mesh may touch beside a corner of the eye.
    for found in (between, _without_teeth(faces, between)):
        if _is_disc(faces[found]) and opening.is_covered_by(corners[found]):
            return found
    for outline in opening.outlines(centre):
        inside = near[_is_inside(centroids[near, :2], outline)]
        found = _without_teeth(faces, inside)
        sheet = faces[found]
        if _is_disc(sheet):
            return found if opening.is_covered_by(vertices[sheet]) else none
    return none


def _between_paths(
    vertices: Floats64, faces: Integers32, near: Integers, opening: _Opening, is_cover: Flags
) -> Integers:
    """Find triangles between smooth paths along edges beside the lids; none if no path is there.

    near: indices of the triangles near the eye, in front. is_cover: flags of the triangles before
    the eye's centre, (F,).
    """
    none = np.zeros(0, np.int64)
    steps = []
    for curve in (opening.upper, opening.lower):
        path = smooth_path(vertices, faces[near], curve)
        if path is None:
            return none
        steps.append(np.column_stack([path[:-1], path[1:]]))
    border = np.concatenate(steps)
    sides = np.concatenate([border, sides_of(faces[near])])
    _, number = different_pairs(np.sort(sides, axis=1))
    of_sides = number[len(border) :]
    inner = np.flatnonzero(~np.isin(of_sides, number[: len(border)]))
    owner = np.tile(np.arange(len(near)), 3)[inner]
    # Triangles are connected through their sides, which are numbered after the triangles.
    links = np.column_stack([owner, len(near) + of_sides[inner]])
    part = pieces_of(links, len(near) + int(number.max()) + 1)[: len(near)]
    covering_parts = part[is_cover[near]]
    if not len(covering_parts):
        return none
    return np.asarray(near[part == np.bincount(covering_parts).argmax()])


def _without_teeth(faces: Integers32, found: Integers) -> Integers:
    """Return the largest connected part of a sheet, without triangles attached by one side."""
    most_passes = 5
    for _ in range(most_passes):
        _, number = numbered_edges(faces[found])
        is_shared = (np.bincount(number)[number] == 2).reshape(3, -1)
        is_held = is_shared.sum(axis=0) > 1
        if is_held.all():
            break
        found = found[is_held]
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
    border = border_edges(faces)
    is_simple = len(border) == len(np.unique(border))
    euler_characteristic = len(np.unique(faces)) - len(edges_of(faces)) + len(faces)
    return is_simple and euler_characteristic == 1


def _is_polygon(faces: Integers32) -> bool:
    """Whether triangles form one polygon with all corners on its edge."""
    border = border_edges(faces)
    count = len(faces) + 2  # corners and sides of a polygon with this many triangles
    counts = (len(border), len(np.unique(border)), len(np.unique(faces)))
    return len(faces) > 0 and counts == (count, count, count)


def _is_inside(points: Floats64, polygon: Floats64) -> Flags:
    """Whether each point (n, 2) lies inside a polygon (m, 2); flags (n,)."""
    full_turn = 2.0 * np.pi
    to_x, to_y = (polygon[:, None] - points).transpose(2, 0, 1)
    directions = np.arctan2(to_y, to_x)
    angles = np.unwrap(directions, axis=0, period=full_turn)
    closing = directions[0] - directions[-1]
    closing -= full_turn * np.rint(closing / full_turn)
    winding = angles[-1] - angles[0] + closing
    return np.asarray(np.abs(winding) > np.pi)
