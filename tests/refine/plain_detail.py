"""The scheme `detail` once more, in plain Python: what is seen at rest moves with the surface.

What the finer mesh adds is taken from the refiner itself, at rest and with everything split, once
and twice, by the names of its points; how it moves is worked out here. That it is like the finer
mesh is another test's business (test_detail.py).
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from tests.refine.plain_schemes import CurveRules, Face, cross, cubic, dot
from tests.refine.plain_twin import (
    EdgeName,
    GeomorphWeights,
    Name,
    Placed,
    Vector,
    edge_name,
    mix,
    unit,
)

T = TypeVar("T")
Axes = tuple[Vector, Vector, Vector]
Seen = dict[Name, Vector]
"""Position of every point."""


def axes_of(up: Vector, towards: Vector) -> Axes:
    """Three orthogonal directions: up, as far as possible towards, across."""
    up = unit(up)
    towards = unit(mix((1, towards), (-dot(towards, up), up)))
    return up, towards, cross(up, towards)


def ring(items: Sequence[T]) -> list[tuple[T, T]]:
    """Each of three and the next."""
    return [(items[i], items[(i + 1) % 3]) for i in range(3)]


def carried(vector: Vector, rest: Axes, now: Axes) -> Vector:
    """The vector that lies along the axes now as it lay along those at rest."""
    return mix(*((dot(vector, before), after) for before, after in zip(rest, now, strict=True)))


@dataclass
class Form:
    """The mesh in one shape: its cubic edges, and the directions of all its points."""

    cubic: CurveRules

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
            displacement = mix((turn_a, normals[a]), (-turn_b, normals[b]))
            bends.append(dot(displacement, displacement) + 0.02 * dot(chord, chord))
        total = sum(bends)
        return [0.4 / 3 + 0.6 * (bends[i] + bends[i - 1]) / (2 * total) for i in range(3)]

    def middle(self, face: Face, middles: dict[EdgeName, Vector], shares: list[float]) -> Vector:
        """The quadratic through corners and middles of edges, at some shares of the corners."""
        points = self.cubic.positions
        place = mix(*((share, points[v]) for v, share in zip(face, shares, strict=True)))
        for (a, b), (s, t) in zip(ring(face), ring(shares), strict=True):
            displacement = mix((1, middles[edge_name(a, b)]), (-0.5, points[a]), (-0.5, points[b]))
            place = mix((1, place), (4 * s * t, displacement))
        return place

    def axes(self, name: Name) -> Axes:
        """Directions of a point of an edge, or of the middle of a face (a, b, c)."""
        points, normals = self.cubic.positions, self.cubic.normals
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
        seen: tuple[Seen, Seen],
    ) -> None:
        """`seen`: at rest, blended, all edges split once, and twice."""
        self.rest = Form(cubic(rest, rest, faces))
        self.now = Form(cubic(rest, positions, faces))
        self.faces = faces
        self.seen_once, self.seen = seen
        self.twice: dict[EdgeName, float] = {}
        self.middles: dict[EdgeName, Vector] = {}

    def _frames(self, name: Name) -> tuple[Axes, Axes]:
        return self.rest.axes(name), self.now.axes(name)

    def curve(self, edge: EdgeName, quarters: int) -> Vector:
        """The cubic, and what was missing in it at rest."""
        name: Name = ("edge", *edge, quarters)
        before = self.rest.cubic.curve(edge, quarters)
        known = self.seen[name]
        if quarters == 2:
            twice = self.twice[edge]
            known = mix((1 - twice, self.seen_once[name]), (twice, known))
        missing = mix((1, known), (-1, before))
        now = self.now.cubic.curve(edge, quarters)
        return mix((1, now), (1, carried(missing, *self._frames(name))))

    def placed(self, count: Counter[EdgeName], grown: GeomorphWeights) -> Placed:
        """Points on these curves."""
        self.twice = {
            edge: twice if count[edge] == 2 else 0.0 for edge, (_, twice) in grown.items()
        }
        cubic_now = self.now.cubic
        rules = CurveRules(cubic_now.positions, self.faces, self.curve, cubic_now.normals)
        place = rules.placed(count, grown)
        self.middles = {edge: points[2] for edge, points in place.points.items()}
        return place

    def centre(
        self, source: int, point: Vector, normal: Vector, grown: tuple[float, float]
    ) -> tuple[Vector, Vector]:
        """Moved as far as all edges around have grown."""
        once, twice = grown
        if once == 0:
            return point, normal
        face = self.faces[source]
        missing = mix(
            (1 - twice, self._missing(face, self.seen_once)),
            (twice, self._missing(face, self.seen)),
        )
        slid = self.now.middle(face, self.middles, self.now.shares(face))
        before = self.now.middle(face, self.middles, [1 / 3] * 3)
        moved = carried(missing, *self._frames(("face", *face)))
        return mix((1, point), (once, slid), (-once, before), (once, moved)), normal

    def _missing(self, face: Face, seen: Seen) -> Vector:
        """What is missing at rest, where the middle of a triangle has slid to."""
        middles = {e: seen["edge", *e, 2] for e in (edge_name(*ends) for ends in ring(face))}
        before = self.rest.middle(face, middles, self.rest.shares(face))
        return mix((1, seen["centre", *sorted(face)]), (-1, before))
