"""Large meshes in a careless order: renumbered inside, and nobody outside can tell but by order."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import refine
from bench.sheets import sheet
from refine import locality
from tests import meshes
from tests.refine.cases import Needed, point_names, soups

OPTIONS: dict[str, dict[str, object]] = {
    "paper": {},
    "blend": {"blend": True},
    "coherent": {"coherent": True},
    "butterfly": {"scheme": "butterfly"},
    "cubic": {"scheme": "cubic", "criterion": ["bulge", "curvature"]},
}


@pytest.fixture
def every_mesh_is_careless(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small meshes, too, are renumbered."""
    monkeypatch.setattr(locality, "CACHE_LINES", 1)
    monkeypatch.setattr(locality, "MOST_FETCHED_ANEW", -1.0)


def create(mesh: meshes.Mesh, *, renumbered: bool, **options: object) -> refine.Refiner:
    """A refiner that is or is not renumbered, whatever the mesh is like."""
    with pytest.MonkeyPatch.context() as patch:
        if renumbered:
            patch.setattr(locality, "CACHE_LINES", 1)
            patch.setattr(locality, "MOST_FETCHED_ANEW", -1.0)
        refiner = refine.create(
            "kahler", mesh.faces, mesh.vertices, uv=mesh.uv, face_uv=mesh.face_uv, **options
        )
    assert isinstance(refiner, refine.Kahler)
    assert (refiner._order is not None) == renumbered
    return refiner


def named_triangles(
    refiner: refine.Refiner, refined: refine.RefinedMesh
) -> dict[tuple[int, frozenset[object]], np.ndarray]:
    """Subtriangles by source and names of their points; rows of their corners in that order."""
    names = point_names(refiner.origins())
    rows = np.concatenate([refined.positions, refined.normals], axis=1)
    found = {}
    for source, corners in zip(refined.source, refined.triangles, strict=True):
        ordered = sorted(corners.tolist(), key=lambda corner: str(names[corner]))
        found[int(source), frozenset(names[c] for c in corners)] = rows[ordered]
    return found


@pytest.mark.parametrize("name", OPTIONS)
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), columns=st.integers(2, 10), holes=st.integers(0, 3))
def test_renumbered_is_the_same(name: str, seed: int, columns: int, holes: int) -> None:
    """Frame by frame the same triangles with the same points, though in another order."""
    compare(seed, meshes.irregular(seed, columns, 9, holes), 2e-5, assume, **OPTIONS[name])


@pytest.mark.parametrize("seed", range(8))
def test_renumbered_detail_is_the_same(seed: int) -> None:
    """With a finer mesh that has no place as near to one triangle as to another.

    On others rounding chooses the triangle that a finer vertex is fitted to.
    """
    mesh = meshes.irregular(seed, 8, 9, holes=seed % 4)
    finer = mesh.vertices + 0.01, mesh.faces

    # What detail stores was fitted, in sums of another order.
    def expect(is_so: bool) -> None:
        assert is_so

    compare(seed, mesh, 1e-4, expect, scheme="detail", detail=finer)


def compare(
    seed: int,
    mesh: meshes.Mesh,
    looseness: float,
    expect: Callable[[bool], object],
    **options: object,
) -> None:
    """Refine frames with and without renumbering; `looseness` is for normals.

    `expect` is told whether the splits agree: an edge at its very threshold may fall otherwise.
    """
    ours, plain = (create(mesh, renumbered=is_so, **options) for is_so in (True, False))
    for step in range(3):
        deformed = meshes.wrinkled(mesh, seed, 0.1 + 0.1 * step)
        one, other = ours.refine(deformed), plain.refine(deformed)
        splits = {
            tuple(sorted(e)): s for e, s in zip(plain.edges.tolist(), plain.splits, strict=True)
        }
        expect(
            all(
                splits[tuple(sorted(e))] == s
                for e, s in zip(ours.edges.tolist(), ours.splits, strict=True)
            )
        )
        refine.check(ours, one, deformed)
        found, expected = named_triangles(ours, one), named_triangles(plain, other)
        assert found.keys() == expected.keys()
        for key, rows in expected.items():
            np.testing.assert_allclose(found[key][:, :3], rows[:, :3], rtol=0, atol=2e-5)
            np.testing.assert_allclose(found[key][:, 3:], rows[:, 3:], rtol=0, atol=looseness)


