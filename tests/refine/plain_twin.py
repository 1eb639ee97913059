"""The paper's whole algorithm again, in plain Python over dictionaries, from the paper's text.

The second implementation shares no line, no array and no table with the first: section 4.1 for the
criterion, 4.2 with Figs. 3 and 4 for the positions, 4.3 for the triangles. Points have names
instead of numbers, so nothing depends on an order:

    ("vertex", v) or ("edge", low, high, quarters from low)
"""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable
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
    """The vector, scaled to length one, or zero."""
    length = math.sqrt(sum(x * x for x in vector))
    return mix((1.0 / length, vector)) if length > 1e-15 else (0.0, 0.0, 0.0)


def cross(u: Vector, v: Vector) -> Vector:
    """Cross product of two vectors."""
    x = u[1] * v[2] - u[2] * v[1]
    y = u[2] * v[0] - u[0] * v[2]
    z = u[0] * v[1] - u[1] * v[0]
    return x, y, z


def normals_along(first: Vector, middle: Vector, last: Vector) -> dict[int, Vector]:
    """Unit normals of an edge's points, by quarters.

    Quarter points are half way to the middle's normal.
    """
    ends = {1: first, 2: middle, 3: last}
    return {quarters: unit(mix((1, n), (1, middle))) for quarters, n in ends.items()}


def edge_name(a: int, b: int) -> EdgeName:
    """The name of an edge, the same for both of its directions; ends may be numpy's integers."""
    low, high = sorted((int(a), int(b)))
    return low, high


def splits_of(edges: Iterable[Iterable[int]], metric: Iterable[float]) -> dict[EdgeName, int]:
    """Splits of edges by their names: one if the metric is above 0, two if it is above 1."""
    splits = {}
    for (a, b), needed in zip(edges, metric, strict=True):
        splits[edge_name(a, b)] = int(needed > 0) + int(needed > 1)
    return splits


def edge_names(face: tuple[int, int, int]) -> list[EdgeName]:
    """Names of a triangle's edges, from its first corner on."""
    return [edge_name(face[i], face[(i + 1) % 3]) for i in range(3)]


def is_proper(face: tuple[int, int, int]) -> bool:
    """Whether a triangle has three different corners."""
    return len(set(face)) == 3


def vertex_normals(positions: list[Vector], faces: list[tuple[int, int, int]]) -> list[Vector]:
    """Area-weighted normals: sums of cross products, whose lengths are twice the areas."""
    sums: list[Vector] = [(0.0, 0.0, 0.0)] * len(positions)
    for face in faces:
        a, b, c = (positions[v] for v in face)
        u = mix((1, b), (-1, a))
        v = mix((1, c), (-1, a))
        for vertex in face:
            sums[vertex] = mix((1, sums[vertex]), (1, cross(u, v)))
    return [unit(total) for total in sums]


def edge_dots(positions: list[Vector], faces: list[tuple[int, int, int]]) -> dict[EdgeName, float]:
    """Dot product of the vertex normals at the ends of each edge (section 4.1)."""
    normals = vertex_normals(positions, faces)
    names = {name for face in faces if is_proper(face) for name in edge_names(face)}
    return {
        (a, b): sum(x * y for x, y in zip(normals[a], normals[b], strict=True)) for a, b in names
    }


class Surroundings:
    """Neighbours of each edge and vertex."""

    def __init__(self, faces: list[tuple[int, int, int]]) -> None:
        runs: dict[EdgeName, list[bool]] = defaultdict(list)
        self.opposite: dict[EdgeName, list[int]] = defaultdict(list)
        for face in filter(is_proper, faces):
            for i in range(3):
                a = face[i]
                b = face[(i + 1) % 3]
                c = face[(i + 2) % 3]
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
    """A moved vertex (Fig. 3, right)."""
    ring = around.ring[v]
    border = around.border_ring[v]
    if len(border) == 2:
        return mix((0.75, positions[v]), *((0.125, positions[u]) for u in border))
    if border or not ring:
        return positions[v]
    valence = len(ring)
    beta = 3 / 16 if valence == 3 else 3 / (8 * valence)
    neighbours = [(beta, positions[u]) for u in ring]
    return mix((1 - valence * beta, positions[v]), *neighbours)


def first_level_point(edge: EdgeName, positions: list[Vector], around: Surroundings) -> Vector:
    """The first-level point of an edge (Fig. 3, left)."""
    a, b = (positions[v] for v in edge)
    if edge not in around.inner:
        return mix((0.5, a), (0.5, b))
    c, d = (positions[v] for v in around.opposite[edge])
    return mix((3 / 8, a), (3 / 8, b), (1 / 8, c), (1 / 8, d))


GeomorphWeights = dict[EdgeName, tuple[float, float]]
AtPoints = dict[EdgeName, dict[int, Vector]]


