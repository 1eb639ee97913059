"""The checker of refined meshes: each test breaks one relation, which the checker must report."""

import copy
from types import SimpleNamespace

import numpy as np
import pytest

from risorius import refine
from risorius.refine.border.checker import LATTICE_STEPS
from tests import meshes
from tests.refine.cases import kahler


class Wrapped:
    """A refiner whose report on its last frame can be falsified."""

    def __init__(self, refiner):
        self.refiner = refiner
        self.splits = refiner.splits.copy()
        self.false_origins = None

    def __getattr__(self, name):
        return getattr(self.refiner, name)

    def origins(self):
        """The falsified origins, if there are any."""
        return self.false_origins or self.refiner.origins()


@pytest.fixture
def frame() -> tuple[Wrapped, refine.RefinedMesh, np.ndarray]:
    """A refined mesh with its own arrays, its refiner, and the deformed positions."""
    mesh = meshes.irregular(11)
    deformed = meshes.wrinkled(mesh, 12, amplitude=0.3)
    refiner = kahler(mesh)
    refined = refiner.refine(deformed)
    assert set(refiner.splits.tolist()) == {0, 1, 2}
    return Wrapped(refiner), copy.deepcopy(refined), deformed


def without_triangles(mesh, lost):
    """The mesh without some triangles."""
    triangles = np.delete(mesh.triangles, lost, axis=0)
    return mesh._replace(triangles=triangles, source=np.delete(mesh.source, lost))


def of_a_split(mesh):
    """The number of a subtriangle of a split triangle."""
    return int(np.flatnonzero(np.bincount(mesh.source)[mesh.source] > 1)[0])


def write(array, place, value):
    """Write one value into an array."""
    array[place] = value


def check_breaks(relation, refiner, refined, deformed):
    """Check that the checker reports this relation as broken for a frame."""
    with pytest.raises(refine.BrokenMeshError, match=relation):
        refine.check(refiner, refined, deformed)


@pytest.mark.parametrize(
    ("broken", "relation"),
    [
        (lambda m: without_triangles(m, of_a_split(m)), "areas of its subtriangles add up"),
        (
            lambda m: without_triangles(m, m.source == m.source[5]),
            "every input triangle is part of the output",
        ),
        (
            lambda m: write(m.triangles, 3, m.triangles[3, ::-1].copy()),
            "orientation of its input triangle",
        ),
        (
            lambda m: write(m.source, of_a_split(m), m.source[of_a_split(m)] + 1),
            "lie in the input triangle it is part of",
        ),
        (
            lambda m: write(m.triangles, (2, 2), len(m.positions)),
            "triangles name vertices of the mesh",
        ),
        (lambda m: write(m.source, 2, 10**6), "sources name triangles of the input"),
        (lambda m: write(m.positions, (7, 1), np.nan), "positions are finite"),
        (lambda m: write(m.normals, 7, 2.0 * m.normals[7]), "normals have length one"),
        (
            lambda m: m._replace(positions=m.positions.astype(np.float64)),
            "positions and normals are float32",
        ),
        (lambda m: m._replace(normals=m.normals[:-1]), "one row of normals"),
    ],
)
def test_broken_output(frame, broken, relation):
    """Each fault of the output is reported with the relation it breaks."""
    refiner, refined, deformed = frame
    check_breaks(relation, refiner, broken(refined) or refined, deformed)


def test_t_junction(frame):
    """A whole triangle beside a split edge is reported, although all area is covered."""
    refiner, refined, deformed = frame
    counts = np.bincount(refined.source)
    source = int(np.flatnonzero(counts > 1)[0])
    edges = refiner.edges[refiner.triangle_edges[source]].tolist()
    first, second, third = map(set, edges)
    corners = [*(third & first), *(first & second), *(second & third)]
    keep = refined.source != source
    whole = refined._replace(
        triangles=np.concatenate([refined.triangles[keep], np.array([corners], dtype=np.uint32)]),
        source=np.append(refined.source[keep], np.int32(source)),
    )
    check_breaks("no crack, no T-junction", refiner, whole, deformed)


