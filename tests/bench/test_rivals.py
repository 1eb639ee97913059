"""The benchmark of refinement compared with other libraries."""

import numpy as np
import pytest

from risorius.bench import rivals, subjects
from risorius.bench.rival_libraries import RIVAL_METHODS, Method
from tests.app.command_line import succeeded
from tests.bench.test_quality import rolled_plane


@pytest.fixture(scope="module")
def surfaces():
    """The sphere and the sine plane, as meshes with known surfaces."""
    return {case.surface: case for case in rivals.cases([])}


def rows_of(case, methods):
    """Measured rows, by the title of the method."""
    rows, skipped = rivals.measure(case, methods, 0.01)
    assert skipped == []
    return {row.method: row for row in rows}


def test_ours_keeps_to_the_triangles_and_comes_nearer(surfaces):
    """Risorius makes at most four times the triangles.

    Cubic edges are nearer to the surface than the mesh, and Loop's surface is farther away.
    """
    for case in surfaces.values():
        rows = rows_of(case, rivals.OWN_METHODS)
        most = rivals.TRIANGLE_RATIO * len(case.faces)
        assert all(row.triangles <= most for row in rows.values())
        before = rows["risorius, not refined"].distance
        assert rows["risorius, cubic where a split moves most"].distance < 0.6 * before
        assert rows["risorius, cubic, all edges"].distance < 0.6 * before
        assert rows["risorius, Loop, all edges"].distance > before
        assert all(0.0 < row.frame < 1000.0 and row.first > 0.0 for row in rows.values())


def test_a_library_that_is_missing_is_one_line(monkeypatch):
    """For all methods of a missing library, one line names its package and how to install it."""
    missing = Method("nobody, smooth", "nobody", "nobody_has_this", None, has_limit=False)
    monkeypatch.setattr(rivals, "RIVAL_METHODS", [missing, missing])
    methods, skipped = rivals.available()
    assert methods == list(rivals.OWN_METHODS)
    cure = "install it in the checkout: pip install '.[rivals]'"
    assert skipped == [f"skipped: nobody needs nobody; {cure}"]


def test_a_mesh_that_is_refused_is_one_line(surfaces):
    """A library that raises an error on a mesh is left out of the rows for this surface."""

    def refuse(faces, rest):
        raise ValueError("not manifold")

    method = Method("strict", "risorius", "risorius.refine", refuse, has_limit=False)
    rows, skipped = rivals.measure(surfaces["sphere"], [rivals.OWN_METHODS[0], method], 0.01)
    assert [row.method for row in rows] == ["risorius, not refined"]
    assert skipped == ["skipped: strict of the sphere: not manifold"]


@pytest.mark.slow
@pytest.mark.parametrize("method", RIVAL_METHODS, ids=lambda method: method.title)
def test_each_library_that_is_there_refines(method, surfaces):
    """Each installed library makes nearly four times the triangles, near the surface."""
    pytest.importorskip(method.module, reason="needs the extra 'rivals'")
    for case in surfaces.values():
        (row,) = rows_of(case, [method]).values()
        assert 0.8 < row.triangles / (rivals.TRIANGLE_RATIO * len(case.faces)) <= 1.0
        assert row.distance < 25_000


@pytest.mark.slow
def test_loop_is_the_same_surface_in_libigl(surfaces):
    """On a closed surface the uniform Loop rule and libigl's matrix make the same points."""
    pytest.importorskip("igl", reason="needs the extra 'rivals'")
    case = surfaces["sphere"]
    (libigl,) = (method for method in RIVAL_METHODS if method.package == "libigl")
    ours = rivals.OWN_METHODS[-1].bind(case.faces, case.rest)(case.positions, 0.0)
    theirs = libigl.bind(case.faces, case.rest)(case.positions, 0.0)
    found = np.unique(np.round(ours[0], 5), axis=0)
    assert np.abs(found - np.unique(np.round(theirs[0], 5), axis=0)).max() < 1e-4


def test_the_command(monkeypatch):
    """The command prints versions, and a table for each surface, also for a head."""
    monkeypatch.setattr(rivals, "RIVAL_METHODS", RIVAL_METHODS[-1:])
    monkeypatch.setattr(subjects, "built_in", rolled_plane)
    output = succeeded("bench", "rivals", "--seconds", "0.05")
    assert "risorius 0." in output
    assert "sine plane, 154 triangles" in output
    assert "head, roll 1, 72 triangles" in output
    assert "libigl" in output
