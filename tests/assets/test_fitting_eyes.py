"""The eyes of users' heads: no line of sight passes the eyeball into the empty head."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.linalg import norm
from pytest import approx
from scipy.spatial import cKDTree

from risorius import assets, sim
from risorius.assets.fitting import FittedHead, fit, fit_head
from risorius.assets.fitting.eyeballs import is_eyeball, sphere_of
from risorius.assets.fitting.mouth_walls import FittedSkin, opened_jaws
from risorius.assets.fitting.organs import RIM_ROWS, place_eyes, place_parts, with_eyelid_rims
from risorius.assets.fitting.warp import ThinPlateSpline
from risorius.assets.meshes import Mesh
from risorius.assets.topology import boundary_loops
from risorius.bench.subjects import decimated
from risorius.geometry.directions import unit_vectors
from risorius.geometry.normals import cross_products, points_on_triangles, vertex_normals
from tests.assets.checks import check_part, part_of
from tests.heads import UserHead, shape
from tests.meshes import ball, flat_cross
from tests.sim.poses import advance

EYE_DISTANCE = 25.0  # [mm] around an eye, for the eye's parts
SIDES = 3  # samples along each edge of the rim
RINGS = 30  # samples from the middle to the rim


@pytest.fixture(scope="module")
def fitted() -> FittedHead:
    """A head whose lids end at the eyeball, as in scans."""
    head = assets.load("head")
    deepest = np.concatenate([head.rings["eye_0_left"], head.rings["eye_0_right"]])
    faces = head.faces[~np.isin(head.faces, deepest).any(axis=1)]
    return fit(Mesh(shape(head.vertices), faces), head.landmarks)


def _across(edge):
    """Places (m, 2) of lines of sight along z through a hole with this edge (n, 3)."""
    middle = edge.mean(axis=0)
    first, second = (each - middle for each in (edge, np.roll(edge, 1, axis=0)))
    enters = flat_cross(first, second) > 0.0  # faces the viewer
    share = np.linspace(0.0, 1.0, SIDES, endpoint=False)[:, None, None]
    toward = np.linspace(0.0, 0.99, RINGS)[:, None, None]
    rim = ((1.0 - share) * first[enters] + share * second[enters]).reshape(-1, 3)
    return (middle + toward * rim).reshape(-1, 3)[:, :2]


def _meets(points, triangles):
    """Flags (n,) of lines along z that meet one of the triangles (m, 3, 3) facing the viewer."""
    a, b, c = (triangles[:, corner, :2] for corner in range(3))
    u = b - a
    v = c - a
    area = flat_cross(u, v)
    a, u, v, area = (each[area > 0.0] for each in (a, u, v, area))
    to = points[:, None] - a
    of_b = flat_cross(to, v) / area
    of_c = flat_cross(u, to) / area
    return ((of_b >= -1e-6) & (of_c >= -1e-6) & (of_b + of_c <= 1.0 + 1e-6)).any(axis=1)


def test_a_wide_opening_has_a_rim(fitted):
    """An opening whose corner lies 1.9 radii from the eyeball gets a rim, not a hole."""
    eye = fitted.eyes[0]
    loops = boundary_loops(fitted.faces)
    loop = min(loops, key=lambda loop: norm(fitted.vertices[loop] - eye.centre, axis=1).max())
    corner = loop[np.abs(fitted.vertices[loop, 0]).argmax()]
    wide = fitted.vertices + 0.0
    wide[corner] = eye.centre + 1.9 * eye.radius * unit_vectors(wide[corner] - eye.centre)
    parts = with_eyelid_rims(assets.load("head").parts, wide, fitted.faces, fitted.eyes)
    flesh = next(part for part in parts if part.name == "eye_corners")
    edge = flesh.vertices[norm(flesh.vertices - wide[corner], axis=1) < 1.0]
    assert len(edge)


@pytest.mark.parametrize(("gap", "has_lumps"), [(0.0, True), (2.5, False)])
def test_flesh_that_no_lid_covers_is_left_out(fitted, gap, has_lumps):
    """Where lids end 2.5 mm before the ball, the flesh in the corners would be two pink lumps."""
    own = assets.load("head").parts
    eyes = [replace(eye, radius=eye.radius - gap) for eye in fitted.eyes]
    parts = with_eyelid_rims(own, fitted.vertices, fitted.faces, eyes)
    flesh = next(part for part in parts if part.name == "eye_corners")
    lumps = next(part for part in own if part.name == "eye_corners")
    rims = 0
    loops = boundary_loops(fitted.faces)
    for eye in eyes:
        edge = min(loops, key=lambda loop: norm(fitted.vertices[loop] - eye.centre, axis=1).max())
        rims += 2 * (RIM_ROWS - 1) * len(edge)
    assert len(flesh.faces) == rims + has_lumps * len(lumps.faces)


@pytest.mark.parametrize("yaw", [-50.0, -40.0, -25.0, 0.0, 25.0, 40.0, 50.0])
def test_nothing_is_seen_behind_an_eye(fitted, yaw):
    """Every line of sight between the lids ends on the eyeball, or on flesh."""
    across = np.cos(np.radians(yaw))
    ahead = np.sin(np.radians(yaw))
    view = np.array([[across, 0.0, ahead], [0.0, 1.0, 0.0], [-ahead, 0.0, across]])
    parts = np.concatenate([part.vertices.astype(np.float64)[part.faces] for part in fitted.parts])
    loops = [fitted.vertices[loop] for loop in boundary_loops(fitted.faces)]
    for eye in fitted.eyes:
        edge = min(loops, key=lambda loop: norm(loop - eye.centre, axis=1).max())
        near = parts[norm(parts.mean(axis=1) - eye.centre, axis=1) < EYE_DISTANCE]
        assert _meets(_across(edge @ view.T), near @ view.T).all()


def test_the_flesh_of_the_eyes_is_well_formed(fitted):
    """The flesh at the eyes is a valid part that reaches behind each eyeball."""
    flesh = part_of(fitted, "eye_corners")
    check_part(flesh)
    for eye in fitted.eyes:
        to = flesh.vertices - eye.centre
        is_behind = (to[:, 2] < -2.0) & (norm(to, axis=1) < eye.radius)
        assert is_behind.sum() >= 20


def skin_of(head):
    """The skin of a head, as it is fitted to a mesh."""
    normals = vertex_normals(head.vertices, head.faces)
    landmarks = head.vertices[head.landmarks]
    return FittedSkin(head.vertices, normals, head.faces, landmarks, head.mandible_weight)


def with_points(skin, points, normals):
    """The skin with more points (n, 3), which belong to no triangle, and their normals."""
    return replace(
        skin,
        vertices=np.vstack([skin.vertices, points]),
        normals=np.vstack([skin.normals, normals]),
    )


def test_the_wall_of_a_socket_moves_no_eye():
    """The wall of a socket narrower than its eyeball is not a lid, and does not push the ball."""
    head = assets.load("head")
    skin = skin_of(head)
    narrow = skin
    for eye in head.eyes:
        outward = unit_vectors(head.vertices[head.rings[f"eye_2_{eye.name}"]] - eye.centre)
        wall = eye.centre + (eye.radius - 2.0) * outward
        narrow = with_points(narrow, wall, -outward)
    for eye, other in zip(place_eyes(head, skin), place_eyes(head, narrow), strict=True):
        assert norm(eye.centre - other.centre) < 0.1
        assert abs(eye.radius - other.radius) < 0.1


def test_eyeballs_lie_behind_flat_triangles_of_lids(tmp_path):
    """No point on the outer sides of lids of 1 600 triangles is deeper than 2.5 mm in an eyeball.

    The deepest was 3.2 mm deep, because only vertices counted.
    """
    head = assets.load("head")
    points, faces = decimated(head.vertices, head.faces, 1600)
    numbers = cKDTree(points).query(head.vertices[head.landmarks])[1]
    fitted = fit_head(*UserHead(Mesh(points, faces), numbers).write(tmp_path))
    corners = fitted.vertices[fitted.faces]
    crosses = cross_products(fitted.vertices, fitted.faces)
    for eye in fitted.eyes:
        away = corners - eye.centre
        is_lid = (norm(away, axis=2) < eye.radius + 8.0).all(axis=1)
        is_lid &= (away[:, :, 2] > 6.0).all(axis=1)
        is_lid &= (crosses * away.mean(axis=1)).sum(axis=1) > 0.0
        lids = points_on_triangles(fitted.vertices, fitted.faces[is_lid])
        assert (eye.radius - norm(lids - eye.centre, axis=1)).max() < 2.5


def test_eyeballs_lie_behind_triangles_from_lid_to_brow():
    """On a head of 500 triangles, no skin near the landmarks of an eye lies in the eyeball.

    It was 1.7 mm deep, because triangles with a corner at the brow did not count as lids.
    """
    head = assets.load("head")
    points, faces = decimated(head.vertices, head.faces, 500)
    landmarks = head.vertices[head.landmarks]
    normals = vertex_normals(points, faces)
    skin = FittedSkin(points, normals, faces, landmarks, np.zeros(len(points)), ())
    crosses = cross_products(points, faces)
    for eye in place_eyes(head, skin):
        away = points[faces].mean(axis=1) - eye.centre
        is_outer = (crosses * away).sum(axis=1) > 0.0
        lids = points_on_triangles(points, faces[is_outer])
        around = slice(36, 42) if eye.name == "right" else slice(42, 48)
        is_near = cKDTree(landmarks[around]).query(lids)[0] < 5.0
        assert norm(lids[is_near] - eye.centre, axis=1).min() > eye.radius - 1e-6


def _ball(centre, radius):
    """Vertices and triangles of a sphere."""
    unit = ball(2)
    return centre + radius * unit.vertices, unit.faces


@pytest.mark.parametrize(
    ("radius", "back"), [pytest.param(14.1, 1.5, marks=pytest.mark.slow), (18.0, 5.4)]
)
def test_eyeballs_of_the_file_set_place_and_size(radius, back):
    """Eyes get the centre and size of the file's eyeballs, also of balls half as large again.

    Irises keep the face's size.
    """
    head = assets.load("head")
    vertices = shape(head.vertices)
    faces = head.faces
    moved = shape(np.array([eye.centre for eye in head.eyes]))
    moved += (0.0, 0.3, -back)
    for centre in moved:
        points, triangles = _ball(centre, radius)
        faces = np.concatenate([faces, triangles + len(vertices)])
        vertices = np.concatenate([vertices, points])
    found = fit(Mesh(vertices, faces.astype(np.int32)), head.landmarks)
    for eye, old, centre in zip(found.eyes, head.eyes, moved, strict=True):
        wanted = found.to_millimetres.points(centre[None])[0]
        assert norm(eye.centre - wanted) < 0.3
        assert eye.radius == approx(radius * found.to_millimetres.scale, abs=0.3)
        assert eye.iris_radius == approx(old.iris_radius, rel=0.1)
        part = next(part for part in found.parts if part.bone == f"eye_{eye.name}")
        check_part(part)


def test_a_ball_of_the_file_does_not_pierce_a_corner_of_the_lids():
    """A ball that reaches half a millimetre out of a corner of its eye shrinks."""
    head = assets.load("head")
    points = head.vertices[head.landmarks]
    corners = [points[36:42], points[42:48]]
    nearest = [
        norm(lids - eye.centre, axis=1).min() for lids, eye in zip(corners, head.eyes, strict=True)
    ]
    own = tuple(
        _ball(eye.centre, reach + 0.5)[0] for eye, reach in zip(head.eyes, nearest, strict=True)
    )
    eyes = place_eyes(head, replace(skin_of(head), pieces=own))
    for eye, lids in zip(eyes, corners, strict=True):
        reach = norm(lids - eye.centre, axis=1).min()
        assert reach - 0.5 < eye.radius < reach


def test_an_iris_is_smaller_than_its_ball():
    """An eyeball that is small for its face still leaves visible corners."""
    head = assets.load("head")
    points = head.vertices[head.landmarks]
    own = tuple(_ball(eye.centre, 0.65 * eye.radius)[0] for eye in head.eyes)
    skin = replace(skin_of(head), pieces=own)
    wide = tuple(replace(eye, iris_radius=0.9 * eye.radius) for eye in head.eyes)
    known = replace(head, eyes=wide)
    warp = ThinPlateSpline(points, points)
    eyes = place_eyes(known, skin)
    for eye, old in zip(eyes, head.eyes, strict=True):
        assert eye.radius == approx(0.65 * old.radius, rel=0.02)
        assert eye.iris_radius == approx(0.8 * eye.radius)
    for part in place_parts(known, skin, warp, eyes, opened_jaws(head.jaw_axis, head.rig)):
        assert np.isfinite(part.vertices).all()


def test_a_closed_socket_is_the_shell_of_its_ball():
    """A closed socket's skin gives the size of the eyeball, which touches the lids from behind."""
    head = assets.load("head")
    points = head.vertices[head.landmarks]
    unit = ball(3).vertices
    unit = unit[unit[:, 2] < 0.5]
    skin = skin_of(head)
    for eye in head.eyes:
        shell = eye.centre + [0.0, 0.0, -3.0] + 15.5 * unit
        skin = with_points(skin, shell, -unit)
    for eye, new in zip(head.eyes, place_eyes(head, skin), strict=True):
        assert 14.8 < new.radius < 15.5
        assert norm((new.centre - eye.centre)[:2]) < 0.3
        assert norm(points[36:48] - new.centre, axis=1).min() > new.radius
        assert new.iris_radius == approx(eye.iris_radius, rel=0.05)


