r"""Blending without popping: the refined surface is a continuous function of the positions.

Kähler, Haber, Seidel 2003, put a new point at its final position in the frame in which its edge
passes a threshold. Here the point begins on the straight edge, and moves out while the metric of
its edge rises further. Two things must be continuous:

*Points.* A criterion measures the refinement metric of an edge: above 0 it is split once, above 1
twice.

    weight once    metric / RAMP_WIDTH        from 0 to 1: m is between the straight edge
    weight twice   (metric - 1) / RAMP_WIDTH  and its full place; the same for the quarters

*Triangles.* Where two edges of a triangle are split, a quadrangle remains, which has two diagonals.
If one split is taken back, only the diagonal from the point of the other split may remain. This
holds for either split, so the diagonal must flip in between, and the surface jumps. A point C in
the middle needs no diagonal:

              2             one edge     C = 2/3 m + 1/3 corner 2: on the line m-2, which is there
             /|\                         without C, so that nothing moves when it appears;
            / | \           two edges    C = 1/2 m + 1/2 m': on the line between them. Along a fold
           /  |  \                       this line is the surface; lines from C to the corners
          /   C...m'                     would be gutters, as between the scales of a fish;
         / .  |  . \        three edges  C = sum of 1/3 corner + 4/9 displacement: middle of a cubic
        0-----m-----1                    patch (the sixth part of its six inner points; Vlachos et
                                         al. 2001, "Curved PN triangles", give the same).

Here m is the middle of a split edge, and its displacement is the vector from the edge to m. Let g1
>= g2 >= g3 be the geomorph weights of the edges. C is a weighted mean of four points, with these
weights:

    1 - g1    the centre of the triangle, plus 2/3 of the displacements of all edges
    g1 - g2   the rule for one edge
    g2 - g3   the rule for two edges
    g3        the rule for three edges

A triangle with two or more splits needs one more point and two more subtriangles than in the paper.

So blending replaces the paper's table: a triangle with more than one split is a fan around C. A new
split then cuts one triangle of the fan and never flips a diagonal. The paper's patterns must flip
one: between 110 and 010, for example, the diagonal from corner 2 becomes the diagonal from corner
0, and their quadrangle is not flat.

Differs from the paper: "We don't generate any new vertices in the interior" (section 3).
"""

import numpy as np

from ...geometry.arrays import Floats32, Integers64, Unsigned8, Unsigned16, Unsigned32
from ...geometry.vectors import (
    HALF,
    ONE,
    QUARTER,
    ROW_WIDTH,
    THIRD,
    ZERO,
    Vector,
    less,
    plus,
    row_of,
    times,
    unit,
    write_row,
)
from ...jit import njit
from ..border.rows import GEOMETRY_COLUMNS
from ..kahler.criterion import Criterion
from ..kahler.cutting import Cutting
from ..kahler.frame import CENTRES, ROWS, TRIANGLES, FrameBuffers
from ..kahler.scheme import Scheme
from ..kahler.smoothing import geomorph_of_split
from ..kahler.table import (
    CENTRE_POINT,
    CONFIGURATION_COUNT,
    Triangle,
    outline,
    splits_of,
    subdivide,
    table_of,
)
from ..mesh.connectivity import Connectivity
from ..mesh.threads import parallel_for

RAMP_WIDTH = np.float32(0.25)
"""Range of the metric over which a point moves from the straight edge to its final position; 1 is
the difference of the two thresholds. Chosen short, because a half moved point costs as much as a
fully moved one.
"""
TWO_THIRDS = np.float32(2 / 3)
FOUR_NINTHS = np.float32(4 / 9)


def fan(splits: tuple[int, int, int]) -> list[Triangle]:
    """Cut a triangle into a fan around its centre; a single split is cut as in the paper."""
    if sum(splits) <= 1:
        return subdivide(splits)
    points = outline(splits)
    pairs = zip(points, points[1:] + points[:1], strict=True)
    return [(CENTRE_POINT, start, end) for start, end in pairs]


