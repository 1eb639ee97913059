"""The whole algorithm once more, in plain Python over dictionaries, from the text of the paper.

A second implementation that shares no line, no array and no table with the first: section 4.1 for
the criterion, 4.2 with Figs. 3 and 4 for the positions, 4.3 for the triangles. Points have names
instead of numbers, so nothing depends on an order:
    ("vertex", v)  or  ("edge", low, high, quarters from low)
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass, field

Vector = tuple[float, float, float]
Name = tuple[str | int, ...]
EdgeName = tuple[int, int]

# The patterns of the eleven kinds of configurations, drawn by hand: corners 0 1 2; on edge i the
# middle mi, the quarter point ai near its start and bi near its end.
PATTERNS = {
    (0, 0, 0): "0 1 2",
    (1, 0, 0): "2 0 m0, m0 1 2",
    (2, 0, 0): "2 0 a0, 2 a0 m0, 2 m0 b0, b0 1 2",
    (1, 1, 0): "m0 1 m1, 2 0 m0, m0 m1 2",
    (2, 1, 0): "b0 1 m1, m0 b0 m1, a0 m0 m1, 0 a0 m1, 0 m1 2",
    (2, 0, 1): "m2 0 a0, m2 a0 m0, m2 m0 b0, 1 2 m2, b0 1 m2",
    (2, 2, 0): "b0 1 a1, b0 a1 m1, m0 b0 m1, a0 m0 m1, a0 m1 b1, 2 0 a0, a0 b1 2",
    (1, 1, 1): "m2 0 m0, m0 1 m1, m1 2 m2, m0 m1 m2",
    (2, 1, 1): "m2 0 a0, m2 a0 m0, b0 1 m1, m0 b0 m1, m1 2 m2, m0 m1 m2",
    (2, 2, 1): "m2 0 a0, m2 a0 m0, b0 1 a1, b0 a1 m1, m0 b0 m1, b1 2 m2, m1 b1 m2, m0 m1 m2",
    (2, 2, 2): (
        "b2 0 a0, b2 a0 m0, m0 m2 b2, b0 1 a1, b0 a1 m1, m1 m0 b0, "
        "b1 2 a2, b1 a2 m2, m2 m1 b1, m0 m1 m2"
    ),
}


@dataclass
class Twin:
    """A refined mesh in terms of point names."""

    positions: dict[Name, Vector] = field(default_factory=dict)
    normals: dict[Name, Vector] = field(default_factory=dict)
    triangles: list[tuple[int, tuple[Name, Name, Name]]] = field(default_factory=list)
    """(source, corners with the alphabetically first one in front)."""


def mix(*terms: tuple[float, Vector]) -> Vector:
    """Weighted sum of vectors."""
    x, y, z = (sum(weight * vector[i] for weight, vector in terms) for i in range(3))
    return x, y, z


def unit(vector: Vector) -> Vector:
    """Vector of length one, or zero."""
    length = math.sqrt(sum(x * x for x in vector))
    return mix((1.0 / length, vector)) if length > 1e-15 else (0.0, 0.0, 0.0)


def edge_name(a: int, b: int) -> EdgeName:
    """The same name from both sides."""
    return (a, b) if a < b else (b, a)


def is_proper(face: tuple[int, int, int]) -> bool:
    """Whether a triangle has three different corners."""
    return len(set(face)) == 3


def vertex_normals(positions: list[Vector], faces: list[tuple[int, int, int]]) -> list[Vector]:
    """Area-weighted normals: cross products have twice the area as their length."""
    sums: list[Vector] = [(0.0, 0.0, 0.0)] * len(positions)
    for face in faces:
        a, b, c = (positions[v] for v in face)
        u, v = mix((1, b), (-1, a)), mix((1, c), (-1, a))
        cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        for vertex in face:
            sums[vertex] = mix((1, sums[vertex]), (1, cross))
    return [unit(total) for total in sums]


def edge_dots(positions: list[Vector], faces: list[tuple[int, int, int]]) -> dict[EdgeName, float]:
    """Dot product of the vertex normals at the ends of each edge (section 4.1)."""
    normals = vertex_normals(positions, faces)
    names = {edge_name(f[i], f[(i + 1) % 3]) for f in faces if is_proper(f) for i in range(3)}
    return {
        (a, b): sum(x * y for x, y in zip(normals[a], normals[b], strict=True)) for a, b in names
    }


class Surroundings:
    """What lies around each edge and vertex."""

    def __init__(self, faces: list[tuple[int, int, int]]) -> None:
        runs: dict[EdgeName, list[bool]] = defaultdict(list)
        self.opposite: dict[EdgeName, list[int]] = defaultdict(list)
        for face in filter(is_proper, faces):
            for i in range(3):
                a, b, c = face[i], face[(i + 1) % 3], face[(i + 2) % 3]
                runs[edge_name(a, b)].append(a < b)
                self.opposite[edge_name(a, b)].append(c)
        self.inner = {edge for edge, run in runs.items() if sorted(run) == [False, True]}
        self.ring: dict[int, list[int]] = defaultdict(list)
        self.border_ring: dict[int, list[int]] = defaultdict(list)
        for a, b in runs:
            for vertex, other in ((a, b), (b, a)):
                self.ring[vertex].append(other)
                if (a, b) not in self.inner:
                    self.border_ring[vertex].append(other)


def moved_vertex(v: int, positions: list[Vector], around: Surroundings) -> Vector:
    """Fig. 3, right."""
    ring, border = around.ring[v], around.border_ring[v]
    if len(border) == 2:
        return mix((0.75, positions[v]), *((0.125, positions[u]) for u in border))
    if border or not ring:
        return positions[v]
    beta = 3 / 16 if len(ring) == 3 else 3 / (8 * len(ring))
    return mix((1 - len(ring) * beta, positions[v]), *((beta, positions[u]) for u in ring))


def first_level_point(edge: EdgeName, positions: list[Vector], around: Surroundings) -> Vector:
    """Fig. 3, left."""
    a, b = (positions[v] for v in edge)
    if edge not in around.inner:
        return mix((0.5, a), (0.5, b))
    c, d = (positions[v] for v in around.opposite[edge])
    return mix((3 / 8, a), (3 / 8, b), (1 / 8, c), (1 / 8, d))


def refine(
    positions: list[Vector], faces: list[tuple[int, int, int]], splits: dict[EdgeName, int]
) -> Twin:
    """Split each edge as often as `splits` says, 0 where it says nothing."""
    around, twin = Surroundings(faces), Twin()
    count = Counter(splits)
    touched = {v for edge, number in count.items() if number for v in edge}
    normals = vertex_normals(positions, faces)
    moved = [
        moved_vertex(v, positions, around) if v in touched else positions[v]
        for v in range(len(positions))
    ]
    for v in range(len(positions)):
        twin.positions["vertex", v], twin.normals["vertex", v] = moved[v], normals[v]

    first = {e: first_level_point(e, positions, around) for e, number in count.items() if number}

    def first_or_middle(u: int, v: int) -> Vector:
        middle = mix((0.5, positions[u]), (0.5, positions[v]))
        return first.get(edge_name(u, v), middle)

    for edge, m in first.items():
        a, b = edge
        name = ("edge", a, b)
        place = {1: [(2, m)], 2: []}[count[edge]]
        if count[edge] == 2 and edge in around.inner:
            c, d = around.opposite[edge]
            beside_a = [first_or_middle(a, c), first_or_middle(a, d)]
            beside_b = [first_or_middle(b, c), first_or_middle(b, d)]
            near_a = mix((3 / 8, moved[a]), (3 / 8, m), *((1 / 8, p) for p in beside_a))
            near_b = mix((3 / 8, moved[b]), (3 / 8, m), *((1 / 8, p) for p in beside_b))
            ring = [moved[a], moved[b], *beside_a, *beside_b]
            centre = mix((5 / 8, m), *((1 / 16, p) for p in ring))
            place = [(1, near_a), (2, centre), (3, near_b)]
        elif count[edge] == 2:
            centre = mix((3 / 4, m), (1 / 8, moved[a]), (1 / 8, moved[b]))
            place = [
                (1, mix((0.5, moved[a]), (0.5, m))),
                (2, centre),
                (3, mix((0.5, moved[b]), (0.5, m))),
            ]
        between = unit(mix((1, normals[a]), (1, normals[b])))
        for quarters, point in place:
            beside = {1: normals[a], 2: between, 3: normals[b]}[quarters]
            twin.positions[*name, quarters] = point
            twin.normals[*name, quarters] = unit(mix((1, beside), (1, between)))

    for source, face in enumerate(faces):
        twin.triangles += [(source, corners) for corners in _subtriangles(face, count)]
    return twin


def starting_at_least(corners: list[Name]) -> tuple[Name, Name, Name]:
    """Turn a triangle so that equal triangles compare equal."""
    k = min(range(3), key=lambda i: [str(part) for part in corners[i]])
    return corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]


def _subtriangles(
    face: tuple[int, int, int], count: Counter[EdgeName]
) -> list[tuple[Name, Name, Name]]:
    if not is_proper(face):
        return [starting_at_least([("vertex", v) for v in face])]
    turned = [face[k:] + face[:k] for k in range(3)]
    kinds = [tuple(count[edge_name(f[i], f[(i + 1) % 3])] for i in range(3)) for f in turned]
    k = next(k for k in range(3) if kinds[k] in PATTERNS)
    corner = turned[k]
    points: dict[str, Name] = {str(i): ("vertex", corner[i]) for i in range(3)}
    for i in range(3):
        start, end = corner[i], corner[(i + 1) % 3]
        low, high = edge_name(start, end)
        for letter, quarters in (("a", 1), ("m", 2), ("b", 3)):
            points[f"{letter}{i}"] = ("edge", low, high, quarters if start == low else 4 - quarters)
    pattern = PATTERNS[kinds[k]]
    return [
        starting_at_least([points[name] for name in part.split()]) for part in pattern.split(",")
    ]
