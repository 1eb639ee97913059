"""Smooth paths beside a line: where sealed lips are cut, and where covered eyes are opened."""

import numpy as np
import pytest
import scipy
from numpy.linalg import norm

from risorius.assets.fitting.fillings import filling_of
from risorius.assets.fitting.smooth_paths import smooth_path
from risorius.assets.meshes import Mesh
from risorius.assets.sheets import make_grid
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import vertex_normals
from risorius.geometry.sides import border_edges

from ..heads import masked


def turns(line):
    """Angles between consecutive segments of a polyline [rad]."""
    along = unit_vectors(np.diff(line, axis=0))
    return np.arccos(np.clip((along[1:] * along[:-1]).sum(axis=1), -1.0, 1.0))


def test_a_path_between_two_rows_follows_one_of_them():
    """A line between two rows of vertices gives a straight path, not teeth from row to row."""
    vertices, faces = make_grid(30, 10, 2.0)
    low, high = np.unique(vertices[:, 1])[5:7]
    inside = np.sort(vertices[vertices[:, 1] == low, 0])[2:-2]
    line = np.column_stack([inside[[0, -1]], [0.51 * low + 0.49 * high] * 2, [0.0, 0.0]])
    path = smooth_path(vertices, faces, line)
    assert len(path) == len(inside)
    assert turns(vertices[path]).max() < 1e-6


def test_a_line_over_two_pieces_has_no_path():
    """Edges of one piece do not lead to the other."""
    vertices, faces = make_grid(4, 4, 2.0)
    apart = np.array([20.0, 0.0, 0.0])
    both = np.vstack([vertices, vertices + apart])
    line = np.array([vertices[0], vertices[0] + apart])
    assert smooth_path(both, np.vstack([faces, faces + len(vertices)]), line) is None


def scanned(spacing):
    """The covered face of `masked` with the triangles of a scanner: rows that follow no lid."""
    mask = masked()
    faces = mask.mesh.faces
    normals = vertex_normals(mask.mesh.vertices, faces)
    front = mask.mesh.vertices[normals[:, 2] > 0.2]
    grid, triangles = make_grid(round(150.0 / spacing), round(175.0 / spacing), spacing)
    turn = scipy.spatial.transform.Rotation.from_euler("z", 25.0, degrees=True)
    marks = mask.mesh.vertices[mask.landmarks]
    flat = turn.apply(grid - grid.mean(axis=0)) + marks.mean(axis=0)
    heights = scipy.interpolate.griddata(front[:, :2], front[:, 2], flat[:, :2])
    is_skin = np.isfinite(heights)
    flat[:, 2] = np.where(is_skin, heights, 0.0)
    return Mesh(flat, triangles[is_skin[triangles].all(axis=1)]), marks


def nearest_vertices(mesh, marks):
    """The vertices nearest to landmarks, (68,)."""
    return scipy.spatial.cKDTree(mesh.vertices).query(marks)[1].astype(np.int32)


def mean_turn(mesh, triangles):
    """Mean angle [degrees] between sides of the edge of a sheet of triangles, which is one loop."""
    border = border_edges(mesh.faces[triangles])
    around = [int(border[0, 0]), int(border[0, 1])]
    while around[-1] != around[0]:
        links = border[(border == around[-1]).any(axis=1)]
        ends = links[links != around[-1]]
        around.append(int(ends[ends != around[-2]][0]))
    assert len(around) == len(border) + 1
    return np.degrees(turns(mesh.vertices[around])).mean()


@pytest.mark.parametrize("has_hole", [False, True])
def test_covered_eyes_of_a_scan_get_smooth_openings(has_hole):
    """The triangles left out before an eye have an edge without steps, though no row follows it.

    A hole beside a corner once gave a saw: it touches the edge, so the sheet was no disc.
    """
    mesh, marks = scanned(2.0 if has_hole else 2.5)
    nearest = nearest_vertices(mesh, marks)
    found = filling_of(mesh, nearest, marks)
    if has_hole:
        middles = mesh.vertices[mesh.faces[found.triangles]].mean(axis=1)
        by_distance = np.argsort(norm(middles - marks[42], axis=1))
        hole = found.triangles[by_distance[4]]  # one of its corners lies on the edge
        mesh = Mesh(mesh.vertices, np.delete(mesh.faces, hole, axis=0))
        found = filling_of(mesh, nearest, marks)
    assert "left eye" in found.openings
    middles = mesh.vertices[mesh.faces[found.triangles]].mean(axis=1)
    for eye in (slice(36, 42), slice(42, 48)):
        is_before = norm(middles - marks[eye].mean(axis=0), axis=1) < 25.0
        # Steps from row to row would turn by 56 degrees in the mean.
        assert mean_turn(mesh, found.triangles[is_before]) < 45.0


def test_a_coarse_scan_of_covered_eyes_is_opened():
    """Paths along edges of 4.2 mm meet 6 mm before a corner; such scans were refused."""
    mesh, marks = scanned(4.2)
    found = filling_of(mesh, nearest_vertices(mesh, marks), marks)
    assert found.openings == ("right eye", "left eye")
