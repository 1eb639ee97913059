"""The interpolating schemes again, in plain Python, from the text of their papers.

Each scheme is a function from an edge (low, high) and a number of quarters to a point, in
`CurveRules`.
"""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from tests.refine.plain_twin import (
    AtPoints,
    EdgeName,
    GeomorphWeights,
    Placed,
    Rules,
    Surroundings,
    Vector,
    cross,
    mix,
    normals_along,
    unit,
)

Curve = Callable[[EdgeName, int], Vector]
Face = tuple[int, int, int]


def dot(u: Vector, v: Vector) -> float:
    """Inner product of two vectors."""
    return sum(x * y for x, y in zip(u, v, strict=True))


def length(v: Vector) -> float:
    """Length of a vector."""
    return math.sqrt(dot(v, v))


@dataclass
class CurveRules(Rules):
    """A scheme with fixed vertices; points of split edges lie between chord and curve.

    Geomorph weights are the weights of the curve.
    """

    positions: list[Vector]
    faces: list[Face]
    curve: Curve
    normals: list[Vector]

    def placed(self, count: Counter[EdgeName], grown: GeomorphWeights) -> Placed:
        """Points of split edges, and normals interpolated between both ends."""
        points: AtPoints = {}
        normals: AtPoints = {}
        for (a, b), (once, twice) in grown.items():
            straight = mix((0.5, self.positions[a]), (0.5, self.positions[b]))
            m = mix((1 - once, straight), (once, self.curve((a, b), 2)))
            points[a, b] = {2: m}
            for quarters, end in ((1, a), (3, b)):
                chord = mix((0.5, self.positions[end]), (0.5, m))
                full = self.curve((a, b), quarters)
                points[a, b][quarters] = mix((1 - twice, chord), (twice, full))
            middle = unit(mix((1, self.normals[a]), (1, self.normals[b])))
            normals[a, b] = normals_along(self.normals[a], middle, self.normals[b])
        return Placed(self.positions, points, self.normals, normals)


def cubic_normals(rest: list[Vector], positions: list[Vector], faces: list[Face]) -> list[Vector]:
    """Normals weighted by the geometric mean of angle and area at rest."""
    sums: list[Vector] = [(0.0, 0.0, 0.0)] * len(positions)
    for face in faces:
        for i in range(3):
            a = face[i]
            b = face[(i + 1) % 3]
            c = face[(i + 2) % 3]
            u, v = (mix((1, rest[k]), (-1, rest[a])) for k in (b, c))
            area = length(cross(u, v))
            if area > 1e-9 * length(u) * length(v):
                now = [mix((1, positions[k]), (-1, positions[a])) for k in (b, c)]
                weight = math.sqrt(math.atan2(area, dot(u, v)) / area)
                sums[a] = mix((1, sums[a]), (weight, cross(*now)))
    return [unit(total) for total in sums]


def steepened(normals: list[Vector], edges: set[EdgeName]) -> list[Vector]:
    """Normals minus 0.15 times the mean of neighbouring normals."""
    beside: list[list[Vector]] = [[] for _ in normals]
    for a, b in edges:
        beside[a].append(normals[b])
        beside[b].append(normals[a])
    steep = []
    for normal, others in zip(normals, beside, strict=True):
        subtracted = [(-0.15 / len(others), other) for other in others]
        steep.append(unit(mix((1, normal), *subtracted)))
    return steep


def is_corner(before: Vector, here: Vector, after: Vector) -> bool:
    """Whether a border turns by more than 60 degrees at a vertex."""
    u = mix((1, here), (-1, before))
    v = mix((1, after), (-1, here))
    return dot(u, v) < (0.5 - 1e-9) * length(u) * length(v)


def cubic(rest: list[Vector], positions: list[Vector], faces: list[Face]) -> CurveRules:
    """Cubic edges that bulge 1.2 times as far; a border's curve ends at its corners."""
    around = Surroundings(faces)
    normals = cubic_normals(rest, positions, faces)
    steeper = steepened(normals, set(around.opposite))

    def tangents(a: int, b: int) -> tuple[Vector, Vector]:
        d = mix((1, positions[b]), (-1, positions[a]))
        if (a, b) in around.inner:
            at_a = mix((1, d), (-1.2 * dot(d, steeper[a]), steeper[a]))
            at_b = mix((1, d), (-1.2 * dot(d, steeper[b]), steeper[b]))
            return at_a, at_b
        ends: list[Vector | None] = []
        for here, there in ((a, b), (b, a)):
            ring = around.border_ring[here]
            if len(ring) != 2 or is_corner(rest[ring[0]], rest[here], rest[ring[1]]):
                ends.append(None)
                continue
            other = ring[0] if ring[1] == there else ring[1]
            chord = mix((1, positions[there]), (-1, positions[other]))
            before = length(mix((1, positions[here]), (-1, positions[other])))
            share = length(d) / (length(d) + before)
            ends.append(mix((share if here == a else -share, chord)))
        first, last = ends
        # Beside a corner the curve is a parabola, whose middle has the direction of the chord.
        from_first = mix((2, d), (-1, first)) if first else d
        from_last = mix((2, d), (-1, last)) if last else d
        return first or from_last, last or from_first

    def curve(edge: EdgeName, quarters: int) -> Vector:
        a, b = edge
        at_a, at_b = tangents(a, b)
        t = quarters / 4
        return mix(
            (2 * t**3 - 3 * t**2 + 1, positions[a]),
            (t**3 - 2 * t**2 + t, at_a),
            (t**3 - t**2, at_b),
            (3 * t**2 - 2 * t**3, positions[b]),
        )

    return CurveRules(positions, faces, curve, normals)