def test_crack_inside(frame):
    """Two subtriangles do not fit together if one of them is cut along the other diagonal."""
    refiner, refined, deformed = frame
    origins = refiner.origins()
    doubled = refine.Origins(
        np.concatenate([origins.vertices, origins.vertices[:1]]),
        np.concatenate([origins.weights, origins.weights[:1]]),
    )
    refiner.false_origins = doubled
    # A copy of vertex 0 at another place in space, used by one of the triangles around it.
    moved = refined._replace(
        positions=np.concatenate([refined.positions, refined.positions[:1] + np.float32(0.01)]),
        normals=np.concatenate([refined.normals, refined.normals[:1]]),
    )
    k, corner = np.argwhere(moved.triangles == 0)[0]
    moved.triangles[k, corner] = len(refined.positions)
    check_breaks("no crack along a seam", refiner, moved, deformed)


def test_edge_flip_inside(frame):
    """Subtriangles that overlap and miss the same area are detected by their inner sub-edges."""
    mesh = meshes.triangle()
    refiner = Wrapped(kahler(mesh))
    refined = refine.create("none", mesh.faces, mesh.vertices).refine(mesh.vertices)
    # The triangle on one side of its median is covered twice by the same half.
    origins = refine.Origins(
        np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2], [0, 1, 0]], dtype=np.int32),
        np.array([[1, 0, 0], [1, 0, 0], [1, 0, 0], [0.5, 0.5, 0]], dtype=np.float32),
    )
    refiner.false_origins = origins
    refiner.splits[:] = [1, 0, 0]
    halves = refined._replace(
        positions=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0, 0]], dtype=np.float32),
        normals=np.tile(np.array([[0, 0, 1]], dtype=np.float32), (4, 1)),
        triangles=np.array([[0, 3, 2], [0, 3, 2]], dtype=np.uint32),
        source=np.zeros(2, dtype=np.int32),
    )
    check_breaks("two subtriangles in opposite directions", refiner, halves, mesh.vertices)


@pytest.mark.parametrize(("has", "says"), [(2, 1), (1, 2), (0, 1), (1, 0)])
def test_wrong_split_count(frame, has, says):
    """Splits that do not fit the sub-edges are reported, whether too many or too few."""
    refiner, refined, deformed = frame
    e = int(np.flatnonzero(refiner.splits == has)[0])
    refiner.splits[e] = says
    check_breaks("2 to the power of s sub-edges", refiner, refined, deformed)


def test_moved_vertex(frame):
    """The smallest change of a vertex away from splits is reported."""
    refiner, refined, deformed = frame
    touched = np.unique(refiner.edges[refiner.splits > 0])
    v = int(np.setdiff1d(np.arange(len(deformed)), touched)[0])
    refined.positions[v, 0] = np.nextafter(refined.positions[v, 0], np.float32(np.inf))
    check_breaks("to the last bit", refiner, refined, deformed)


def test_lost_degenerate_triangle():
    """A triangle that names a vertex twice must occur once in the output."""
    mesh = meshes.with_debris()
    refiner = refine.create("none", mesh.faces, mesh.vertices)
    check_breaks(
        "names a vertex twice is passed on",
        refiner,
        double_degenerate(refiner.refine(mesh.vertices)),
        mesh.vertices,
    )


def double_degenerate(mesh):
    """Repeat the first triangle that names a vertex twice."""
    has_two = (mesh.triangles == np.roll(mesh.triangles, 1, axis=1)).any(axis=1)
    rows = np.append(np.arange(len(mesh.source)), np.flatnonzero(has_two)[:1])
    return mesh._replace(triangles=mesh.triangles[rows], source=mesh.source[rows])


