"""The same head with 4 and 16 times as many triangles: new vertices on the true form.

Every edge gets a new vertex. Where both ends of the edge lie on the implicit form, so does the new
one (Newton steps along the form's gradient); where they were pressed in a little, as the crease of
the lid is, it lies on a level surface between them. Elsewhere, on the rows inside lips, lids and
nostrils and on whatever else was not made from the form, it continues the mesh smoothly: along a
row by the four-point rule, between rows by the curved triangle through the ends and their normals.
Folds stay folds: a normal counts only the faces on the edge's own side of them. Where surfaces
nearly touch, as the lips do, curves could make them cut each other: there new vertices step back,
toward the middle of their edge, until they do not.

Sources: Dyn, Levin and Gregory 1987, "A 4-point interpolatory subdivision scheme for curve
design"; Vlachos et al. 2001, "Curved PN triangles" (the point at half of an edge's cubic).
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from risorius.geometry.normals import cross_products, vertex_normals

from ..topology import Faces, edge_faces, edge_key, quarter
from .fields import Points, Values, gradient, project, unit
from .form import broad_distance as distance
from .intersections import self_intersections
from .skin import SkinMesh

LEVELS = 2
ON_FORM = 0.03  # [mm] such a vertex lies on the form
NEAR_FORM = 1.8  # [mm] such a one was made from it and pressed in; the lid's crease: 1.5
ALONG_FORM, ALONG_NEAR_FORM = 0.5, 0.8  # least cosine between the normals of mesh and form
RUN_OUT = 0.25  # what a dent keeps halfway to the form: it must not show the coarse triangles
MISSED = 0.03  # [mm] off the level surface after projection: then the smooth rule holds
SAME_SIDE = 0.17  # cosine: faces that turn by more than 80 degrees are beyond a fold
FOLD = 1.53  # length of the sum of two unit normals that differ by 80 degrees
FARTHEST = 0.3  # of an edge's length: a new vertex may leave its middle by so much
STEP_BACK, ROUNDS = 0.5, 12  # what is left of a step that cuts, and how often at most
SHARP_TURN = 0.0  # cosine: a row that turns by more than 90 degrees ends there (mouth corner)

Numbers = npt.NDArray[np.int32]


@dataclass
class Row:
    """A curve that the mesh follows: a row around an opening, the free border.

    vertices: numbers along it, shape (n,).
    closed: whether the last is followed by the first.
    """

    vertices: Numbers
    closed: bool

    def edges(self) -> Numbers:
        """Numbers of neighbours along the row, shape (n or n - 1, 2)."""
        pairs = np.stack([self.vertices, np.roll(self.vertices, -1)], axis=1)
        return pairs if self.closed else pairs[:-1]


@dataclass
class Level:
    """A mesh under refinement.

    vertices: [mm], shape (n, 3).
    faces: shape (F, 3).
    mirror: number of each vertex' mirror image, shape (n,).
    value: of the implicit form at vertices that were made from it, about their distance from it
        [mm]; NaN at all others; shape (n,).
    rows: see `Row`.
    """

    vertices: Points
    faces: Faces
    mirror: Numbers
    value: Values
    rows: list[Row]


def refine_skin(skin: SkinMesh) -> tuple[Points, Points]:
    """Refine as often as LEVELS says.

    Returns the vertices that are new, level by level, shape (m, 3), rounded to float32, and the
    unit normals of all vertices, old and new, shape (n, 3).
    """
    level = Level(skin.vertices, skin.faces, skin.mirror, _form_values(skin), _rows(skin))
    for _ in range(LEVELS):
        level = refined(level)
    return level.vertices[len(skin.vertices) :], _normals(level)


def refined(level: Level) -> Level:
    """Cut every triangle into four and place the new vertices."""
    count = len(level.vertices)
    cut = quarter(level.faces, count)
    edges = cut.edges
    middle = level.vertices[edges].mean(axis=1)
    limit = FARTHEST * np.linalg.norm(np.diff(level.vertices[edges], axis=1)[:, 0], axis=1)

    edge_normal, is_fold = _edge_normals(level, cut.faces, count, len(edges))
    step = _curved_steps(level, edges, edge_normal)
    for row in level.rows:
        step[_edge_numbers(edges, row.edges(), count)] = _row_steps(level.vertices, row)
    step = _bounded(step, limit)

    value = np.where(is_fold, np.nan, _values_between(*level.value[edges].T))
    made = np.flatnonzero(~np.isnan(value))
    target = value[made]
    wanted = project(lambda points: distance(points) - target, (middle + step)[made])
    step[made] = _bounded(wanted - middle[made], limit[made])
    value[made[_miss((middle + step)[made], target) > MISSED]] = np.nan

    image = _edge_numbers(edges, level.mirror[edges], count)
    step = 0.5 * (step + step[image] * [-1.0, 1.0, 1.0])  # symmetric to the last bit
    share = _free_of_cuts(level.vertices, cut.faces, middle, step, image)
    point = (middle + share[:, None] * step).astype(np.float32)
    return Level(
        np.vstack([level.vertices, point]),
        cut.faces,
        np.r_[level.mirror, count + image].astype(np.int32),
        np.r_[level.value, np.where(share == 1.0, 0.5 * (value + value[image]), np.nan)],
        [_finer_row(row, edges, count) for row in level.rows],
    )


def _free_of_cuts(
    old: Points, faces: Faces, middle: Points, step: Points, image: npt.NDArray[np.int64]
) -> Values:
    """Share of each step that may be made so that no two faces cut each other, shape (E,).

    Raises RuntimeError if the cuts do not end: then the coarse mesh has some.
    """
    share = np.ones(len(step))
    for _ in range(ROUNDS):
        point = (middle + share[:, None] * step).astype(np.float32)
        cutting = self_intersections(np.vstack([old, point]), faces)
        if len(cutting) == 0:
            return share
        new = np.unique(faces[cutting.ravel()])
        new = new[new >= len(old)] - len(old)
        new = np.union1d(new, image[new])
        share[new] = np.where(share[new] > 0.1, STEP_BACK * share[new], 0.0)
    raise RuntimeError(f"{len(cutting)} pairs of faces of the finer mesh cut each other")


def _miss(points: Points, value: float | Values) -> Values:
    """About how far the points are from the form's level surface [mm], shape (n,)."""
    steepness = np.linalg.norm(gradient(distance, points), axis=1)
    miss: Values = np.abs(distance(points) - value) / np.maximum(steepness, 0.3)
    return miss


