"""The tools of the generator, on shapes whose answers are known."""

import numpy as np
import numpy.typing as npt
import pytest

from risorius.assets.generator import form, lips
from risorius.assets.generator.eye_rows import COLUMNS as EYE_COLUMNS
from risorius.assets.generator.eye_rows import eye_rows
from risorius.assets.generator.fields import (
    cast,
    ellipsoid,
    gradient,
    project,
    smooth_maximum,
    smooth_minimum,
    sphere,
    tapered_capsule,
)
from risorius.assets.generator.infill import (
    Domain,
    inside_polygon,
    layout,
    triangulate,
    wanted_length,
)
from risorius.assets.generator.mouth_rows import SEAM_ROW, mouth_rows
from risorius.assets.generator.outline import midline_curve, resampled, rim_curve
from risorius.assets.generator.remesh import (
    Freedom,
    InfillMesh,
    collapse_edges,
    flip_edges,
    split_edges,
)
from risorius.assets.generator.sections import base_radius, direction_coordinates, rays
from risorius.assets.generator.solids import Solid, grid_faces, joined, mix, welded
from risorius.assets.topology import (
    boundary_loops,
    edge_faces,
    halved,
    quads_between,
    smallest_angles,
)
from risorius.geometry.normals import cross_products

Points = npt.NDArray[np.float64]


def ball(points: Points) -> Points:
    """A ball of radius 5 around the origin."""
    return sphere(points, (0.0, 0.0, 0.0), 5.0)