def cut_at(places, inside):
    """Two triangles with a cut in their common edge, and a point inside the first.

    `places`: along the edge from vertex 0 to 2, for the first and the second triangle; `inside`:
    barycentric weights of the point.

        3---------2
        |       / |     The first is 0 1 2, with the point 6 inside; the second is 0 2 3.
        | 4,5 | 4 and 5 are the cut, for the first and the second.
        |  /    6 |
        0---------1
    """
    rest = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.float32)
    mesh = refine.connect([[0, 1, 2], [0, 2, 3]], 4)
    splits = np.zeros(len(mesh.edges), dtype=np.uint8)
    splits[mesh.triangle_edges[0, 2]] = 1
    one, other = places
    vertices = [[0, 0, 0], [1, 1, 1], [2, 2, 2], [3, 3, 3]]
    weights = [[1.0, 0.0, 0.0]] * 4
    vertices += [[0, 2, 1], [2, 0, 3], [0, 1, 2]]
    weights += [[1 - one, one, 0.0], [other, 1 - other, 0.0], [*inside]]
    origins = refine.Origins(np.array(vertices, np.int32), np.array(weights, np.float32))
    # Places nearer than a tenth of a part count as one place, so they have one position.
    cut = rest[2] * one
    points = np.vstack([rest, cut, cut, [0.7, 0.2, 0.0]])
    triangles = [[0, 1, 6], [1, 2, 6], [2, 4, 6], [4, 0, 6], [0, 5, 3], [5, 2, 3]]
    upward = np.array([0, 0, 1], dtype=np.float32)
    refined = refine.RefinedMesh(
        points.astype(np.float32),
        np.tile(upward, (7, 1)),
        np.array(triangles, dtype=np.uint32),
        np.array([0, 0, 0, 0, 1, 1], dtype=np.int32),
        None,
    )
    refiner = SimpleNamespace(
        edges=mesh.edges, triangle_edges=mesh.triangle_edges, splits=splits, origins=lambda: origins
    )
    return refiner, refined, rest


EDGE_PLACES = [1 / 2, 1 / 3, 3 / 8, 5 / 512, 3 / 7, 2 / 9, 1 / 11, 0.123456]
INNER_POINTS = [
    (1 / 3, 1 / 3, 1 / 3),
    (0.25, 0.5, 0.25),
    (1 / 13, 5 / 13, 7 / 13),
    (0.998, 0.001, 0.001),
]


@pytest.mark.parametrize("place", EDGE_PLACES)
@pytest.mark.parametrize("inside", INNER_POINTS)
def test_points_anywhere(place, inside):
    """A refiner may cut edges anywhere, and add points inside triangles."""
    refine.check(*cut_at((place, place), inside))


@pytest.mark.parametrize("place", [1 / 2, 1 / 3, 3 / 8, 5 / 512, 3 / 7, 2 / 9])
def test_single_precision_is_forgiven(place):
    """Weights of whole parts with rounding errors still mean the same place."""
    assert (place * LATTICE_STEPS) % 1.0 == pytest.approx(0.0, abs=1e-9)
    refine.check(*cut_at((place, place + 2e-7), INNER_POINTS[0]))


@pytest.mark.parametrize("place", EDGE_PLACES)
def test_places_apart_are_cracks(place):
    """An edge cut at two different places, however near, is a crack."""
    refiner, refined, rest = cut_at((place, place + 2.0 / LATTICE_STEPS), INNER_POINTS[0])
    check_breaks("no crack, no T-junction", refiner, refined, rest)


@pytest.mark.parametrize("weights", [(1.2, -0.1, -0.1), (0.5, 0.5, 0.001)])
def test_weights_of_no_place(weights):
    """Weights of a point outside its triangle, and weights whose sum is not one, are refused."""
    check_breaks(r"weights (below zero|that add up to one)", *cut_at((0.5, 0.5), weights))


def test_thin_subtriangle_on_an_edge():
    """Three points on one edge are a sliver, wherever they are."""
    refiner, refined, rest = cut_at((1 / 11, 1 / 11), INNER_POINTS[0])
    refined.triangles[2] = [2, 4, 0]
    check_breaks("no sliver", refiner, refined, rest)


def test_three_levels():
    """Edges of eight parts pass, but if they are checked as edges of four parts they fail."""
    mesh = meshes.irregular(3)
    refiner = Wrapped(refine.create("loop", mesh.faces, mesh.vertices, levels=3))
    refined = refiner.refiner.refine(mesh.vertices)
    assert len(refined.triangles) == 64 * len(mesh.faces)
    refine.check(refiner, refined, mesh.vertices)
    refiner.splits[:] = 2
    check_breaks("2 to the power of s sub-edges", refiner, refined, mesh.vertices)