@dataclass
class Placed:
    """Positions and normals of vertices, and of the points of split edges by quarters."""

    vertices: list[Vector]
    points: AtPoints
    normals: list[Vector]
    point_normals: AtPoints


class Rules:
    """A smoothing scheme, in simple code."""

    def placed(self, count: Counter[EdgeName], grown: GeomorphWeights) -> Placed:
        """Positions and normals of all points, for these splits."""
        raise NotImplementedError

    def centre(
        self, source: int, point: Vector, normal: Vector, grown: tuple[float, float]
    ) -> tuple[Vector, Vector]:
        """The middle of a triangle, with its normal; by default both stay as they are.

        grown: least geomorph weights of the triangle's edges, of first and second level.
        """
        return point, normal


class PaperRules(Rules):
    """The paper's scheme; normals of new points are interpolated along the edge."""

    def __init__(self, positions: list[Vector], faces: list[tuple[int, int, int]]) -> None:
        self.positions = positions
        self.faces = faces

    def placed(self, count: Counter[EdgeName], grown: GeomorphWeights) -> Placed:
        """Positions after section 4.2."""
        normals = vertex_normals(self.positions, self.faces)
        at_points = {}
        for a, b in grown:
            middle = unit(mix((1, normals[a]), (1, normals[b])))
            at_points[a, b] = normals_along(normals[a], middle, normals[b])
        moved, points = _smoothed(self.positions, self.faces, count, grown)
        return Placed(moved, points, normals, at_points)


def refine(
    positions: list[Vector],
    faces: list[tuple[int, int, int]],
    splits: dict[EdgeName, int],
    *,
    geomorph: GeomorphWeights | None = None,
    rules: Rules | None = None,
) -> Twin:
    """Split each edge as often as `splits` states; missing edges are not split.

    `geomorph`: weights of an edge's points on both levels, for blending, which also cuts triangles
    into fans; `rules`: the scheme, by default the paper's.
    """
    twin = Twin()
    count = Counter(splits)
    grown = {e: (1.0, 1.0) if geomorph is None else geomorph[e] for e in count if count[e]}
    rules = rules or PaperRules(positions, faces)
    place = rules.placed(count, grown)
    for v in range(len(positions)):
        twin.positions["vertex", v] = place.vertices[v]
        twin.normals["vertex", v] = place.normals[v]
    for (a, b), points in place.points.items():
        for quarters in (1, 2, 3) if count[a, b] == 2 else (2,):
            twin.positions["edge", a, b, quarters] = points[quarters]
            twin.normals["edge", a, b, quarters] = place.point_normals[a, b][quarters]
    for source, face in enumerate(faces):
        edges = edge_names(face)
        split_count = sum(count[e] for e in edges)
        if geomorph is not None and is_proper(face) and split_count > 1:
            fan, centre = _fan(twin, face, count, grown)
            once = [grown.get(e, (0.0, 0.0))[0] for e in edges]
            twice = [grown[e][1] if count[e] == 2 else 0.0 for e in edges]
            least = min(once), min(twice)
            before = twin.positions[centre], twin.normals[centre]
            twin.positions[centre], twin.normals[centre] = rules.centre(source, *before, least)
            twin.triangles += [(source, corners) for corners in fan]
        else:
            twin.triangles += [(source, corners) for corners in _subtriangles(face, count)]
    return twin


def _smoothed(
    positions: list[Vector], faces: list[tuple[int, int, int]], count: Counter[EdgeName],
    grown: GeomorphWeights,
) -> tuple[list[Vector], AtPoints]:  # fmt: skip
    """The paper's rules, with geomorph weights."""
    around = Surroundings(faces)
    moved = []
    for v, position in enumerate(positions):
        shares = [once for edge, (once, _) in grown.items() if v in edge]
        share = max(shares, default=0.0)
        target = moved_vertex(v, positions, around)
        moved.append(mix((1 - share, position), (share, target)))
    first = {e: first_level_point(e, positions, around) for e in grown}

    def first_or_middle(u: int, v: int) -> Vector:
        edge = edge_name(u, v)
        middle = mix((0.5, positions[u]), (0.5, positions[v]))
        share, _ = grown.get(edge, (0.0, 0.0))
        point = first.get(edge, middle)
        return mix((1 - share, middle), (share, point))

    points: dict[EdgeName, dict[int, Vector]] = {}
    for edge, m in first.items():
        a, b = edge
        once, twice = grown[edge]
        chords = {end: mix((0.5, moved[end]), (0.5, m)) for end in edge}
        straight = mix((0.5, moved[a]), (0.5, moved[b]))
        if count[edge] == 1:
            points[edge] = {2: mix((1 - once, straight), (once, m))}
        elif edge in around.inner:
            c, d = around.opposite[edge]
            beside = {}
            near = {}
            for end in edge:
                left = first_or_middle(end, c)
                right = first_or_middle(end, d)
                beside[end] = [left, right]
                near[end] = mix((3 / 8, moved[end]), (3 / 8, m), (1 / 8, left), (1 / 8, right))
            ring = [moved[a], moved[b], *beside[a], *beside[b]]
            centre = mix((5 / 8, m), *((1 / 16, p) for p in ring))
            points[edge] = {
                1: mix((1 - twice, chords[a]), (twice, near[a])),
                2: mix((1 - twice, m), (twice, centre)),
                3: mix((1 - twice, chords[b]), (twice, near[b])),
            }
        else:
            centre = mix((3 / 4, m), (1 / 8, moved[a]), (1 / 8, moved[b]))
            middle = mix((1 - twice, m), (twice, centre))
            points[edge] = {1: chords[a], 2: middle, 3: chords[b]}
    return moved, points


