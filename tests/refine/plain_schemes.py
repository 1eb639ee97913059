"""The interpolating schemes once more, in plain Python, from the text of their papers.

Each is a function from an edge (low, high) and a number of quarters to a point, in `CurveRules`.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from tests.refine.plain_twin import (
    AtPoints,
    EdgeName,
    Growth,
    Placed,
    Surroundings,
    Vector,
    edge_name,
    mix,
    unit,
)

Curve = Callable[[EdgeName, int], Vector]
Face = tuple[int, int, int]


def dot(u: Vector, v: Vector) -> float:
    """Inner product."""
    return sum(x * y for x, y in zip(u, v, strict=True))


def cross(u: Vector, v: Vector) -> Vector:
    """Outer product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def length(v: Vector) -> float:
    """Length of a vector."""
    return math.sqrt(dot(v, v))


@dataclass
class CurveRules:
    """A scheme whose vertices stay and whose split edges go to curves as far as they have grown."""

    positions: list[Vector]
    faces: list[Face]
    curve: Curve
    normals: list[Vector]
    middle: Callable[[Face, list[Vector]], Vector] | None = None
    """What is added to the middle of a triangle, from the bulges of its edges."""
    centre_fullness: float = 1.0
    bulges: dict[EdgeName, Vector] = field(default_factory=dict)

    def placed(self, count: Counter[EdgeName], grown: Growth) -> Placed:
        """Points on the curves; normals between those at both ends."""
        points: AtPoints = {}
        normals: AtPoints = {}
        for (a, b), (once, twice) in grown.items():
            straight = mix((0.5, self.positions[a]), (0.5, self.positions[b]))
            m = mix((1 - once, straight), (once, self.curve((a, b), 2)))
            points[a, b] = {2: m}
            self.bulges[a, b] = mix((1, m), (-1, straight))
            for quarters, end in ((1, a), (3, b)):
                chord = mix((0.5, self.positions[end]), (0.5, m))
                full = self.curve((a, b), quarters)
                points[a, b][quarters] = mix((1 - twice, chord), (twice, full))
            middle = unit(mix((1, self.normals[a]), (1, self.normals[b])))
            ends = {1: self.normals[a], 2: middle, 3: self.normals[b]}
            normals[a, b] = {q: unit(mix((1, n), (1, middle))) for q, n in ends.items()}
        return Placed(self.positions, points, self.normals, normals)

    def centre(
        self, source: int, point: Vector, normal: Vector, grown: tuple[float, float]
    ) -> tuple[Vector, Vector]:
        """Fuller than the edges say, and to where the triangles around have it."""
        if self.middle is None or grown[0] == 0:
            return point, normal
        face = self.faces[source]
        flat = mix(*((1 / 3, self.positions[v]) for v in face))
        share = (self.centre_fullness - 1) * grown[0]
        bulges = [self.bulges[edge_name(face[i], face[(i + 1) % 3])] for i in range(3)]
        added = self.middle(face, bulges)
        return mix((1 + share, point), (-share, flat), (grown[0], added)), normal


def cubic_normals(rest: list[Vector], positions: list[Vector], faces: list[Face]) -> list[Vector]:
    """Normals weighted by the geometric mean of angle and area at rest."""
    sums: list[Vector] = [(0.0, 0.0, 0.0)] * len(positions)
    for face in faces:
        for i in range(3):
            a, b, c = face[i], face[(i + 1) % 3], face[(i + 2) % 3]
            u, v = (mix((1, rest[k]), (-1, rest[a])) for k in (b, c))
            area = length(cross(u, v))
            if area > 1e-9 * length(u) * length(v):
                now = [mix((1, positions[k]), (-1, positions[a])) for k in (b, c)]
                weight = math.sqrt(math.atan2(area, dot(u, v)) / area)
                sums[a] = mix((1, sums[a]), (weight, cross(*now)))
    return [unit(total) for total in sums]


def steepened(normals: list[Vector], edges: set[EdgeName]) -> list[Vector]:
    """Normals less 0.15 of the mean of those beside them."""
    beside: list[list[Vector]] = [[] for _ in normals]
    for a, b in edges:
        beside[a].append(normals[b])
        beside[b].append(normals[a])
    return [
        unit(mix((1, normal), *((-0.15 / len(others), other) for other in others)))
        for normal, others in zip(normals, beside, strict=True)
    ]