def test_a_closed_socket_has_no_other_flesh(fitted):
    """A closed socket gets no built-in flesh, which would stick out of its own skin."""
    far = np.array([[0.0, 500.0, 0.0], [1.0, 500.0, 0.0], [0.0, 501.0, 0.0]])
    triangle = np.array([[0, 1, 2]], np.int32)
    head = assets.load("head")
    parts = with_eyelid_rims(head.parts, far, triangle, head.eyes)
    assert {part.name for part in head.parts} - {part.name for part in parts} == {"eye_corners"}
    assert "eye_corners" in {part.name for part in fitted.parts}


@pytest.fixture(scope="module")
def sleeper() -> FittedHead:
    """A head whose lids touch at rest: the built-in one at the end of a blink."""
    head = assets.load("head")
    simulation = sim.create(head)
    simulation.controls.set("blink", 1.0)
    advance(simulation, 60)
    return fit(Mesh(shape(simulation.positions), head.faces), head.landmarks)


def test_shut_eyes_are_accepted_and_reported(sleeper):
    """A head with shut eyes is accepted, and a note reports the eyes.

    It was refused before: "the right eye has no opening".
    """
    (note,) = [each for each in sleeper.notes if "shut" in each]
    assert "right and left eyes are shut at rest" in note


@pytest.mark.parametrize("name", ["eyeBlink", "eyeWide", "eyeLookUp", "eyeLookDown"])
def test_lids_of_shut_eyes_hardly_move(sleeper, name):
    """No lid moves by more than 2 mm, and skin lies before the eyeballs."""
    simulation = sim.create(sleeper)
    before = simulation.positions.copy()
    for side in ("Left", "Right"):
        simulation.controls.set(f"{name}{side}", 1.0)
    advance(simulation, 60)
    assert norm(simulation.positions - before, axis=1).max() < 2.0
    for eye in sleeper.eyes:
        grid = eye.radius * np.linspace(-0.7, 0.7, 15)
        places = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2) + eye.centre[:2]
        skin = simulation.positions[sleeper.faces]
        assert _meets(places, skin[(skin[:, :, 2] > eye.centre[2]).all(axis=1)]).all()


def test_a_much_larger_whole_ball_is_an_eyeball():
    """An infant's eyeball has 1.8 times the radius that its lids suggest, and was taken for a lash.

    Half of such a ball is none, because hoods and helmets are as round.
    """
    points = 23.9 * ball(3).vertices + (33.9, -0.4, 60.6)
    guess = np.array([36.1, 1.3, 71.9])
    assert is_eyeball(points, guess, 13.29)
    assert sphere_of(points, guess, 13.29)[1] == approx(23.9, abs=0.01)
    front = points[points[:, 2] > 60.0]
    assert not is_eyeball(front, guess, 13.29)


def test_a_ball_is_found_where_it_is():
    """Half a ball is enough to find it; other parts do not change the result."""
    points = 12.0 * ball(3).vertices + (30.0, 1.0, 70.0)
    front = points[points[:, 2] > 68.0]
    centre, radius = sphere_of(front, np.array([31.0, 0.0, 72.0]), 11.0)
    assert np.allclose(centre, (30.0, 1.0, 70.0), atol=0.01)
    assert radius == approx(12.0, abs=0.01)
    guess = np.array([31.0, 0.0, 72.0])
    assert sphere_of(front * (1.0, 1.0, 0.0), guess, 11.0)[1] == 11.0