@settings(max_examples=60, deadline=None)
@given(soup=soups(), once=st.floats(50.0, 2000.0))
def test_soups(soup: tuple[np.ndarray, np.ndarray], once: float) -> None:
    """Any triangles at all come out proper, and the same as without."""
    mesh = meshes.Mesh(*soup)
    view = refine.View((0.0, 0.0, 4.0))
    ours, plain = (
        create(mesh, renumbered=is_so, criterion=refine.ScreenEdge(once, 1.5 * once))
        for is_so in (True, False)
    )
    one, other = ours.refine(mesh.vertices, view=view), plain.refine(mesh.vertices, view=view)
    refine.check(ours, one, mesh.vertices)
    assert named_triangles(ours, one).keys() == named_triangles(plain, other).keys()
    rows = [refined.positions[: len(mesh.vertices)] for refined in (one, other)]
    np.testing.assert_allclose(rows[0], rows[1], rtol=0, atol=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_shuffled_is_the_same(seed: int) -> None:
    """A mesh and the same with vertices, triangles and corners shuffled: the same triangles."""
    generator = np.random.default_rng(seed)
    mesh = meshes.irregular(seed, 20, 15)
    place = generator.permutation(len(mesh.vertices))
    order = generator.permutation(len(mesh.faces))
    vertices = np.empty_like(mesh.vertices)
    vertices[place] = mesh.vertices
    shuffled = meshes.Mesh(vertices, np.roll(place[mesh.faces][order], 1, axis=1))
    deformed = meshes.wrinkled(mesh, seed)
    moved = np.empty_like(deformed)
    moved[place] = deformed
    plain, ours = create(mesh, renumbered=False), create(shuffled, renumbered=True)
    one, other = plain.refine(deformed), ours.refine(moved)
    assert plain.splits.any()
    assert (place[plain.edges[plain.splits > 0]].sum() == ours.edges[ours.splits > 0].sum()).all()
    triangles = [
        sorted(
            (int(source), *np.round(corners.mean(axis=0), 3).tolist())
            for source, corners in zip(sources, mesh.positions[mesh.triangles], strict=True)
        )
        for sources, mesh in ((one.source, one), (order[other.source], other))
    ]
    np.testing.assert_allclose(triangles[0], triangles[1], rtol=0, atol=2e-3)


@pytest.mark.usefixtures("every_mesh_is_careless")
@pytest.mark.parametrize("name", ["none", "kahler"])
def test_rows_and_edges_are_the_callers(name: str) -> None:
    """Row v is vertex v, edges and their splits are named by the caller's numbers."""
    mesh = meshes.irregular(5)
    deformed = meshes.wrinkled(mesh, 6)
    refiner = refine.create(name, mesh.faces, mesh.vertices)
    refined = refiner.refine(deformed)
    still = np.ones(len(deformed), dtype=bool)
    still[refiner.edges[refiner.splits > 0]] = False
    assert still.any()
    rows = refined.positions[: len(deformed)]
    assert (rows[still] == deformed[still].astype(np.float32)).all()
    ends = np.sort(refiner.edges[refiner.triangle_edges], axis=2)
    expected = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2), axis=2)
    assert (ends == expected).all()
    assert not refiner.edges.flags.writeable and not refiner.triangle_edges.flags.writeable


@pytest.mark.usefixtures("every_mesh_is_careless")
def test_undeformed_equals_pass_through() -> None:
    """Where nothing is split, `kahler` and `none` agree to the last bit in any order."""
    mesh = meshes.irregular(2)
    ours, plain = (refine.create(n, mesh.faces, mesh.vertices) for n in ("kahler", "none"))
    for one, other in zip(
        ours.refine(mesh.vertices)[:4], plain.refine(mesh.vertices)[:4], strict=True
    ):
        assert one.tobytes() == other.tobytes()


@pytest.mark.usefixtures("every_mesh_is_careless")
@pytest.mark.parametrize("name", ["none", "kahler"])
def test_seams_and_attributes(name: str) -> None:
    """Values stay at their vertices and corners, on both sides of seams."""
    tube = meshes.tube(10, 6)
    assert tube.uv is not None and tube.face_uv is not None
    deformed = meshes.wrinkled(tube, 3, 0.3)
    refiner = refine.create(
        name,
        tube.faces,
        tube.vertices,
        uv=tube.uv,
        face_uv=tube.face_uv,
        attributes={"rest": tube.vertices},
    )
    refined = refiner.refine(deformed)
    refine.check(refiner, refined, deformed)
    assert refined.uv is not None
    origins = refiner.origins()
    at_rest = (tube.vertices[origins.vertices] * origins.weights[..., None]).sum(axis=1)
    np.testing.assert_allclose(refined.attributes["rest"], at_rest, rtol=0, atol=1e-6)
    for corners, sources in zip(refined.triangles, refined.source, strict=True):
        uv = tube.uv[tube.face_uv[sources]]
        assert (refined.uv[corners] >= uv.min(axis=0) - 1e-6).all()
        assert (refined.uv[corners] <= uv.max(axis=0) + 1e-6).all()


