"""Meshes with a large body: the body is simplified, and the face keeps its vertices."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from risorius.assets.fitting import simplifying
from risorius.assets.fitting.mesh_validation import SkinPiece
from risorius.assets.model import Head
from risorius.assets.topology import boundary_loops, grid_faces
from tests.assets import checks


@pytest.fixture
def with_body(head: Head) -> SkinPiece:
    """The built-in head with a body at its neck, 1.2 m long, with many triangles."""
    loops = boundary_loops(head.faces)
    neck = min(loops, key=lambda loop: head.vertices[loop, 1].mean())
    row_count = 120
    row_height = 10.0  # [mm]
    noise = np.random.default_rng(0)
    lowest = head.vertices[neck, 1].min()
    vertices = [head.vertices]
    for row in range(1, row_count):
        below = head.vertices[neck] * [1.0, 0.0, 1.0] + noise.normal(0.0, 1.0, (len(neck), 3))
        below[:, 1] += lowest - row_height * row
        vertices.append(below)
    points = np.vstack(vertices)
    added = np.arange(len(head.vertices), len(points)).reshape(-1, len(neck))
    body = grid_faces(np.vstack([neck, added]), closed=True)
    faces = np.vstack([head.faces, body])
    assert checks.is_manifold(faces)
    return SkinPiece(
        points, faces, head.landmarks, np.arange(len(points), dtype=np.int32), np.arange(len(faces))
    )


def test_a_face_keeps_its_vertices_beside_a_body_of_many(with_body, head, monkeypatch):
    """Vertices around the landmarks stay; the body is simplified, and stays connected."""
    monkeypatch.setattr(simplifying, "SIMPLIFIED_COUNT", 5000)
    assert len(with_body.faces) > 7000
    marks = head.vertices[head.landmarks]
    found = simplifying.simplified(with_body, marks)
    assert 4000 < len(found.faces) <= 5000
    near = cKDTree(marks).query(head.vertices)[0] < 60.0
    off = cKDTree(found.vertices).query(head.vertices[near])[0]
    assert off.max() < 1e-9
    assert checks.is_manifold(found.faces)
    assert checks.component_count(found.faces) == 1
    assert len(boundary_loops(found.faces)) == len(boundary_loops(with_body.faces))
    assert np.abs(found.vertices[:, 1].min() - with_body.vertices[:, 1].min()) < 5.0


def test_a_dense_head_leaves_triangles_to_its_body(with_body, head, monkeypatch):
    """If the head alone exceeds the limit, head and body are simplified and stay connected."""
    monkeypatch.setattr(simplifying, "SIMPLIFIED_COUNT", 1800)
    found = simplifying.simplified(with_body, head.vertices[head.landmarks])
    assert len(found.faces) <= 1800
    assert checks.component_count(found.faces) == 1
    assert len(boundary_loops(found.faces)) == len(boundary_loops(with_body.faces))


def test_sheets_that_touch_along_an_edge_are_parted():
    """Where simplification pinches a sheet, the sheet is continued, and the loose piece removed."""
    sheet = grid_faces(np.arange(25).reshape(5, 5))
    scrap = np.array([[12, 13, 25], [13, 12, 26], [12, 25, 26], [25, 13, 26]])
    vertices = np.random.default_rng(0).normal(size=(27, 3))
    pinched = np.vstack([sheet, scrap]).astype(np.int32)
    assert not checks.is_manifold(pinched)
    points, faces = simplifying.unpinched(vertices, pinched)
    assert checks.is_manifold(faces)
    assert np.array_equal(points[faces], vertices[sheet])


def test_two_folds_pinched_together_stay_one_surface():
    """Where opposite walls of a pocket are pinched together, all triangles keep their places."""
    rows = np.arange(30).reshape(6, 5)
    sheet = grid_faces(rows)
    number = np.arange(30)
    number[rows[4, 2:4]] = rows[1, 2:4]  # two distant edges of the sheet become one
    vertices = np.random.default_rng(0).normal(size=(30, 3))
    pinched = number[sheet].astype(np.int32)
    assert not checks.is_manifold(pinched)
    points, faces = simplifying.unpinched(vertices, pinched)
    assert checks.is_manifold(faces)
    assert checks.component_count(faces) == 1
    assert np.array_equal(points[faces], vertices[pinched])
