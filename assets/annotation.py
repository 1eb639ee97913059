"""The points of a head that annotators of photographs mark as the 68 points of iBug.

The rig has its own 68 landmarks, at points that muscles need (`Head.landmarks`). Landmarks of a
picture lie on visible borders: on the edges of the lids and of the red of the lips, and on the
painted brow. A jaw has no such border: its points lie on the outline of the face, which is a
different line on the skin for every camera.

Sources: Sagonas et al. 2016, "300 Faces In-The-Wild Challenge: database and results" (the scheme);
Zhu et al. 2015, "High-fidelity pose and expression normalization for face recognition in the wild"
(landmarks of the outline move over the skin as the head turns).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..geometry.arrays import Floats64, Integers32
from ..geometry.closest import MeshSearch, SurfacePoints
from ..geometry.directions import unit_vectors
from ..geometry.normals import vertex_normals
from ..geometry.polylines import arc_lengths, evenly_spaced
from ..geometry.read_only import make_read_only
from .data_files import read_toml
from .fitting.head import FittedHead
from .fitting.warp import ThinPlateSpline, nearest_on
from .identities.person import Person
from .loading import load
from .model import Head, Segment

FIRST_INNER = 17  # the number of the first landmark that is not of the jaw
LANE_COUNT = 25  # paths over the skin on which a side's outline is searched, from eye to chin
LANE_STEPS = 25  # places along each of them
LIP_EDGES = {61: 50, 62: 51, 63: 52, 67: 58, 66: 57, 65: 56}  # each with its outer neighbour
LID_EDGES = {37: 41, 38: 40, 41: 37, 40: 38, 43: 47, 44: 46, 47: 43, 46: 44}  # with its opposite
EDGE_LANDMARKS = (*LIP_EDGES, *LID_EDGES)
EDGE_STEPS = 48  # places on a path from each of these landmarks away from the opening
NEAR_STEPS = 24  # of them on the red, or on the lid; the others are on the skin beside it


@dataclass(frozen=True, eq=False)
class Annotation:
    """The points that annotators mark, on the skin of one head.

    inner: surface points of the landmarks 17 to 67, in their order. lanes: surface points of the
    paths on which the outline is searched: LANE_COUNT paths of LANE_STEPS points on the right side,
    then as many on the left. Each path runs from the cheek outward. edges: surface points of paths
    over lips and lids, EDGE_STEPS from each of EDGE_LANDMARKS away from the mouth or the eye.
    """

    inner: SurfacePoints
    lanes: SurfacePoints
    edges: SurfacePoints

    def __post_init__(self) -> None:
        make_read_only(self.inner)
        make_read_only(self.lanes)
        make_read_only(self.edges)

    def inner_points(self, positions: Floats64) -> Floats64:
        """Return the points 17 to 67 on a skin with vertices (V, 3), shape (51, 3)."""
        return self.inner.interpolate(positions)

    def outline_paths(self, positions: Floats64, normals: Floats64) -> Floats64:
        """Paths of the outline's search on a smooth skin, (2, LANE_COUNT, LANE_STEPS, 3).

        positions: vertices of the skin, (V, 3). normals: unit normals there, (V, 3). Paths on the
        triangles themselves would lie inside the outline of the refined skin.
        """
        paths = self.lanes.interpolate_round(positions, normals)
        return paths.reshape(2, LANE_COUNT, LANE_STEPS, 3)

    def edge_paths(self, positions: Floats64, normals: Floats64) -> Floats64:
        """Paths over lips and lids on a smooth skin, (14, EDGE_STEPS, 3), as `outline_paths`.

        They begin at EDGE_LANDMARKS. The first NEAR_STEPS are on the red, or on the lid.
        """
        paths = self.edges.interpolate_round(positions, normals)
        return paths.reshape(len(EDGE_LANDMARKS), EDGE_STEPS, 3)


def annotation_of(head: Head | FittedHead) -> Annotation:
    """Return the annotation of a head at rest.

    For a user's head these are the points of its landmark file, because they are annotations.
    """
    if isinstance(head, Head | Person):
        points, lanes, edges = _built_in_lookup()
        return Annotation(_with_brows(head, points), lanes, edges)
    known = load("head")
    warp = ThinPlateSpline(known.vertices[known.landmarks], head.vertices[head.landmarks])
    lanes = _built_in_lookup()[1]
    targets = warp.points(lanes.interpolate(known.vertices))
    normals = lanes.interpolate(vertex_normals(known.vertices, known.faces))
    return Annotation(
        _vertices(head.landmarks[FIRST_INNER:]),
        nearest_on(targets, normals, head.vertices, head.faces),
        _edge_paths_of(head),
    )


def _edge_paths_of(head: FittedHead) -> SurfacePoints:
    """Return the paths over lips and lids of a user's head: straight, through its landmarks."""
    marked = head.landmarks[FIRST_INNER:]
    places = _away_from_openings(head.vertices[marked]).reshape(-1, 3)
    normals = _away_from_openings(vertex_normals(head.vertices, head.faces)[marked]).reshape(-1, 3)
    return nearest_on(places, unit_vectors(normals), head.vertices, head.faces)