def _fan(
    twin: Twin, face: tuple[int, int, int], count: Counter[EdgeName], grown: GeomorphWeights
) -> tuple[list[tuple[Name, Name, Name]], Name]:
    """Subtriangles around the middle of a triangle, and the middle's name.

    Adds the middle to the twin.
    """
    outline: list[Name] = []
    centre: Name = ("centre", *sorted(face))
    edges = edge_names(face)
    sums = {}
    grown_by = []
    for edge in edges:
        once, _ = grown.get(edge, (0.0, 0.0))
        grown_by.append(once if count[edge] else 0.0)
    corner_weights, edge_weights = centre_weights(grown_by)
    for kind in ("positions", "normals"):
        values = getattr(twin, kind)
        terms = [(w, values["vertex", v]) for w, v in zip(corner_weights, face, strict=True)]
        for weight, edge in zip(edge_weights, edges, strict=True):
            if count[edge]:
                terms.append((weight, values["edge", *edge, 2]))
                terms += [(-weight / 2, values["vertex", v]) for v in edge]
        sums[kind] = mix(*terms)
    twin.positions[centre] = sums["positions"]
    twin.normals[centre] = unit(sums["normals"])
    for i, edge in enumerate(edges):
        outline.append(("vertex", face[i]))
        places = {0: [], 1: [2], 2: [1, 2, 3]}[count[edge]]
        if face[i] != edge[0]:
            places = places[::-1]
        outline += [("edge", *edge, quarters) for quarters in places]
    following = outline[1:] + outline[:1]
    parts = zip(outline, following, strict=True)
    return [starting_at_least([centre, p, q]) for p, q in parts], centre


def centre_weights(grown: list[float]) -> tuple[list[float], list[float]]:
    """Weights of corners, and of the displacements of edges, for the middle of a triangle.

    `grown`: geomorph weights of the edges from corner 0 to 1, 1 to 2, 2 to 0. The result is a mean
    of four rules.
    """
    first, second, third = sorted(range(3), key=lambda i: -grown[i])
    shared = next(i for i in range(3) if {first, second} == {i, (i + 2) % 3})
    centroid = [1 / 3] * 3
    first_edge = [2 / 3 * (i == first) for i in range(3)]
    beside_shared = [1 / 2 if i == shared else 1 / 4 for i in range(3)]
    two_edges = [1 / 2 * (i != third) for i in range(3)]
    # The share of each rule, its weights of corners, and those of edges.
    rules = [
        (1 - grown[first], centroid, [2 / 3] * 3),
        (grown[first] - grown[second], centroid, first_edge),
        (grown[second] - grown[third], beside_shared, two_edges),
        (grown[third], centroid, [4 / 9] * 3),
    ]
    corners = [sum(share * of_corners[i] for share, of_corners, _ in rules) for i in range(3)]
    edges = [sum(share * of_edges[i] for share, _, of_edges in rules) for i in range(3)]
    return corners, edges


def starting_at_least(corners: list[Name]) -> tuple[Name, Name, Name]:
    """Rotate a triangle's corners so that the least comes first.

    Equal triangles then compare equal.
    """
    k = min(range(3), key=lambda i: [str(part) for part in corners[i]])
    return corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]


def _subtriangles(
    face: tuple[int, int, int], count: Counter[EdgeName]
) -> list[tuple[Name, Name, Name]]:
    if not is_proper(face):
        return [starting_at_least([("vertex", v) for v in face])]
    turned = [face[k:] + face[:k] for k in range(3)]
    kinds = [tuple(count[edge] for edge in edge_names(each)) for each in turned]
    k = next(k for k in range(3) if kinds[k] in PATTERNS)
    corner = turned[k]
    points: dict[str, Name] = {str(i): ("vertex", corner[i]) for i in range(3)}
    for i in range(3):
        start = corner[i]
        end = corner[(i + 1) % 3]
        low, high = edge_name(start, end)
        for letter, quarters in (("a", 1), ("m", 2), ("b", 3)):
            points[f"{letter}{i}"] = ("edge", low, high, quarters if start == low else 4 - quarters)
    pattern = PATTERNS[kinds[k]]
    return [
        starting_at_least([points[name] for name in part.split()]) for part in pattern.split(",")
    ]