def directions(count: int) -> Points:
    """Seeded random unit vectors."""
    vectors = np.random.default_rng(1).normal(size=(count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def test_gradient_of_a_ball_points_outward() -> None:
    """A distance field has unit slope."""
    outward = directions(20)
    assert np.allclose(gradient(ball, 7.0 * outward), outward, atol=1e-3)


def test_projection_and_casting_find_the_surface() -> None:
    """Newton from both sides, a ray from outside; a ray that misses ends at its reach."""
    outward = directions(20)
    for start in (4.0, 6.5):
        assert np.allclose(project(ball, start * outward), 5.0 * outward, atol=1e-3)
    assert np.allclose(cast(ball, 20.0 * outward, -outward, reach=30.0), 5.0 * outward, atol=1e-4)
    away = cast(ball, 20.0 * outward[:1], outward[:1], reach=10.0)
    assert np.linalg.norm(away) == pytest.approx(30.0, abs=0.01)


def test_smooth_union_only_adds_and_only_near_the_seam() -> None:
    """The fillet lies outside both shapes and vanishes a radius away."""
    first, second = np.array([1.0, 1.0, -3.0]), np.array([1.0, 9.0, 2.0])
    union = smooth_minimum(first, second, 4.0)
    assert union[0] == pytest.approx(0.0)  # a quarter of the radius where both are equal
    assert np.array_equal(union[1:], [1.0, -3.0])
    assert np.array_equal(smooth_maximum(first, second, 4.0), -smooth_minimum(-first, -second, 4.0))


def test_round_primitives_agree_with_the_ball() -> None:
    """An ellipsoid with equal radii and a capsule without length are balls."""
    points = 6.0 * directions(10)
    assert np.allclose(ellipsoid(points, (0, 0, 0), (5.0, 5.0, 5.0), turn_deg=30), ball(points))
    capsule = tapered_capsule(points, (0, 0, 0), (0, 1e-9, 0), 5.0, 5.0)
    assert np.allclose(capsule, ball(points), atol=1e-6)


def test_capsule_coordinates_are_inverted_by_rays() -> None:
    """Also above the crown, where the axis ends."""
    angle = np.array([0.0, 0.7, 1.5, 2.5])
    height = np.array([-120.0, 0.0, 60.0, 130.0])
    origins, outward = rays(angle, height)
    again = direction_coordinates(origins + 80.0 * outward)
    for found, expected in zip(again, (angle, height, np.full(4, 80.0)), strict=True):
        assert np.allclose(found, expected)


def test_form_is_mirror_symmetric_and_continuous_over_the_crown() -> None:
    """The same on both sides; no step where capsule and dome meet."""
    points = 90.0 * directions(200)
    assert np.allclose(form.distance(points), form.distance(points * [-1.0, 1.0, 1.0]))
    below, above = (
        base_radius(np.zeros(1), np.array([39.99])),
        base_radius(np.zeros(1), np.array([40.01])),
    )
    assert abs(below - above)[0] < 0.02


def test_form_has_no_step_where_relief_begins() -> None:
    """Along the cheek, from its side to its front, the form's value changes evenly."""
    for height in (-28.6, -10.0, 20.0):
        depth = np.linspace(35.0, 60.0, 501)
        line = np.column_stack([np.full(501, 62.6), np.full(501, height), depth])
        steps = np.diff(form.head_distance(line))
        assert np.abs(np.diff(steps)).max() < 0.002


def test_lip_borders_enclose_the_seam() -> None:
    """Upper above, lower below, meeting at the corner; a bow in the middle."""
    x = np.linspace(0.0, lips.HALF_WIDTH, 30)
    upper, seam, lower = lips.upper_border(x), lips.seam_height(x), lips.lower_border(x)
    assert np.all(upper[:-1] > seam[:-1]) and np.all(seam[:-1] > lower[:-1])
    assert upper[-1] == pytest.approx(seam[-1]) and lower[-1] == pytest.approx(seam[-1])
    assert upper[:8].argmax() > 0


def test_rows_of_eye_and_mouth_have_their_columns() -> None:
    """Equal lengths, ends of the mouth in the mid-plane, lower lip line behind the upper."""
    assert [row.shape for row in eye_rows()] == [(EYE_COLUMNS, 3)] * 5
    rows = mouth_rows()
    assert all(row[0, 0] == row[-1, 0] == 0.0 for row in rows)
    seam = rows[SEAM_ROW]
    assert np.all(seam[:7, 2] > seam[:-8:-1, 2])


def test_resampling_follows_the_wanted_size() -> None:
    """Equal steps on a straight line; ends are kept; a short line is one segment."""
    line = np.column_stack([np.linspace(0.0, 10.0, 101), np.zeros(101), np.zeros(101)])
    assert np.allclose(np.diff(resampled(line, np.full(101, 2.0))[:, 0]), 2.0)
    assert len(resampled(line, np.full(101, 99.0))) == 2


def test_outline_curves_lie_on_the_form() -> None:
    """Rim and profile are on the surface; the rim goes around the neck, from nape to throat."""
    rim = rim_curve()
    assert np.abs(form.distance(rim)).max() < 0.05
    assert rim[0, 0] == rim[-1, 0] == 0.0 and rim[:, 1].max() < -135.0
    assert rim[0, 2] < -50.0 and rim[-1, 2] > 40.0
    assert np.all(midline_curve(60.0, 10.0)[:, 0] == 0.0)


def test_layout_shows_the_face_once() -> None:
    """The profile is one line without a turn, from crown to upper lip and from chin to throat."""
    for start, end in ((140.0, -60.0), (-77.0, -159.0)):
        flat = layout(midline_curve(start, end))
        assert np.allclose(flat[:, 0], 0.0)
        assert np.all(np.diff(flat[:, 1]) < 0.0)
    assert wanted_length(np.array([[0.0, -67.0, 104.0]]))[0] < wanted_length(
        np.array([[60.0, 90.0, 0.0]])
    )


def test_triangulation_contains_its_chains() -> None:
    """A chain across the grain of the Delaunay triangulation is recovered by flips."""
    x, y = np.meshgrid(np.linspace(-20, 20, 9), np.linspace(-10, 30, 9))
    border = [(i, j) for i in range(9) for j in range(9) if i in (0, 8) or j in (0, 8)]
    border.sort(key=lambda ij: np.arctan2(ij[0] - 4, ij[1] - 4))
    outline = np.array([(x[ij], y[ij], 100.0) for ij in border])
    chain = np.array([[-12.0, -3.0, 100.0], [12.3, 23.2, 100.0]])
    count = len(outline)
    domain = Domain(np.vstack([outline, chain]), list(range(count)), [], [[count, count + 1]])
    inner = np.column_stack([x[1:-1, 1:-1].ravel() + 0.9, y[1:-1, 1:-1].ravel(), np.full(49, 100)])
    points, faces = triangulate(domain, inner)
    assert domain.locked_edges() <= set(edge_faces(faces))
    assert len(boundary_loops(faces)) == 1 and len(points) == count + 2 + 49


def test_polygon_test_knows_inside() -> None:
    """Even-odd rule on a concave polygon."""
    polygon = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]])
    inside = inside_polygon(np.array([[0.5, 1.0], [2.0, 3.0], [3.5, 2.0], [5.0, 1.0]]), polygon)
    assert inside.tolist() == [True, False, True, False]