FAN_TABLE = table_of(
    [fan(splits_of(configuration)) for configuration in range(CONFIGURATION_COUNT)]
)
"""The patterns of blended frames."""


class Blended(Cutting):
    """The cutting of blended frames: points leave their edges gradually, triangles are fans."""

    patterns = FAN_TABLE
    has_centres = True

    def bind(self, connectivity: Connectivity, frame: FrameBuffers) -> Unsigned16:
        """Take the mesh; return the configuration of each triangle, shape (F + 1,)."""
        self._mesh = connectivity
        self._metric = np.zeros(len(connectivity.edges), dtype=np.float32)
        return frame.configurations

    def mark(self, criterion: Criterion, frame: FrameBuffers, splits: Unsigned8) -> None:
        """Write the geomorph weights of every edge, and the splits that follow from them."""
        metric = self._metric
        criterion.measure(frame.positions, frame.normals, metric)
        if weigh_geomorphs(metric, splits, frame.geomorph_once, frame.geomorph_twice) > 0:
            culprit = criterion.find_complaint(frame.positions, frame.normals, len(metric))
            raise ValueError(culprit or criterion.complaint(metric))

    def number(
        self, frame: FrameBuffers, vertex_count: int, triangle_count: int
    ) -> tuple[int, int]:
        """Number the centres of triangles after all others."""
        counts = frame.counts
        number_centres(frame.configurations, *self.patterns, frame.centre_triangles, counts)
        return vertex_count + int(counts[CENTRES]), int(counts[TRIANGLES])

    def place(self, scheme: Scheme, frame: FrameBuffers) -> None:
        """Write the centres of triangles; then let the scheme correct them."""
        parallel_for(place_centres, frame.centre_count, self._mesh, frame)
        scheme.place_centres(frame)


@njit
def weigh_geomorphs(
    metric: Floats32, splits: Unsigned8, geomorph_once: Floats32, geomorph_twice: Floats32
) -> int:
    """Write splits and geomorph weights of every edge from its metric, all of (E,); count NaN."""
    undefined = 0
    for e in range(metric.shape[0]):
        splits[e] = np.uint8(metric[e] > ZERO) + np.uint8(metric[e] > ONE)
        geomorph_once[e] = min(max(metric[e] / RAMP_WIDTH, ZERO), ONE)
        geomorph_twice[e] = min(max((metric[e] - ONE) / RAMP_WIDTH, ZERO), ONE)
        undefined += metric[e] != metric[e]
    return undefined


@njit
def number_centres(
    configurations: Unsigned16,
    subtriangle_counts: Unsigned8,
    subtriangles: Unsigned8,
    centre_triangles: Unsigned32,
    counts: Integers64,
) -> None:
    """List the triangles that have a centre; count them, and all subtriangles.

    The arguments are arrays of `FrameBuffers`, and the two arrays of `Patterns`.
    """
    centre_count = triangle_count = 0
    for t in range(configurations.shape[0] - 1):
        row = configurations[t]
        centre_triangles[centre_count] = t
        centre_count += subtriangles[row, 0, 0] == CENTRE_POINT
        triangle_count += int(subtriangle_counts[row])
    counts[TRIANGLES] = triangle_count
    counts[CENTRES] = centre_count


@njit
def rule_weights(
    own: np.float32, other: np.float32, third: np.float32
) -> tuple[np.float32, np.float32]:
    """Return the weights of the rules for one and for two edges, for the edge `own`."""
    rival = max(other, third)
    return max(own - rival, ZERO), min(own, rival) - min(own, other, third)


