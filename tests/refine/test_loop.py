"""Uniform Loop subdivision compared with a simple implementation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from risorius import refine
from tests import meshes
from tests.refine.cases import Forced, as_lists, edge_count_of, kahler, sound_frame, soups
from tests.refine.plain_twin import (
    Surroundings,
    edge_name,
    first_level_point,
    is_proper,
    mix,
    moved_vertex,
    unit,
    vertex_normals,
)

Triangles = list[tuple[int, int, int]]


def loop_plainly(points, faces, normals):
    """One step of Loop subdivision over dictionaries.

    New points are numbered in order of first use.
    """
    around = Surroundings(faces)
    fine_points = [moved_vertex(v, points, around) for v in range(len(points))]
    fine_normals = list(normals)
    number = {}
    for face in filter(is_proper, faces):
        for i in range(3):
            edge = edge_name(face[i], face[(i + 1) % 3])
            if edge not in number:
                number[edge] = len(fine_points)
                fine_points.append(first_level_point(edge, points, around))
                fine_normals.append(unit(mix((0.5, normals[edge[0]]), (0.5, normals[edge[1]]))))
    fine_faces = []
    for face in faces:
        if not is_proper(face):
            fine_faces.append(face)
            continue
        a, b, c = face
        ab, bc, ca = (number[edge_name(*ends)] for ends in ((a, b), (b, c), (c, a)))
        fine_faces += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return fine_points, fine_faces, fine_normals


def assert_is_plain(mesh, deformed, levels):
    """Compare `loop` with the simple implementation, number by number."""
    refiner = refine.create("loop", mesh.faces, mesh.vertices, levels=levels)
    refined = sound_frame(refiner, deformed)
    points, faces = as_lists(deformed, mesh.faces)
    normals = vertex_normals(points, faces)
    for _ in range(levels):
        points, faces, normals = loop_plainly(points, faces, normals)
    assert refined.triangles.tolist() == [list(face) for face in faces]
    assert_allclose(refined.positions, np.array(points), rtol=0, atol=3e-6)
    return refined, np.array(normals)


@pytest.mark.parametrize("levels", [1, 2, 3])
@pytest.mark.parametrize("name", meshes.NAMED_MESHES)
def test_named_meshes(name, levels):
    """Every test mesh, deformed, is subdivided as by the simple implementation."""
    mesh = meshes.NAMED_MESHES[name]()
    assert_is_plain(mesh, meshes.wrinkled(mesh, 3), levels)


@settings(max_examples=60, deadline=None)
@given(soup=soups(), levels=st.integers(1, 3))
def test_soups(soup, levels):
    """Random triangles are subdivided as by the simple implementation."""
    positions, faces = soup
    assert_is_plain(meshes.Mesh(positions, faces), positions, levels)


def test_interpolated_normals():
    """Normals are interpolated along the edges of each level, as in the simple implementation."""
    mesh = meshes.irregular(7)
    refined, normals = assert_is_plain(mesh, meshes.wrinkled(mesh, 8), 2)
    assert_allclose(refined.normals, normals, rtol=0, atol=4e-6)


def test_equals_kahler_at_one_level():
    """With every edge split once, the adaptive refiner makes one step of Loop subdivision."""
    mesh = meshes.irregular(9)
    deformed = meshes.wrinkled(mesh, 10)
    loop = refine.create("loop", mesh.faces, mesh.vertices).refine(deformed)
    edge_count = edge_count_of(mesh)
    adaptive = kahler(mesh, criterion=Forced(np.ones(edge_count))).refine(deformed)
    assert loop.positions.tobytes() == adaptive.positions.tobytes()
    assert loop.normals.tobytes() == adaptive.normals.tobytes()
    triangles, expected = (
        {tuple(sorted(corners)) for corners in refined.triangles.tolist()}
        for refined in (loop, adaptive)
    )
    assert triangles == expected


@pytest.mark.parametrize("levels", [0, 5, 1.5, 2.0, "2"])
def test_bad_levels(levels):
    """Only one to four levels are accepted."""
    mesh = meshes.triangle()
    with pytest.raises(ValueError, match=r"levels was .*, must be a whole number from 1 to 4"):
        refine.create("loop", mesh.faces, mesh.vertices, levels=levels)