def patch() -> InfillMesh:
    """A patch of the forehead as a regular grid, its border fixed."""
    x, y = np.meshgrid(np.linspace(5.0, 35.0, 6), np.linspace(35.0, 65.0, 6))
    vertices = form.from_front(x.ravel(), y.ravel())
    faces = grid_faces(6, 6)
    freedom = np.full(36, Freedom.FREE, dtype=np.int8)
    freedom[np.unique(boundary_loops(faces)[0])] = Freedom.FIXED
    return InfillMesh(vertices, faces, freedom, set())


def test_remeshing_steps_keep_a_disc_a_disc() -> None:
    """Splits add two faces each, collapses take two; flips change none; nothing turns over."""
    mesh = patch()
    before = len(mesh.faces)
    splits = split_edges(mesh, scale=0.3)
    assert splits > 0 and len(mesh.faces) == before + 2 * splits
    flip_edges(mesh)
    assert len(mesh.faces) == before + 2 * splits
    collapses = collapse_edges(mesh, scale=3.0)
    assert collapses > 0 and len(mesh.faces) == before + 2 * splits - 2 * collapses
    assert len(boundary_loops(mesh.faces)) == 1
    assert cross_products(mesh.vertices, mesh.faces)[:, 2].min() > 0.0


def test_locked_edges_survive() -> None:
    """Neither splits nor flips nor collapses touch them."""
    mesh = patch()
    mesh.locked = {(14, 15), (15, 16)}
    split_edges(mesh, scale=0.3)
    flip_edges(mesh)
    collapse_edges(mesh, scale=3.0)
    assert mesh.locked <= set(edge_faces(mesh.faces))


def test_quads_are_cut_along_the_better_diagonal() -> None:
    """A kite keeps its good angles; strips close on demand."""
    kite = np.array([[0.0, 0, 0], [3.0, -1, 0], [6.0, 0, 0], [3.0, 1, 0]])
    faces = halved(kite, [[0, 1, 2, 3]])
    assert smallest_angles(kite, faces).min() == pytest.approx(36.87, abs=0.01)
    assert len(quads_between([[0, 1, 2], [3, 4, 5]], closed=True)) == 3
    assert len(quads_between([[0, 1, 2], [3, 4, 5]], closed=False)) == 2


def test_solids_are_joined_and_welded() -> None:
    """Coinciding vertices become one, vanished faces go, colours stay with their vertices."""
    points = np.array([[0.0, 0, 0], [0.0, 0, 0], [1.0, 0, 0], [1.0, 1, 0]])
    colours = mix((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), np.array([0.0, 0.0, 0.5, 2.0]))
    solid = Solid(points, np.array([[0, 2, 3], [0, 1, 2]], dtype=np.int32), colours)
    clean = welded(solid)
    assert len(clean.vertices) == 3 and clean.faces.tolist() == [[0, 1, 2]]
    assert np.array_equal(clean.colours[2], [0.0, 0.0, 1.0])
    assert len(joined([clean, clean]).faces) == 2
    assert joined([clean, clean]).faces.max() == 5