def is_corner(before: Vector, here: Vector, after: Vector) -> bool:
    """Whether a border turns by more than 60 degrees."""
    u, v = mix((1, here), (-1, before)), mix((1, after), (-1, here))
    return dot(u, v) < (0.5 - 1e-9) * length(u) * length(v)


def cubic(rest: list[Vector], positions: list[Vector], faces: list[Face]) -> CurveRules:
    """Cubic edges, 1.2 times as full; borders end at corners."""
    around, normals = Surroundings(faces), cubic_normals(rest, positions, faces)
    steeper = steepened(normals, set(around.opposite))

    def tangents(a: int, b: int) -> tuple[Vector, Vector]:
        d = mix((1, positions[b]), (-1, positions[a]))
        if (a, b) in around.inner:
            along = [mix((1, d), (-1.2 * dot(d, steeper[v]), steeper[v])) for v in (a, b)]
            return along[0], along[1]
        ends = []
        for here, there in ((a, b), (b, a)):
            ring = around.border_ring[here]
            if len(ring) != 2 or is_corner(*(rest[v] for v in (ring[0], here, ring[1]))):
                ends.append(d)
                continue
            other = ring[0] if ring[1] == there else ring[1]
            chord = mix((1, positions[there]), (-1, positions[other]))
            before = length(mix((1, positions[here]), (-1, positions[other])))
            share = length(d) / (length(d) + before)
            ends.append(mix((share if here == a else -share, chord)))
        return ends[0], ends[1]

    def curve(edge: EdgeName, quarters: int) -> Vector:
        t, (at_a, at_b) = quarters / 4, tangents(*edge)
        hermite = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, t**3 - t**2, 3 * t**2 - 2 * t**3)
        a, b = positions[edge[0]], positions[edge[1]]
        return mix(*zip(hermite, (a, at_a, at_b, b), strict=True))

    return CurveRules(positions, faces, curve, normals, cubic_middle(rest, positions, around), 1.15)


def cubic_middle(
    rest: list[Vector], positions: list[Vector], around: Surroundings
) -> Callable[[Face, list[Vector]], Vector]:
    """Higher where the corners across the edges lie deeper than the edges' bulges let expect."""

    def doubled(face: Face) -> float:
        ab, bc, ca = (mix((1, rest[face[i]]), (-1, rest[face[i - 1]])) for i in (1, 2, 0))
        area = length(cross(ab, bc))
        return area if area > 1e-9 * (dot(ab, ab) + dot(bc, bc) + dot(ca, ca)) else 0.0

    def middle(face: Face, bulges: list[Vector]) -> Vector:
        deeper: list[tuple[float, Vector]] = [(0.0, (0.0, 0.0, 0.0))]
        expected = [0.0, 0.0, 0.0]
        for i in range(3):
            a, b, c = face[i], face[(i + 1) % 3], face[(i + 2) % 3]
            if edge_name(a, b) not in around.inner:
                continue
            beyond = list(around.opposite[edge_name(a, b)])
            beyond.remove(c)
            across = beyond[0]
            own, other = doubled(face), doubled((b, a, across))
            if own == 0 or other == 0:
                continue
            share = own / (own + other)
            deeper.append((share / 9, mix((1, positions[a]), (-1, positions[across]))))
            # Unfolded: a at 0, b at 1, heights over ab as parts of that of c.
            ab = mix((1, rest[b]), (-1, rest[a]))
            c_along, along = (
                dot(mix((1, rest[v]), (-1, rest[a])), ab) / dot(ab, ab) for v in (c, across)
            )
            of_c = -other / own
            of_b = along - of_c * c_along
            of_a = 1 - of_b - of_c
            products = of_a * of_b, of_b * of_c, of_c * of_a
            for k in range(3):  # a parabola that is 1 in the middle of an edge is 4 x there
                expected[(i + k) % 3] += -4 * products[k] * share / 9
        a, b, c = (positions[v] for v in face)
        sides = [mix((1, b), (-1, a)), mix((1, c), (-1, b)), mix((1, a), (-1, c))]
        up = cross(sides[0], sides[1])
        surprise = mix(*deeper, *((-x / 1.2, y) for x, y in zip(expected, bulges, strict=True)))
        gain = 0.6 * 1.15 * 1.2 * min(1.0, 2.0 / max(sum(map(abs, expected)), 1e-9))
        flattened = 1e-3 * sum(dot(side, side) for side in sides) ** 2
        area = dot(up, up) + flattened
        return mix((gain * dot(surprise, up) / max(area, 1e-38), up))

    return middle
