"""Heads with too many triangles: a simplified mesh is simulated, and the file's mesh follows."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from numpy.linalg import norm
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree

from risorius import render, sim
from risorius.app.scenes import FaceScene
from risorius.app.scenes.dense_skin import DenseSkin
from risorius.app.viewer.picture.highlights import highlights
from risorius.app.viewer.picture.skin import MuscleFinder
from risorius.assets import AssetError
from risorius.assets.fitting import fit, simplified_head, simplifying
from risorius.assets.fitting.lips import lip_cut
from risorius.assets.fitting.painting import sampled
from risorius.assets.meshes import Mesh
from risorius.assets.sheets import make_grid
from risorius.geometry.closest import closest_points
from risorius.geometry.normals import vertex_normals
from risorius.geometry.sides import numbered_edges
from risorius.refine import Embedding
from tests.heads import sealed, user_head
from tests.sim.poses import advance


@pytest.fixture(scope="module")
def dense() -> FaceScene:
    """A head above the limit, which is lowered here."""
    other = user_head()
    colours = np.tile(np.array([180, 140, 120], np.uint8), (len(other.mesh.vertices), 1))
    mesh = Mesh(other.mesh.vertices, other.mesh.faces, colours=colours)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simplifying, "MOST_SIMULATED", 4000)
        patch.setattr(simplifying, "SIMPLIFIED_COUNT", 2500)
        return FaceScene(fit(mesh, other.landmarks))


def test_its_own_triangles_are_drawn(dense):
    """All triangles of the file are drawn at their places, and fewer are simulated.

    Triangles of a fading neck come last.
    """
    other = user_head()
    drawn, of_file = (each[np.lexsort(each.T)] for each in (dense.faces, other.mesh.faces))
    assert np.array_equal(drawn, of_file)
    rest = dense.head.to_millimetres.points(other.mesh.vertices)
    assert_allclose(dense.rest_positions, rest, atol=1e-9)
    assert len(dense.simulation.faces) <= 2500 < 4000 < len(dense.faces)
    assert dense.skin.uv is not None
    assert dense.skin.face_uv.shape == dense.faces.shape
    assert dense.face.head_weight.shape == (len(rest),)
    assert any("simplified" in note for note in dense.head.notes)


def test_a_hovered_muscle_shades_a_dense_skin(dense, face):
    """The shade lies on the simulated mesh, so near the drawn one that its lift shows it.

    A muscle is measured once, and the muscle of another face has no highlight.
    """
    dense.reset()
    corner = dense.rest_positions[dense.head.landmarks[54]]
    finder = MuscleFinder()
    muscle = finder.at(dense.simulation, corner)
    assert finder.at(dense.simulation, corner) is muscle
    shade = next(each for each in highlights(dense, {}, muscle) if isinstance(each, render.Shade))
    assert len(shade.opacity) == len(shade.vertices) < len(dense.positions)
    assert shade.opacity.max() > 0.2
    lit = shade.vertices[shade.opacity > 0.1]
    below = closest_points(lit, dense.positions, dense.faces).interpolate(dense.positions)
    assert norm(below - lit, axis=1).max() < shade.lift
    assert highlights(face, {}, muscle) == []


def test_it_follows_and_comes_back(dense):
    """The file's triangles smile like the simulated mesh; a copy stays still.

    All return to rest.
    """
    dense.reset()
    twin = dense.clone()
    dense.pose({"joy": 1.0, "jaw_open": 0.5})
    advance(dense, 20)
    moved = norm(dense.positions - dense.rest_positions, axis=1)
    simulated = dense.simulation.positions - dense.simulation.rest_positions
    farthest = norm(simulated, axis=1).max()
    assert farthest > 5.0
    assert 0.8 * farthest < moved.max() < 1.2 * farthest
    assert_allclose(twin.positions, twin.rest_positions, atol=1e-3)
    dense.reset()
    assert_allclose(dense.positions, dense.rest_positions, atol=1e-3)


def test_it_follows_when_it_is_read(dense, monkeypatch):
    """After several steps, the file's vertices move once, when they are read.

    A second reading moves nothing.
    """
    moves = []
    evaluate = Embedding.evaluate

    def counted(self, positions, **options):
        moves.append(len(positions))
        return evaluate(self, positions, **options)

    dense.reset()
    dense.pose({"joy": 1.0})
    seen = dense.positions
    monkeypatch.setattr(Embedding, "evaluate", counted)
    advance(dense, 6)
    assert not moves
    assert dense.positions is seen
    assert dense.positions is seen
    assert len(moves) == 1
    assert np.abs(seen - dense.rest_positions).max() > 1.0


def test_its_simplified_mesh_is_a_head(dense, monkeypatch):
    """The simplified mesh moves like the mesh below the dense skin.

    It has the same picture in another layout.
    """
    making = import_module("risorius.assets.fitting.simplified_head")
    for name in ("plain_picture", "plain_light"):  # a small picture is drawn in less time
        whole = getattr(making, name)
        monkeypatch.setattr(making, name, lambda known, whole=whole: whole(known)[::4, ::4])
    alone = FaceScene(simplified_head(dense.head))
    assert np.array_equal(alone.faces, dense.simulation.faces)
    for scene in (alone, dense):
        scene.reset()
        scene.pose({"joy": 1.0})
        advance(scene, 20)
    assert_allclose(alone.positions, dense.simulation.positions, atol=1e-9)
    skins = [scene.skin for scene in (alone, dense)]
    assert skins[0].albedo.shape[:2] == skins[0].ambient_occlusion.shape
    places = [skin.uv[skin.face_uv].reshape(-1, 2) for skin in skins]
    colours = [sampled(skin.albedo, at) for skin, at in zip(skins, places, strict=True)]
    corners = [scene.rest_positions[scene.faces].reshape(-1, 3) for scene in (alone, dense)]
    nearest = cKDTree(corners[1]).query(corners[0])[1]
    off = np.abs(colours[0].astype(float) - colours[1][nearest]).mean(axis=1)
    assert np.percentile(off, 90) < 12.0
    with pytest.raises(AssetError, match="are simulated as they are"):
        simplified_head(alone.head)


def test_lips_keep_their_own_vertices(dense):
    """An open mouth parts the lips, so no vertex of one lip follows the other."""
    dense.reset()
    dense.pose({"jaw_open": 1.0})
    advance(dense, 30)
    marks = dense.landmarks
    upper = dense.positions[marks[62]] - dense.rest_positions[marks[62]]
    lower = dense.positions[marks[66]] - dense.rest_positions[marks[66]]
    assert upper[1] - lower[1] > 8.0
    simulated = dense.simulation
    among = growth(simulated.faces, simulated.positions, simulated.rest_positions)
    assert growth(dense.faces, dense.positions, dense.rest_positions) < among


def test_lips_of_a_sealed_scan_part_without_strands(monkeypatch):
    """Lips that were one surface face the same way, but no vertex follows the other lip."""
    monkeypatch.setattr(simplifying, "MOST_SIMULATED", 4000)
    monkeypatch.setattr(simplifying, "SIMPLIFIED_COUNT", 2500)
    shut = sealed()
    mesh = halved(shut.mesh)
    rough = np.random.default_rng(2).normal(0.0, 0.3, mesh.vertices.shape)  # [mm]
    mesh = replace(mesh, vertices=mesh.vertices + rough)
    cut = lip_cut(mesh, shut.landmarks, mesh.vertices[shut.landmarks])
    scene = FaceScene(fit(cut.applied(mesh), cut.landmarks, points=cut.points))
    assert len(scene.simulation.faces) < len(scene.faces)
    scene.pose({"jaw_open": 1.0})
    advance(scene, 30)
    simulated = scene.simulation
    among = growth(simulated.faces, simulated.positions, simulated.rest_positions)
    assert growth(scene.faces, scene.positions, scene.rest_positions) < 1.2 * among


def test_a_fold_of_the_scan_stays_on_its_own_side():
    """A vertex in a fold of a scan may face the wrong way, but moves with its neighbours."""
    sheet, triangles = make_grid(4, 4, 8.0)
    gap = np.array([0.0, 0.0, 1.0])
    coarse = Mesh(
        np.vstack([sheet, sheet + gap]),
        np.vstack([triangles[:, ::-1], triangles + len(sheet)]).astype(np.int32),
    )
    simulation = sim.create(coarse)
    flat, faces = make_grid(16, 16, 2.0)
    fine = flat + gap
    folded = int(norm(fine - fine.mean(axis=0), axis=1).argmin())
    ring = np.setdiff1d(faces[(faces == folded).any(axis=1)], [folded])
    fine[ring, 0] = 2.0 * fine[folded, 0] - fine[ring, 0]
    assert vertex_normals(fine, faces)[folded, 2] < 0.0
    skin = DenseSkin(fine, faces, simulation)
    apart = np.repeat([[0.0, 0.0, -5.0], [0.0, 0.0, 5.0]], len(sheet), axis=0)
    skin.follow(simulation.rest_positions + apart)
    assert_allclose(skin.positions, fine + np.array([0.0, 0.0, 5.0]), atol=1e-6)


def halved(mesh):
    """The mesh with each edge halved, which makes four triangles of each."""
    edges, number = numbered_edges(mesh.faces)
    a, b, c = mesh.faces.T
    ab, bc, ca = len(mesh.vertices) + number.reshape(3, -1)
    quarters = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    faces = np.vstack([np.stack(each, axis=1) for each in quarters])
    middles = mesh.vertices[edges].mean(axis=1)
    return Mesh(np.vstack([mesh.vertices, middles]), faces.astype(np.int32))


def growth(faces, positions, rest):
    """The largest growth of an edge since rest [mm]."""
    lengths = [
        norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2)
        for points in (positions, rest)
    ]
    return (lengths[0] - lengths[1]).max()
