"""The skin as a graph: fields on it, and paths along its edges, compared with scipy's."""

from itertools import pairwise

import numpy as np
import pytest
import scipy
from scipy import sparse

from risorius.sim.polylines import polyline_distance
from risorius.sim.skin_graph import graph_of
from risorius.sim.surface import build_surface


@pytest.fixture(scope="module")
def surface(model):
    """The skin of the built-in head."""
    return model.surface


def laplacian_of(surface):
    """The Laplacian of the edges' stiffness, assembled entry by entry."""
    i, j = surface.edges.T
    count = surface.vertex_count
    links = sparse.coo_array((surface.edge_stiffness, (i, j)), shape=(count, count)).tocsr()
    links = links + links.T
    return sparse.diags_array(links.sum(axis=1)) - links


def undirected(surface, lengths):
    """The mesh as scipy's undirected graph: each edge once."""
    return sparse.csr_array((lengths, tuple(surface.edges.T)), shape=(surface.vertex_count,) * 2)


def test_fields_solve_their_equations(surface, generator):
    """Smoothed and seeded fields solve their equations, for one column and several."""
    laplacian = laplacian_of(surface)
    seeds = np.zeros(surface.vertex_count)
    seeds[generator.integers(0, surface.vertex_count, 30)] = 1e4
    for diagonal in (surface.areas / 25.0, seeds + 1e-6 * surface.areas):
        solve = surface.graph.solver(surface.edge_stiffness, diagonal)
        system = (laplacian + sparse.diags_array(diagonal)).tocsc()
        for shape in ((surface.vertex_count,), (surface.vertex_count, 3)):
            wanted = generator.normal(size=shape)
            assert solve(system @ wanted) == pytest.approx(wanted, abs=1e-7)


def test_smoothing_keeps_the_sum_and_takes_details(surface, generator):
    """Smoothing keeps the area-weighted sum: a vertex's loss is its neighbours' gain."""
    noise = generator.normal(size=surface.vertex_count)
    smooth = surface.smoother(25.0)(noise)
    assert surface.areas @ smooth == pytest.approx(surface.areas @ noise)
    assert smooth.std() < 0.6 * noise.std()


def test_distances_are_those_of_the_undirected_graph(surface):
    """Distances are to the nearest of some vertices; a separate piece is infinitely far."""
    wanted = scipy.sparse.csgraph.dijkstra(
        undirected(surface, surface.lengths), directed=False, indices=[5, 400], min_only=True
    )
    assert (surface.distances_from(np.array([5, 400])) == wanted).all()
    triangles = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    apart = build_surface(np.eye(6, 3) * 10.0 + np.arange(6.0)[:, None], triangles)
    assert np.isinf(apart.distances_from(np.array([0]))[3:]).all()


@pytest.mark.parametrize("hindrance", [0.0, 3.0, 1000.0])
def test_ways_are_the_cheapest(surface, generator, hindrance):
    """Paths are the cheapest, also if they cost more than the search's first limit."""
    stops = [36, 300, 41, 700]
    cost = hindrance * generator.random(surface.vertex_count)
    way = surface.path_through(stops, cost)
    i, j = surface.edges.T
    graph = undirected(surface, surface.lengths * (1.0 + (cost[i] + cost[j]) / 2.0))
    wanted = scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=stops)
    both = graph + graph.T
    spent = sum(both[a, b] for a, b in pairwise(way))
    least = sum(wanted[k, stops[k + 1]] for k in range(3))
    assert spent == pytest.approx(least)
    assert way[0] == stops[0] and way[-1] == stops[-1]


def test_a_graph_is_known_by_its_triangles(surface):
    """Persons with the same triangles share a graph; a mesh with another vertex has its own."""
    count = surface.vertex_count
    known = graph_of(surface.faces, count)
    assert graph_of(surface.faces.copy(), count) is known
    other = graph_of(surface.faces, count + 1)
    assert other.order.tolist() != surface.graph.order.tolist()
    assert sorted(surface.graph.order.tolist()) == list(range(count))


def test_distance_to_a_polyline(generator):
    """Distances to a polyline equal the simple formula; corners may coincide."""
    points = generator.normal(size=(50, 3))
    corners = generator.normal(size=(6, 3))[[0, 1, 2, 2, 3, 4, 5]]
    shares = np.linspace(0.0, 1.0, 20001)[:, None]
    steps = [start + shares * (end - start) for start, end in pairwise(corners)]
    line = np.concatenate(steps)
    wanted = scipy.spatial.cKDTree(line).query(points)[0]
    assert polyline_distance(points, corners) == pytest.approx(wanted, abs=1e-6)