@lru_cache(maxsize=1)
def _built_in_lookup() -> tuple[SurfacePoints, SurfacePoints, SurfacePoints]:
    """Return points, lanes and paths over edges on the triangles that all persons have."""
    table = read_toml(Path(__file__).with_name("annotation.toml"))
    known = load("head")
    uv = known.uv[known.landmarks[FIRST_INNER:]].astype(np.float64)
    mirrored = known.mirror[known.landmarks]
    for name, place in table["points"].items():
        number = int(name)
        other = int(np.flatnonzero(mirrored == known.landmarks[number])[0])
        uv[number - FIRST_INNER] = place
        uv[other - FIRST_INNER] = place if other == number else _mirror_image(np.array(place))
    outline = table["outline"]
    inner = _evenly_spaced(np.array(outline["inner"]), LANE_COUNT)
    outer = _evenly_spaced(np.array(outline["outer"]), LANE_COUNT)
    fraction = np.linspace(0.0, 1.0, LANE_STEPS)[:, None]
    left = inner[:, None] + fraction * (outer - inner)[:, None]
    lanes = np.stack([_mirror_image(left), left])
    return (
        points_on_texture(uv),
        points_on_texture(lanes.reshape(-1, 2)),
        points_on_texture(_away_from_openings(uv).reshape(-1, 2)),
    )


def _away_from_openings(values: Floats64) -> Floats64:
    """Return values along straight paths that begin at EDGE_LANDMARKS, (14, EDGE_STEPS, k).

    values: those of the landmarks 17 to 67, (51, k).
    """
    lid_height = 0.5  # of a lid's skin beside its edge, as a fraction of the open eye's height
    edges = values[np.array(EDGE_LANDMARKS) - FIRST_INNER]
    red_borders = values[np.array(list(LIP_EDGES.values())) - FIRST_INNER]
    opposite = values[np.array(list(LID_EDGES.values())) - FIRST_INNER]
    lids = edges[len(LIP_EDGES) :]
    ends = np.vstack([red_borders, lids + lid_height * (lids - opposite)])
    fraction = np.arange(EDGE_STEPS)[:, None] / (NEAR_STEPS - 1)
    return np.asarray(edges[:, None] + fraction * (ends - edges)[:, None])


def _mirror_image(uv: Floats64) -> Floats64:
    return np.asarray(uv * [-1.0, 1.0] + [1.0, 0.0])


def _evenly_spaced(corners: Floats64, count: int) -> Floats64:
    """Points along a polyline, equally many between each pair of corners, shape (count, k)."""
    return evenly_spaced(corners, np.arange(float(len(corners))), count)


def points_on_texture(uv: Floats64) -> SurfacePoints:
    """The surface points of the built-in head's skin at texture coordinates (n, 2)."""
    level = np.zeros((len(uv), 1))
    return _texture().closest(np.hstack([uv, level]))


@lru_cache(maxsize=1)
def _texture() -> MeshSearch:
    """Return the built-in head's skin, flattened by its texture coordinates."""
    known = load("head")
    level = np.zeros((len(known.uv), 1))
    return MeshSearch.from_mesh(np.hstack([known.uv.astype(np.float64), level]), known.faces)


def _vertices(numbers: Integers32) -> SurfacePoints:
    """Vertices as points on the surface."""
    count = len(numbers)
    weights = np.tile([1.0, 0.0, 0.0], (count, 1))
    corners = np.repeat(numbers[:, None], 3, axis=1)
    return SurfacePoints(np.zeros(count), np.zeros(count, np.int64), corners, weights)


def _with_brows(head: Head | Person, points: SurfacePoints) -> SurfacePoints:
    """Return the places, with brow points moved to the brows in the head's own picture."""
    corners = points.corners.copy()
    weights = points.weights.copy()
    # Landmarks run from the nose outward; the factor on x mirrors the right brow to the left.
    brows = (
        (Segment.RIGHT_BROW, -1.0, range(21, 16, -1)),
        (Segment.LEFT_BROW, 1.0, range(22, 27)),
    )
    for segment, side, numbers in brows:
        rows, columns = np.nonzero(head.segments[::2, ::2] == segment)
        if len(rows) == 0:
            continue
        size = np.array(head.segments.shape)[::-1]
        pixels = 2.0 * np.column_stack([columns, rows]) + 0.5
        uv = pixels / size * [1.0, -1.0] + [0.0, 1.0]  # v runs upward
        found = points_on_texture(uv)
        as_left_brow = found.interpolate(head.vertices) * [side, 1.0, 1.0]
        chosen = _along_brow(as_left_brow)
        at = np.array(numbers) - FIRST_INNER
        corners[at] = found.corners[chosen]
        weights[at] = found.weights[chosen]
    return SurfacePoints(points.distances, points.triangles, corners, weights)


def _along_brow(points: Floats64) -> Integers32:
    """Indices of five of the points (n, 3) [mm] of a left brow, from the nose outward, (5,).

    They are both ends, and three points on the upper edge at equal distances. The tail ends at the
    point farthest from the inner end, because a tail may turn down there.
    """
    x, y, _ = points.T
    strip_width = 1.0  # [mm]
    strip = np.round((x - x.min()) / strip_width).astype(int)
    edge = []
    for number in range(strip.max() + 1):
        inside = np.flatnonzero(strip == number)
        if len(inside) == 0:
            continue
        wanted = np.median(y[inside]) if number == 0 else y[inside].max()
        edge.append(inside[np.abs(y[inside] - wanted).argmin()])
    from_inner_end = np.linalg.norm(points - points[edge[0]], axis=1)
    edge[-1] = from_inner_end.argmax()
    along = arc_lengths(points[edge])
    stations = np.linspace(0.0, along[-1], 5)
    nearest = np.abs(along[:, None] - stations).argmin(axis=0)
    return np.asarray(np.array(edge)[nearest], dtype=np.int32)
