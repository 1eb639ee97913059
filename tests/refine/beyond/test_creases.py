"""Creases: sharp edges at rest stay in place, and nothing cracks along them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from pytest import approx

from risorius import refine
from risorius.refine.mesh.creases import dihedral_angles, sectors_of
from tests import meshes
from tests.meshes import cube
from tests.refine.cases import Forced, sound_frame, soups

LOOK_OPTIONS = {"scheme": "cubic", "criterion": "displacement+rest"}
RULES = [
    {},
    {"coherent": True},
    {"normals": "refined", "criterion": "displacement"},
    LOOK_OPTIONS,
    {**LOOK_OPTIONS, "blend": False},
    {**LOOK_OPTIONS, "normals": "linear", "blend": False},
]


def prism(sides):
    """A cylinder with this number of sides, radius 1 and height 2; each cap has a middle vertex."""
    turn = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    points = [np.column_stack([ring, np.full(sides, z)]) for z in (-1.0, 0.0, 1.0)]
    points.append(np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]))
    faces = []
    for k in range(sides):
        after = (k + 1) % sides
        for low in (0, sides):
            faces += [[low + k, low + after, low + sides + after]]
            faces += [[low + k, low + sides + after, low + sides + k]]
        faces += [[3 * sides, after, k], [3 * sides + 1, 2 * sides + k, 2 * sides + after]]
    return np.concatenate(points), np.array(faces)


def volume(points, faces):
    """Volume of a closed mesh."""
    a, b, c = points[faces].astype(float).swapaxes(0, 1)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("options", [LOOK_OPTIONS, {**LOOK_OPTIONS, "blend": False}])
def test_a_cylinder_keeps_its_rims(options):
    """A cylinder's sides become round, with a cylinder's volume; without creases it swells."""
    points, faces = prism(16)
    own = volume(points, faces)
    swollen = refine.create("kahler", faces, points, **options).refine(points)
    assert volume(swollen.positions, swollen.triangles) > 1.1 * own
    refiner = refine.create("kahler", faces, points, crease_angle=40.0, **options)
    refined = sound_frame(refiner, points)
    assert refined.triangle_count > len(faces)
    assert volume(refined.positions, refined.triangles) == approx(2.0 * np.pi, rel=0.01)
    heights = refined.positions[:, 2]
    assert abs(heights).max() == 1.0
    is_lid = abs(points[faces][:, :, 2].mean(axis=1)) == 1.0
    lids = np.unique(refined.triangles[is_lid[refined.source]])
    assert (abs(heights[lids]) == 1.0).all()


def test_a_cube_stays_one():
    """A cube's flat sides need no splits; forced splits move nothing by more than rounding."""
    points = cube().vertices
    faces = cube().faces
    refined = refine.create("kahler", faces, points, crease_angle=80.0, **LOOK_OPTIONS).refine(
        points
    )
    assert refined.triangle_count == 12
    refiner = refine.create("kahler", faces, points, crease_angle=80.0, scheme="cubic", blend=False,
                            criterion=Forced(np.full(18, 2)))  # fmt: skip
    refined = refiner.refine(points)
    assert refined.triangle_count == 120
    assert volume(refined.positions, refined.triangles) == approx(1.0, abs=1e-6)
    assert refined.positions.min() >= -1e-6
    assert refined.positions.max() <= 1.0 + 1e-6


@pytest.mark.parametrize("scheme", ["loop", "cubic"])
def test_new_points_of_creases_lie_on_them(scheme):
    """New points on creases follow the border rule.

    Both straight ridges of a roof stay straight.
    """
    x, y = np.meshgrid(np.arange(5.0), np.arange(7.0))
    flat = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    points = flat + [0.0, 0.0, 1.0] * np.abs(x.ravel() - 2.0)[:, None]
    number = np.arange(x.size).reshape(x.shape)
    a = number[:-1, :-1]
    b = number[:-1, 1:]
    c = number[1:, 1:]
    d = number[1:, :-1]
    first_half = np.stack([a, b, c], axis=2)
    second_half = np.stack([a, c, d], axis=2)
    faces = np.concatenate([first_half, second_half]).reshape(-1, 3)
    refiner = refine.create(
        "kahler", faces, points, scheme=scheme, crease_angle=45.0, blend=False,
        criterion=Forced(np.full(len(refine.connect(faces, x.size).edges), 2)),
    )  # fmt: skip
    assert isinstance(refiner, refine.Kahler)
    is_sharp = refiner.connectivity.is_sharp
    assert is_sharp.sum() == 6
    assert (points[refiner.edges[is_sharp]][..., 0] == 2.0).all()
    refined = sound_frame(refiner, points)
    assert_allclose(refined.positions[:, 2], np.abs(refined.positions[:, 0] - 2.0), atol=1e-6)


