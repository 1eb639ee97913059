"""The scheme `detail` once more, in plain Python: what is seen at rest moves with the surface.

What the finer mesh adds is taken from the refiner itself, at rest and with everything split, once
and twice, by the names of its points; how it moves is worked out here. That it is like the finer
mesh is another test's business (test_detail.py).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from tests.refine.plain_schemes import CurveRules, Face, cross, cubic, dot
from tests.refine.plain_twin import (
    EdgeName,
    Growth,
    Name,
    Placed,
    Surroundings,
    Vector,
    edge_name,
    mix,
    unit,
)

T = TypeVar("T")
Axes = tuple[Vector, Vector, Vector]
Seen = dict[Name, tuple[Vector, Vector]]
"""Position and normal of every point."""


def axes_of(up: Vector, towards: Vector) -> Axes:
    """Three orthogonal directions: up, as far as possible towards, across."""
    up = unit(up)
    towards = unit(mix((1, towards), (-dot(towards, up), up)))
    return up, towards, cross(up, towards)


def ring(items: Sequence[T]) -> list[tuple[T, T]]:
    """Each of three and the next."""
    return [(items[i], items[(i + 1) % 3]) for i in range(3)]


def squared(vector: Vector) -> float:
    """Squared length."""
    x, y, z = vector
    return x * x + y * y + z * z


def carried(vector: Vector, rest: Axes, now: Axes) -> Vector:
    """The vector that lies along the axes now as it lay along those at rest."""
    return mix(*((dot(vector, before), after) for before, after in zip(rest, now, strict=True)))


@dataclass
class Form:
    """The mesh in one shape: its cubic edges, and the directions of all its points."""

    cubic: CurveRules
    towards: list[int]

    def upright(self, a: int, b: int) -> Vector:
        """The mean normal of an edge, made normal to it."""
        chord = mix((1, self.cubic.positions[b]), (-1, self.cubic.positions[a]))
        mean = mix((1, self.cubic.normals[a]), (1, self.cubic.normals[b]))
        return unit(mix((1, mean), (-dot(mean, chord) / dot(chord, chord), chord)))

    def shares(self, corners: Sequence[int]) -> list[float]:
        """Where the middle of a face lies: 0.6 of the way from its centroid to where it bends."""
        points, normals = self.cubic.positions, self.cubic.normals
        bends = []
        for a, b in ring(corners):
            chord = mix((1, points[b]), (-1, points[a]))
            turn_a, turn_b = dot(chord, normals[a]), dot(chord, normals[b])
            bulge = mix((turn_a, normals[a]), (-turn_b, normals[b]))
            bends.append(dot(bulge, bulge) + 0.02 * dot(chord, chord))
        total = sum(bends)
        return [0.4 / 3 + 0.6 * (bends[i] + bends[i - 1]) / (2 * total) for i in range(3)]

    def middle(self, face: Face, middles: dict[EdgeName, Vector], shares: list[float]) -> Vector:
        """The quadratic through corners and middles of edges, at some shares of the corners."""
        points = self.cubic.positions
        place = mix(*((share, points[v]) for v, share in zip(face, shares, strict=True)))
        for (a, b), (s, t) in zip(ring(face), ring(shares), strict=True):
            bulge = mix((1, middles[edge_name(a, b)]), (-0.5, points[a]), (-0.5, points[b]))
            place = mix((1, place), (4 * s * t, bulge))
        return place

    def axes(self, name: Name) -> Axes:
        """Directions of a vertex, of a point of an edge, or of the middle of a face (a, b, c)."""
        points, normals = self.cubic.positions, self.cubic.normals
        if name[0] == "vertex":
            v = int(name[1])
            return axes_of(normals[v], mix((1, points[self.towards[v]]), (-1, points[v])))
        if name[0] == "edge":
            _, a, b, quarters = (part if isinstance(part, int) else 0 for part in name)
            up = self.upright(a, b)
            if quarters != 2:
                up = mix((1, up), (1, normals[a if quarters == 1 else b]))
            return axes_of(up, mix((1, points[b]), (-1, points[a])))
        corners = [int(v) for v in name[1:]]
        shares = self.shares(corners)
        ups = [
            (4.0 * s * t, self.upright(a, b))
            for (a, b), (s, t) in zip(ring(corners), ring(shares), strict=True)
        ]
        own = [(s * (2.0 * s - 1.0), normals[v]) for v, s in zip(corners, shares, strict=True)]
        up = mix(*ups, *own)
        return axes_of(up, mix((1, points[corners[1]]), (-1, points[corners[0]])))


class DetailRules:
    """What was seen at rest, in a deformed mesh."""

    def __init__(
        self,
        rest: list[Vector],
        positions: list[Vector],
        faces: list[Face],
        edges: list[tuple[int, int]],
        seen: tuple[Seen, Seen],
    ) -> None:
        """`edges`: as the refiner has them; `seen`: at rest, blended, all split once, and twice."""
        towards = list(range(len(rest)))
        both_ways = [*edges, *((b, a) for a, b in edges)]
        for a, b in sorted(
            both_ways, key=lambda ab: squared(mix((1, rest[ab[1]]), (-1, rest[ab[0]])))
        ):
            towards[a] = b  # the longest edge comes last
        self.rest = Form(cubic(rest, rest, faces), towards)
        self.now = Form(cubic(rest, positions, faces), towards)
        self.faces, self.around = faces, Surroundings(faces)
        self.seen_once, self.seen = seen
        self.twice: dict[EdgeName, float] = {}
        self.middles: dict[EdgeName, Vector] = {}
        names: list[Name] = [("vertex", v) for v in range(len(rest))]
        self.shown = [self._look(name) for name in names]

    def _frames(self, name: Name) -> tuple[Axes, Axes]:
        return self.rest.axes(name), self.now.axes(name)

    def _look(self, name: Name, known_as: Name | None = None, twice: float = 1.0) -> Vector:
        known_as = known_as or name
        look = self.seen[known_as][1]
        if twice < 1.0:
            look = mix((1 - twice, self.seen_once[known_as][1]), (twice, look))
        return carried(look, *self._frames(name))

    def curve(self, edge: EdgeName, quarters: int) -> Vector:
        """The cubic, and what was missing in it at rest."""
        name: Name = ("edge", *edge, quarters)
        before = self.rest.cubic.curve(edge, quarters)
        known = self.seen[name][0]
        if quarters == 2:
            twice = self.twice[edge]
            known = mix((1 - twice, self.seen_once[name][0]), (twice, known))
        missing = mix((1, known), (-1, before))
        now = self.now.cubic.curve(edge, quarters)
        return mix((1, now), (1, carried(missing, *self._frames(name))))

    def placed(self, count: Counter[EdgeName], grown: Growth) -> Placed:
        """Points on these curves, and normals that turn to those seen as all around grows."""
        self.twice = {
            edge: twice if count[edge] == 2 else 0.0 for edge, (_, twice) in grown.items()
        }
        rules = CurveRules(self.now.cubic.positions, self.faces, self.curve, self.shown)
        place = rules.placed(count, grown)
        for (a, b), (once, twice) in grown.items():
            normals = place.point_normals[a, b]
            share = min(once, self._around(grown, a, b))
            look = self._look(("edge", a, b, 2), twice=self.twice[a, b])
            middle = turned(normals[2], look, share)
            normals[2] = middle
            self.middles[a, b] = place.points[a, b][2]
            for quarters, end in ((1, a), (3, b)):
                between = mix((0.5, self.shown[end]), (0.5, middle))
                look = self._look(("edge", a, b, quarters))
                normals[quarters] = turned(between, look, min(share, twice))
        return place

    def _around(self, grown: Growth, a: int, b: int) -> float:
        """How far the other edges of the triangles on both sides have grown, in the mean."""
        if (a, b) not in self.around.inner:
            return 1.0
        wings = [edge_name(end, c) for end in (a, b) for c in self.around.opposite[a, b]]
        return sum(grown.get(wing, (0.0, 0.0))[0] for wing in wings) / 4

    def centre(
        self, source: int, point: Vector, normal: Vector, grown: tuple[float, float]
    ) -> tuple[Vector, Vector]:
        """Moved and turned as far as all edges around have grown."""
        face = self.faces[source]
        name: Name = ("face", *face)
        known_as: Name = ("centre", *sorted(face))
        once, twice = grown
        missing = mix(
            (1 - twice, self._missing(face, known_as, self.seen_once)),
            (twice, self._missing(face, known_as, self.seen)),
        )
        if once > 0:
            slid = self.now.middle(face, self.middles, self.now.shares(face))
            before = self.now.middle(face, self.middles, [1 / 3] * 3)
            point = mix((1, point), (once, slid), (-once, before))
        moved = mix((1, point), (once, carried(missing, *self._frames(name))))
        return moved, turned(normal, self._look(name, known_as, twice), once)

    def _missing(self, face: Face, known_as: Name, seen: Seen) -> Vector:
        """What is missing at rest, where the middle of a triangle has slid to."""
        middles = {e: seen["edge", *e, 2][0] for e in (edge_name(*ends) for ends in ring(face))}
        before = self.rest.middle(face, middles, self.rest.shares(face))
        return mix((1, seen[known_as][0]), (-1, before))


def turned(normal: Vector, look: Vector, share: float) -> Vector:
    """A share of the way from one normal to another."""
    return unit(mix((1 - share, normal), (share, look)))