def _values_between(first: Values, second: Values) -> Values:
    """Values of the form between ends: the mean, or less where one end lies on the form."""
    runs_out = (np.abs(first) < ON_FORM) != (np.abs(second) < ON_FORM)
    return np.where(runs_out, RUN_OUT, 0.5) * (first + second)


def _form_values(skin: SkinMesh) -> Values:
    normal = vertex_normals(skin.vertices, skin.faces)
    along = (normal * unit(gradient(distance, skin.vertices))).sum(axis=1)
    away = _miss(skin.vertices, 0.0)
    is_on = (away < ON_FORM) & (along > ALONG_FORM)
    is_near = (away < NEAR_FORM) & (along > ALONG_NEAR_FORM)
    return np.where(is_on | is_near, distance(skin.vertices), np.nan)


def _normals(level: Level) -> Points:
    """Unit normals: of the form where the mesh lies on it, else of the mesh, shape (n, 3)."""
    normals = vertex_normals(level.vertices, level.faces)
    on_form = np.abs(level.value) < ON_FORM
    normals[on_form] = unit(gradient(distance, level.vertices[on_form]))
    return normals


def _rows(skin: SkinMesh) -> list[Row]:
    """All named rows of both sides; halves that end in the mid-plane are joined.

    A row whose neighbours are no neighbours in the mesh is only a list of names: left out.
    """
    rows = []
    existing = edge_faces(skin.faces)
    for left in skin.rings.values():
        numbers = np.array(left, dtype=np.int32)
        image = skin.mirror[numbers]
        if (numbers[[0, -1]] == image[[0, -1]]).all():
            candidates = [Row(np.r_[numbers, image[-2:0:-1]], closed=True)]
        else:
            closed = edge_key(left[0], left[-1]) in existing
            candidates = [Row(numbers, closed), Row(image, closed)]
        rows += [
            row for row in candidates if all(edge_key(a, b) in existing for a, b in row.edges())
        ]
    return rows