@pytest.mark.parametrize("levels", [1, 2, 3])
def test_uniform_subdivision_keeps_them(levels):
    """Halves of creases are creases.

    In uniform subdivision a cube keeps its corners and flat sides.
    """
    points = cube().vertices
    faces = cube().faces
    refiner = refine.create("loop", faces, points, levels=levels, crease_angle=60.0)
    refined = refiner.refine(points)
    assert refined.positions.min() == 0.0
    assert refined.positions.max() == 1.0
    assert volume(refined.positions, refined.triangles) == approx(1.0, abs=1e-6)
    refine.check(refiner, refined, points)


@settings(max_examples=60)
@given(
    soup=soups(),
    angle=st.sampled_from([0.0, 20.0, 90.0, 170.0]),
    options=st.sampled_from(RULES),
    seed=st.integers(0, 999),
)
def test_no_crack_whatever_is_sharp(soup, angle, options, seed):
    """With any creases on any triangles, `check` finds no crack.

    Some edges have one or three triangles; some triangles are flipped or doubled.
    """
    points, faces = soup
    refiner = refine.create("kahler", faces, points, crease_angle=angle, **options)
    moved = points + np.random.default_rng(seed).normal(0.0, 0.2, points.shape)
    sound_frame(refiner, moved)


@settings(max_examples=60)
@given(soup=soups(), angle=st.sampled_from([0.0, 20.0, 90.0]))
def test_sectors_are_what_creases_leave_together(soup, angle):
    """Creases at a vertex separate its corners into sectors.

    Corners joined by an edge that is not a crease have one sector; corners on both sides of a
    crease have two.
    """
    points, faces = soup
    refiner = refine.create("kahler", faces, points, crease_angle=angle)
    assert isinstance(refiner, refine.Kahler)
    mesh = refiner.connectivity
    sectors = sectors_of(mesh)
    assert (sectors.corners[sectors.corners < mesh.vertex_count] < mesh.vertex_count).all()
    vertex_of = {}
    for sector, vertex in zip(sectors.corners.ravel(), mesh.faces.ravel(), strict=True):
        assert vertex_of.setdefault(int(sector), int(vertex)) == vertex
    on_crease = set(mesh.edges[mesh.is_sharp].ravel().tolist())
    assert {vertex for sector, vertex in vertex_of.items() if sector != vertex} <= on_crease
    for e, (a, b) in enumerate(mesh.edges.tolist()):
        found = [set(), set()]
        for t in np.flatnonzero((mesh.triangle_edges == e).any(axis=1)):
            for end, vertex in enumerate((a, b)):
                found[end].add(int(sectors.corners[t][mesh.faces[t] == vertex][0]))
        if not mesh.is_sharp[e]:
            assert len(found[0]) == len(found[1]) == 1


def test_angles_by_hand():
    """A cube's edges turn by 90 degrees; its diagonals, borders and slivers by none."""
    points = cube().vertices
    faces = cube().faces
    mesh = refine.connect(faces, 8)
    angles = np.degrees(dihedral_angles(mesh, points))
    assert sorted(angles.round(9).tolist()) == [0.0] * 6 + [90.0] * 12
    open_mesh = refine.connect(faces[2:], 8)
    assert np.degrees(dihedral_angles(open_mesh, points)).max() == approx(90.0)
    sliver = refine.connect([[0, 1, 2], [1, 0, 3]], 4)
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]])
    assert (dihedral_angles(sliver, flat) == 0.0).all()


def test_off_by_default_and_refused_in_words():
    """By default, and at 180 degrees, creases change no bit.

    A value that is not an angle is refused.
    """
    mesh = meshes.irregular(3)
    bent = meshes.wrinkled(mesh, 4)
    frames = [
        refine.create("kahler", mesh.faces, mesh.vertices, **more, **LOOK_OPTIONS).refine(bent)
        for more in ({}, {"crease_angle": None}, {"crease_angle": 180.0})
    ]
    for frame in frames[1:]:
        assert_array_equal(frame.positions, frames[0].positions)
        assert_array_equal(frame.normals, frames[0].normals)
    for wrong in (-1.0, 181.0, np.nan, "sharp", True):
        with pytest.raises(ValueError, match="crease_angle must be None or an angle from 0 to 180"):
            refine.create("none", mesh.faces, mesh.vertices, crease_angle=wrong)


@pytest.mark.parametrize("rules", [{}, LOOK_OPTIONS])
def test_on_the_card(rules):
    """On the card the paper's rule supports creases; the processor refines cubic edges."""
    points, faces = prism(12)
    moved = points * [1.0, 0.6, 1.3]
    options = {"crease_angle": 40.0, **rules}
    card = refine.create("kahler-gl", faces, points, **options).refine(moved)
    processor = refine.create("kahler", faces, points, **options).refine(moved)
    assert_array_equal(card.triangles, processor.triangles)
    assert_allclose(card.positions, processor.positions, atol=1e-6)