@njit
def centre_shares(x: np.float32, y: np.float32, z: np.float32) -> tuple[Vector, Vector]:
    """Return the weights of corners, and of edge displacements, for the middle of a triangle.

    `x`, `y`, `z`: geomorph weights of the edges; they determine the weights of the three rules
    above.
    """
    all_three = min(x, y, z)
    none = ONE - max(x, y, z)
    one_x, pair_x = rule_weights(x, y, z)
    one_y, pair_y = rule_weights(y, z, x)
    one_z, pair_z = rule_weights(z, x, y)
    of_edges = (
        TWO_THIRDS * (none + one_x) + HALF * pair_x + FOUR_NINTHS * all_three,
        TWO_THIRDS * (none + one_y) + HALF * pair_y + FOUR_NINTHS * all_three,
        TWO_THIRDS * (none + one_z) + HALF * pair_z + FOUR_NINTHS * all_three,
    )
    thirds = THIRD * (none + one_x + one_y + one_z + all_three)
    of_corners = (
        thirds + QUARTER * (pair_z + pair_x),
        thirds + QUARTER * (pair_x + pair_y),
        thirds + QUARTER * (pair_y + pair_z),
    )
    return of_corners, of_edges


@njit
def displaced(
    rows: Floats32,
    centre: Vector,
    share_of_edge: np.float32,
    ends: tuple[np.uint32, np.uint32],
    middle: np.uint32,
    column: int,
) -> Vector:
    """Move a point by a fraction of the vector from the mean of two rows to the row `middle`."""
    straight = plus(row_of(rows, ends[0], column), row_of(rows, ends[1], column))
    out = less(row_of(rows, middle, column), HALF, straight)
    return plus(centre, times(share_of_edge, out))


@njit
def place_centres(first: int, last: int, mesh: Connectivity, frame: FrameBuffers) -> None:
    """Write the rows of the centres of triangles, attributes too."""
    rows = frame.rows
    splits = frame.splits
    first_points = frame.first_points
    once = frame.geomorph_once
    first_row = frame.counts[ROWS]
    faces = mesh.faces
    triangle_edges = mesh.triangle_edges
    centre_weights = frame.centre_weights
    assert faces.shape[1] == triangle_edges.shape[1] == centre_weights.shape[1] == ROW_WIDTH
    for k in range(first, last):
        t = frame.centre_triangles[k]
        row = np.uint32(first_row + k)
        a = faces[t, 0]
        b = faces[t, 1]
        c = faces[t, 2]
        ab = np.uint32(triangle_edges[t, 0])
        bc = np.uint32(triangle_edges[t, 1])
        ca = np.uint32(triangle_edges[t, 2])
        of_corners, of_edges = centre_shares(
            geomorph_of_split(splits, once, ab),
            geomorph_of_split(splits, once, bc),
            geomorph_of_split(splits, once, ca),
        )
        of_a, of_b, of_c = of_corners
        write_row(centre_weights, np.uint32(k), of_corners)
        for column in (0, 3):  # position, normal
            at_a = times(of_a, row_of(rows, a, column))
            at_b = times(of_b, row_of(rows, b, column))
            centre = plus(plus(at_a, at_b), times(of_c, row_of(rows, c, column)))
            if splits[ab] > 0:
                middle = np.uint32(first_points[ab] + (splits[ab] >> 1))
                centre = displaced(rows, centre, of_edges[0], (a, b), middle, column)
            if splits[bc] > 0:
                middle = np.uint32(first_points[bc] + (splits[bc] >> 1))
                centre = displaced(rows, centre, of_edges[1], (b, c), middle, column)
            if splits[ca] > 0:
                middle = np.uint32(first_points[ca] + (splits[ca] >> 1))
                centre = displaced(rows, centre, of_edges[2], (c, a), middle, column)
            write_row(rows, row, centre if column == 0 else unit(centre), column)
        a = mesh.corners[t, 0]
        b = mesh.corners[t, 1]
        c = mesh.corners[t, 2]
        for i in range(GEOMETRY_COLUMNS, rows.shape[1]):
            rows[row, i] = of_a * rows[a, i] + of_b * rows[b, i] + of_c * rows[c, i]
