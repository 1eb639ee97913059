"""Normals of the refined surface again, in plain Python: sums over small triangles.

With every edge split once, each triangle becomes a fan of six triangles around its middle. The
normal at a point is the sum of the cross products of its fan's triangles, scaled to length one.
"""

from collections import Counter, defaultdict
from itertools import pairwise

from tests.refine.plain_schemes import Face, dot
from tests.refine.plain_twin import (
    EdgeName,
    GeomorphWeights,
    Placed,
    Rules,
    Surroundings,
    Vector,
    cross,
    edge_names,
    is_proper,
    mix,
    normals_along,
    unit,
)

ZERO: Vector = (0.0, 0.0, 0.0)


def area(*corners: Vector) -> Vector:
    """Cross product of two sides of a triangle."""
    a, b, c = corners
    return cross(mix((1, b), (-1, a)), mix((1, c), (-1, a)))


class RefinedNormals(Rules):
    """The points of a scheme, with normals between the scheme's and the refined surface's.

    Geomorph weights are the shares.
    """

    def __init__(self, rules: Rules, faces: list[Face]) -> None:
        self.rules = rules
        self.faces = faces
        self.around = Surroundings(faces)
        self.fans: dict[int, list[Vector]] = {}
        """Corners and middles of each triangle in turn, by its number."""

    def placed(self, count: Counter[EdgeName], grown: GeomorphWeights) -> Placed:
        """Points of the scheme, and normals blended by the geomorph weights."""
        edges = sorted(self.around.opposite)
        whole = self.rules.placed(
            Counter(dict.fromkeys(edges, 1)), dict.fromkeys(edges, (1.0, 1.0))
        )
        at_vertices, at_middles = self._surface(whole)
        place = self.rules.placed(count, grown)
        for (a, b), (once, _) in grown.items():
            mean = unit(mix((1, at_vertices[a]), (1, at_vertices[b])))
            soon = min(1.0, 3.0 * once)
            middle = unit(mix((1 - soon, mean), (soon, at_middles[a, b])))
            place.point_normals[a, b] = normals_along(at_vertices[a], middle, at_vertices[b])
        return Placed(place.vertices, place.points, at_vertices, place.point_normals)

    def _surface(self, whole: Placed) -> tuple[list[Vector], dict[EdgeName, Vector]]:
        """Unit normals of vertices and of the middles of all edges."""
        of_vertices = [ZERO] * len(whole.vertices)
        of_middles: dict[EdgeName, Vector] = defaultdict(lambda: ZERO)
        sheets: Counter[EdgeName] = Counter()
        for source, face in enumerate(self.faces):
            if not is_proper(face):
                continue
            corners = [whole.vertices[v] for v in face]
            names = edge_names(face)
            middles = [whole.points[name][2] for name in names]
            # 0.511 x (middle - half of both ends), summed over the edges; each corner is an end of
            # two edges.
            of_ends = [(1 / 3 - 0.511, corner) for corner in corners]
            of_edges = [(0.511, middle) for middle in middles]
            centre = mix(*of_ends, *of_edges)
            for i in range(3):
                k = (i + 1) % 3
                here = face[i]
                there = face[k]
                edge = names[i]
                first = area(corners[i], middles[i], centre)
                second = area(middles[i], corners[k], centre)
                of_vertices[here] = mix((1, of_vertices[here]), (1, first))
                of_vertices[there] = mix((1, of_vertices[there]), (1, second))
                of_middles[edge] = mix((1, of_middles[edge]), (1, first), (1, second))
                sheets[edge] += 1
            self.fans[source] = [p for pair in zip(corners, middles, strict=True) for p in pair]
        at_vertices = [unit(total) for total in of_vertices]
        at_middles = {}
        for a, b in sheets:
            mean = mix((0.5, at_vertices[a]), (0.5, at_vertices[b]))
            d = mix((1, whole.vertices[b]), (-1, whole.vertices[a]))
            steady = mix((1, of_middles[a, b]), (0.02 * dot(d, d), mean))
            is_one_surface = (a, b) in self.around.inner or sheets[a, b] == 1
            at_middles[a, b] = unit(steady if is_one_surface else mean)
        return at_vertices, at_middles

    def centre(
        self, source: int, point: Vector, normal: Vector, grown: tuple[float, float]
    ) -> tuple[Vector, Vector]:
        """The scheme's middle; its normal is turned to the area vector of the hexagon around it."""
        point, normal = self.rules.centre(source, point, normal, grown)
        outline = self.fans[source]
        pieces = [area(outline[0], here, there) for here, there in pairwise(outline[1:])]
        hexagon = unit(mix(*((1, piece) for piece in pieces)))
        soon = min(1.0, 3.0 * grown[0])
        return point, unit(mix((1 - soon, normal), (soon, hexagon)))
