"""The interpolating schemes once more, in plain Python, from the text of their papers.

Each returns a function from an edge (low, high) and a number of quarters to a point.
"""

from __future__ import annotations

import math
from collections import defaultdict

from tests.refine.plain_twin import (
    Curve,
    EdgeName,
    Surroundings,
    Vector,
    edge_name,
    is_proper,
    mix,
    unit,
)

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


def cubic(rest: list[Vector], positions: list[Vector], faces: list[Face]) -> Curve:
    """Cubic edges with normals weighted by the angles at rest, 1.15 times as full."""
    around = Surroundings(faces)
    sums: list[Vector] = [(0.0, 0.0, 0.0)] * len(positions)
    for face in faces:
        for i in range(3):
            a, b, c = face[i], face[(i + 1) % 3], face[(i + 2) % 3]
            u, v = (mix((1, rest[k]), (-1, rest[a])) for k in (b, c))
            area = length(cross(u, v))
            if area > 1e-9 * length(u) * length(v):
                now = [mix((1, positions[k]), (-1, positions[a])) for k in (b, c)]
                weight = math.atan2(area, dot(u, v)) / area
                sums[a] = mix((1, sums[a]), (weight, cross(*now)))
    normals = [unit(total) for total in sums]

    def tangents(a: int, b: int) -> tuple[Vector, Vector]:
        d = mix((1, positions[b]), (-1, positions[a]))
        if (a, b) in around.inner:
            along = [mix((1, d), (-1.15 * dot(d, normals[v]), normals[v])) for v in (a, b)]
            return along[0], along[1]
        ends = []
        for here, there in ((a, b), (b, a)):
            ring = around.border_ring[here]
            if len(ring) != 2:
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

    return curve


def butterfly(positions: list[Vector], faces: list[Face]) -> Curve:
    """Modified butterfly subdivision, two levels."""
    around = Surroundings(faces)
    following: dict[int, dict[int, int]] = defaultdict(dict)
    for face in filter(is_proper, faces):
        for i in range(3):
            following[face[i]][face[(i + 1) % 3]] = face[(i + 2) % 3]

    def ring(v: int, start: int) -> list[int]:
        """Neighbours in order, or nothing where they are not one ring of inner edges."""
        neighbours = set(around.ring[v])
        if around.border_ring[v] or not 3 <= len(neighbours) <= 64:
            return []
        found = [start]
        while (after := following[v][found[-1]]) != start:
            found.append(after)
        return found if len(found) == len(neighbours) else []

    def weights(n: int) -> list[float]:
        if n == 3:
            return [5 / 12, -1 / 12, -1 / 12]
        if n == 4:
            return [3 / 8, 0, -1 / 8, 0]
        if n == 6:
            return [1 / 2, 1 / 8, -1 / 8, 0, -1 / 8, 1 / 8]
        turns = [2 * math.pi * j / n for j in range(n)]
        return [(0.25 + math.cos(t) + 0.5 * math.cos(2 * t)) / n for t in turns]

    def from_ring(centre: Vector, points: list[Vector]) -> Vector:
        parts = weights(len(points))
        return mix((1 - sum(parts), centre), *zip(parts, points, strict=True))

    def middle(a: int, b: int) -> Vector:
        straight = mix((0.5, positions[a]), (0.5, positions[b]))
        if edge_name(a, b) not in around.inner:
            rings = [around.border_ring[v] for v in (a, b)]
            if any(len(r) != 2 for r in rings):
                return straight
            p, q = (next(v for v in r if v not in (a, b)) for r in rings)
            others = mix((1, positions[p]), (1, positions[q]))
            return mix((9 / 8, straight), (-1 / 16, others))
        rings = {v: ring(v, u) for v, u in ((a, b), (b, a))}
        rings = {v: r for v, r in rings.items() if r}
        if len({len(r) == 6 for r in rings.values()}) == 2:
            rings = {v: r for v, r in rings.items() if len(r) != 6}
        if not rings:
            return straight
        found = [from_ring(positions[v], [positions[u] for u in r]) for v, r in rings.items()]
        return mix(*((1 / len(found), point) for point in found))

    def curve(edge: EdgeName, quarters: int) -> Vector:
        m = middle(*edge)
        if quarters == 2:
            return m
        near, far = edge if quarters == 1 else edge[::-1]
        if edge not in around.inner:
            return mix((3 / 8, positions[near]), (3 / 4, m), (-1 / 8, positions[far]))
        c, d = around.opposite[edge]
        p, r, q, s = (middle(u, v) for u in (near, far) for v in (c, d))
        from_middle = from_ring(m, [positions[near], p, q, positions[far], s, r])
        around_near = ring(near, far)
        if not around_near:
            return from_middle
        from_near = from_ring(positions[near], [middle(near, u) for u in around_near])
        return mix((0.5, from_near), (0.5, from_middle)) if len(around_near) == 6 else from_near

    return curve