def _finer_row(row: Row, edges: Numbers, count: int) -> Row:
    between = count + _edge_numbers(edges, row.edges(), count)
    finer = np.empty(len(row.vertices) + len(between), dtype=np.int32)
    finer[0::2], finer[1::2] = row.vertices, between
    return Row(finer, row.closed)


def _edge_numbers(edges: Numbers, wanted: Numbers, count: int) -> npt.NDArray[np.int64]:
    """Places in the sorted edge list of pairs of vertices in any order, shape (n,)."""
    keys = edges[:, 0].astype(np.int64) * count + edges[:, 1]
    ends = np.sort(wanted, axis=1).astype(np.int64)
    return np.searchsorted(keys, ends[:, 0] * count + ends[:, 1])


def _bounded(steps: Points, limit: Values) -> Points:
    length = np.linalg.norm(steps, axis=1)
    bounded: Points = steps * np.minimum(1.0, limit / np.maximum(length, 1e-9))[:, None]
    return bounded


def _edge_normals(
    level: Level, cut_faces: Faces, count: int, edge_count: int
) -> tuple[Points, npt.NDArray[np.bool_]]:
    """Unit normal of each edge, shape (E, 3), and whether the mesh is folded along it."""
    # The middle child of each face has the new vertices of its three edges.
    sides = cut_faces[3::4] - count
    normal = unit(cross_products(level.vertices, level.faces))
    total, beside = np.zeros((edge_count, 3)), np.zeros(edge_count)
    for side in range(3):
        np.add.at(total, sides[:, side], normal)
        np.add.at(beside, sides[:, side], 1.0)
    is_fold: npt.NDArray[np.bool_] = (np.linalg.norm(total, axis=1) < FOLD) & (beside == 2)
    return unit(total), is_fold


def _curved_steps(level: Level, edges: Numbers, edge_normal: Points) -> Points:
    """From the middle of each edge to the curve through its ends, shape (E, 3)."""
    ends = level.vertices[edges]
    along = ends[:, 1] - ends[:, 0]
    result = np.zeros_like(along)
    for end, sign in ((0, -1.0), (1, 1.0)):
        normal = _own_side_normals(level, edges[:, end], edge_normal)
        result += sign / 8.0 * (along * normal).sum(axis=1, keepdims=True) * normal
    return result


def _own_side_normals(level: Level, vertices: Numbers, side: Points) -> Points:
    """Normals at the vertices from those faces that look about the way `side` does, (n, 3)."""
    cross = cross_products(level.vertices, level.faces)
    corner_vertices = level.faces.ravel()
    order = np.argsort(corner_vertices, kind="stable")
    degree = np.bincount(corner_vertices, minlength=len(level.vertices))
    start = np.r_[0, np.cumsum(degree)[:-1]]
    counts = degree[vertices]
    owner = np.repeat(np.arange(len(vertices)), counts)
    within = np.arange(len(owner)) - np.repeat(np.r_[0, np.cumsum(counts)[:-1]], counts)
    face = order[np.repeat(start[vertices], counts) + within] // 3
    agrees = np.flatnonzero((unit(cross[face]) * side[owner]).sum(axis=1) > SAME_SIDE)
    total = np.zeros_like(side)
    np.add.at(total, owner[agrees], cross[face[agrees]])
    has_own = np.asarray(total.any(axis=1))
    return np.where(has_own[:, None], unit(total), side)


def _row_steps(vertices: Points, row: Row) -> Points:
    """From the middle of each edge of a row to the curve through the row, shape (n, 3)."""
    edges = row.edges()
    first, second = vertices[edges[:, 0]], vertices[edges[:, 1]]
    along = second - first
    before, after = np.roll(along, 1, axis=0), np.roll(along, -1, axis=0)
    turn = (unit(along) * unit(before)).sum(axis=1)
    goes_on_before = np.asarray(turn > SHARP_TURN)
    goes_on_after = np.roll(goes_on_before, -1)
    if not row.closed:
        goes_on_before[0] = goes_on_after[-1] = False
    # Four points p0 .. p3: (p1 + p2 - p0 - p3) / 16 = (before - after) / 16; a row that ends goes
    # straight on.
    before = np.where(goes_on_before[:, None], before, along)
    after = np.where(goes_on_after[:, None], after, along)
    return (before - after) / 16.0