@pytest.mark.usefixtures("every_mesh_is_careless")
def test_rules_of_ones_own_see_the_callers_mesh() -> None:
    """A criterion from outside may know edges by number: its mesh is left in order."""

    class Curved(refine.Curvature):
        """Somebody's own, even if it is like a built-in one."""

    mesh = meshes.irregular(4)
    edges = refine.connect(mesh.faces, len(mesh.vertices)).edges
    for criterion in (Needed(np.ones(len(edges))), Curved(), ["curvature", Curved()]):
        refiner = refine.create("kahler", mesh.faces, mesh.vertices, criterion=criterion)
        assert (refiner.edges == edges).all()
    both = refine.create(
        "kahler", mesh.faces, mesh.vertices, criterion=["curvature", refine.Silhouette()]
    )
    assert (both.edges != edges).any()


def test_which_meshes_are_renumbered() -> None:
    """A large mesh out of order is, one in scan order or a small one is not."""
    ordered, shuffled = sheet("", 60_000), sheet("", 60_000, shuffled=True)
    small = sheet("", 20_000, shuffled=True)
    for load, is_renumbered in ((ordered, False), (shuffled, True), (small, False)):
        found = locality.better_order(load.faces.astype(np.int64), load.rest)
        assert (found is not None) == is_renumbered
    found = locality.better_order(shuffled.faces.astype(np.int64), shuffled.rest)
    assert found is not None
    order, faces = found
    assert (order.vertices[faces] == shuffled.faces[order.faces]).all()
    assert locality.better_order(faces.astype(np.int64), shuffled.rest[order.vertices]) is None


def test_own_corners_are_no_disorder() -> None:
    """Triangles that share no vertex fetch each line once, in whatever large a mesh."""
    faces = np.arange(300_000).reshape(-1, 3)
    assert locality.count_fetched_anew(faces, 300_000, locality.CACHE_LINES) == 0


@pytest.mark.usefixtures("every_mesh_is_careless")
def test_mesh_at_one_place() -> None:
    """Rest positions that are all the same, as of a collapsed part, give some order."""
    mesh = meshes.open_grid()
    refiner = refine.create("kahler", mesh.faces, np.zeros_like(mesh.vertices))
    refine.check(refiner, refiner.refine(mesh.vertices), mesh.vertices)


@pytest.mark.usefixtures("every_mesh_is_careless")
def test_error_names_the_callers_vertex() -> None:
    """The vertex that has blown up is named by its own number."""
    mesh = meshes.irregular(1)
    deformed = mesh.vertices.copy()
    deformed[7, 2] = np.nan
    refiner = refine.create("kahler", mesh.faces, mesh.vertices)
    with pytest.raises(ValueError, match=r"vertex 7 is .* \(1 such"):
        refiner.refine(deformed)


@pytest.mark.usefixtures("every_mesh_is_careless")
@pytest.mark.parametrize("number", [np.float32, np.float64])
def test_nothing_is_allocated(number: type[np.floating]) -> None:
    """After the first frame, frames take no memory; positions of any type and strides will do."""
    mesh = meshes.irregular(3, 40, 40)
    frames = [meshes.wrinkled(mesh, seed).astype(number) for seed in range(3)]
    strided = [np.repeat(frame, 2, axis=0)[::2] for frame in frames]
    frames[0].flags.writeable = False
    refiner = refine.create("kahler", mesh.faces, mesh.vertices)
    expected = [refiner.refine(frame).positions.tobytes() for frame in frames]
    assert [refiner.refine(frame).positions.tobytes() for frame in strided] == expected
    tracemalloc.start()
    try:
        for frame in frames + strided:
            refiner.refine(frame)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 4096


@pytest.mark.parametrize("seed", range(10))
def test_cycles(seed: int) -> None:
    """Rows brought back along cycles stand where the order says, whatever their width."""
    generator = np.random.default_rng(seed)
    count, columns = int(generator.integers(1, 40)), int(generator.integers(6, 10))
    vertices = generator.permutation(count).astype(np.uint32)
    rows = generator.random((count + 3, columns)).astype(np.float32)
    expected = rows.copy()
    expected[vertices] = rows[:count]
    locality.move_rows(*locality.list_cycles(vertices), rows)
    assert (rows == expected).all()
