"""Fitting of any head: it gets the built-in anatomy, and each failure is one clear line."""

import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numpy.linalg import norm
from pytest import approx

from risorius import assets, sim
from risorius.assets import AssetError
from risorius.assets.fitting import FittedHead, fit, fit_head
from risorius.assets.fitting.landmark_file import MisfitError
from risorius.assets.meshes import Mesh
from risorius.assets.topology import boundary_loops
from risorius.bench.gaps import eyeballs_of, lid_gaps
from risorius.geometry.normals import cross_products
from risorius.geometry.sides import side_lengths
from risorius.geometry.transforms import moved_points
from risorius.sim.landmarks import MIRRORED_LANDMARKS
from tests.assets.checks import edge_faces
from tests.heads import UserHead, closed, user_head, with_card
from tests.sim.poses import inverted_triangles, lip_gap, moved_landmarks, settled_displacement


@pytest.fixture(scope="module")
def other() -> UserHead:
    """A head of another shape, in metres, z up."""
    return user_head()


@pytest.fixture(scope="module")
def fitted(other: UserHead) -> FittedHead:
    """The built-in anatomy fitted to that head."""
    return fit(other.mesh, other.landmarks)


@pytest.fixture(scope="module")
def simulation(fitted: FittedHead) -> sim.Simulation:
    """A simulation of the fitted head."""
    return sim.create(fitted)


@pytest.mark.slow
def test_files_are_read_and_fitted(other, fitted, tmp_path):
    """Vertex indices and points as landmarks give the same head; a plain list is accepted."""
    mesh, numbers = other.write(tmp_path)
    by_number = fit_head(mesh, numbers)
    assert np.abs(by_number.vertices - fitted.vertices).max() < 1e-3
    numbers.write_text(json.dumps(other.landmarks.tolist()))
    assert np.array_equal(fit_head(mesh, numbers).landmarks, fitted.landmarks)
    by_point = fit_head(*other.write(tmp_path, points=True))
    assert np.array_equal(by_point.landmarks, fitted.landmarks)


def test_head_comes_to_millimetres_and_the_face_space(fitted):
    """In any unit and axes, fitted landmarks are near those of the built-in head."""
    known = assets.load("head")
    off = fitted.vertices[fitted.landmarks] - known.vertices[known.landmarks]
    assert norm(off, axis=1).mean() < 10.0
    assert fitted.to_millimetres.scale == approx(1000.0, rel=0.1)


def test_eyes_lie_behind_their_lids(fitted):
    """No skin of the lids is inside an eyeball, and some of it touches the ball."""
    for eye, numbers in zip(fitted.eyes, ((37, 38, 40, 41), (43, 44, 46, 47)), strict=True):
        lids = fitted.vertices[fitted.landmarks[list(numbers)]]
        reach = norm(fitted.vertices[:, None] - lids, axis=2).min(axis=1)
        near = np.vstack([lids, fitted.vertices[reach < 5.0]])
        gap = norm(near - eye.centre, axis=1) - eye.radius
        assert 0.0 < gap.min() < 1.0
        assert 9.0 < eye.radius < 15.0


def test_the_built_in_head_fits_itself(head, tmp_path):
    """Fitted to its own landmarks, the built-in head keeps its eyes: lids still close."""
    mesh = tmp_path / "same.ply"
    numbers = tmp_path / "same.json"
    trimesh.Trimesh(head.vertices, head.faces, process=False).export(mesh)
    numbers.write_text(json.dumps(head.landmarks.tolist()))
    same = fit_head(mesh, numbers)
    for eye, own in zip(same.eyes, head.eyes, strict=True):
        assert np.abs(eye.centre - own.centre).max() < 0.2
        assert eye.radius == approx(own.radius, rel=0.01)


def test_the_edge_of_the_neck_fades(fitted):
    """The neck is invisible at its open end, and fully visible at the chin.

    A closed neck does not fade.
    """
    shown = fitted.fade()[:, 0]
    edge = max(boundary_loops(fitted.faces), key=lambda x: -fitted.vertices[x, 1].mean())
    assert shown[edge].max() < 0.05
    assert shown[fitted.landmarks].min() > 1.0
    middle = len(fitted.vertices)
    cap = [(b, a, middle) for a, b in zip(edge, np.roll(edge, -1), strict=True)]
    points = np.vstack([fitted.vertices, fitted.vertices[edge].mean(axis=0)])
    closed = replace(fitted, vertices=points, faces=np.vstack([fitted.faces, cap]))
    assert closed.fade() is None


def test_the_inner_side_of_the_neck_does_not_show(fitted):
    """Inner sides of the neck, and of the forehead seen through it, are hidden.

    Inner sides of lids and lips are visible.
    """
    share, inner = fitted.fade().T
    assert inner[share < 1.0].max() <= 0.0
    highest = fitted.vertices[:, 1] > fitted.vertices[fitted.landmarks[19], 1] + 10.0
    assert inner[highest].max() < 0.0
    assert inner[fitted.landmarks[36:]].min() > 5.0
    # A neck far in front, as of children, does not hide cheeks that show through the mouth.
    vertices = fitted.vertices.copy()
    vertices[share < 1.0, 2] += 50.0
    corner = vertices[fitted.landmarks[48]]
    is_level = np.abs(vertices[:, 1] - corner[1]) < 10.0
    is_cheek = is_level & (vertices[:, 2] > corner[2] - 60.0)
    assert replace(fitted, vertices=vertices).fade()[is_cheek, 1].min() > 0.0


def test_triangles_that_fade_are_drawn_last(fitted, other):
    """Fading triangles are drawn last, so that they are blended over a chin behind them.

    All other triangles keep the order of the file.
    """
    fades = (fitted.fade()[fitted.faces, 0] < 1.0).any(axis=1)
    assert fades.any()
    assert (np.diff(fades.astype(np.int8)) >= 0).all()
    first = fitted.file_vertices[fitted.faces[: (~fades).sum()]]
    of_file = {tuple(face): k for k, face in enumerate(other.mesh.faces.tolist())}
    places = [of_file[tuple(face)] for face in first.tolist()]
    assert places == sorted(places)


def test_teeth_lie_behind_the_skin(fitted):
    """From the front, no tooth is in front of the skin beside it."""
    front = fitted.vertices[fitted.vertices[:, 2] > 40.0]
    for part in fitted.parts:
        if part.name.startswith(("teeth", "gums")):
            away = norm(part.vertices[:, None, :2] - front[None, :, :2], axis=2)
            beside = away.argmin(axis=1)
            is_covered = away.min(axis=1) < 3.0
            assert (part.vertices[:, 2] < front[beside, 2])[is_covered].all(), part.name


def test_teeth_are_apart_in_a_mouth_that_is_open_at_rest():
    """If the mouth is open at rest, teeth are as near to their lips as in the built-in head."""
    known = assets.load("head")
    opening = np.array([0.0, -14.0, 0.0])  # [mm]
    opened = known.vertices + known.mandible_weight[:, None] * opening
    heights = []
    for head in (known, fit(Mesh(opened, known.faces), known.landmarks)):
        rows = {part.name: part.vertices[:, 1] for part in head.parts}
        lips = head.vertices[head.landmarks, 1]
        upper = rows["teeth_upper"].min() - lips[61:64].mean()
        heights.append((upper, rows["teeth_lower"].max() - lips[65:68].mean()))
    assert np.abs(np.subtract(*heights)).max() < 2.0


def test_depth_and_texture_come_from_the_same_place(fitted):
    """A copy of the built-in head gets the built-in values at the same vertices."""
    known = assets.load("head")
    count = len(known.vertices)
    assert np.abs(fitted.bone_depth[:count] - known.bone_depth).mean() < 0.5
    face = known.landmarks[17:]
    assert np.abs(fitted.uv[face] - known.uv[face]).max() < 0.01


def test_texture_runs_evenly_beside_the_mouth(fitted):
    """Beside the mouth, texture slopes of neighbouring triangles are nearly equal.

    Otherwise furrows would break at triangle edges.
    """
    corners = fitted.vertices[fitted.faces]
    uv = fitted.uv.astype(np.float64)[fitted.faces]
    sides = corners[:, 1:] - corners[:, :1]  # (F, 2, 3)
    slopes = np.linalg.pinv(sides) @ (uv[:, 1:] - uv[:, :1])
    mouth = fitted.vertices[fitted.landmarks[[48, 54]]]
    away = norm(corners.mean(axis=1)[:, None] - mouth, axis=2).min(axis=1)
    beside = [pair for pair in edge_faces(fitted.faces).values() if len(pair) == 2]
    pairs = np.array([pair for pair in beside if away[pair].max() < 20.0])
    step = norm(slopes[pairs[:, 0]] - slopes[pairs[:, 1]], axis=(1, 2))
    size = norm(slopes[pairs], axis=(2, 3)).mean(axis=1)
    assert np.percentile(step / size, 80) < 0.31


def test_a_fitted_head_makes_faces(fitted, simulation):
    """A fitted head smiles, blinks and opens its jaw; at rest its lips stay closed."""
    smile = settled_displacement(simulation, {"AU12": 1.0})
    assert moved_landmarks(fitted, smile, 54)[1] > 4.0
    assert lip_gap(simulation, fitted) < 0.8
    settled_displacement(simulation, {"AU43": 1.0})
    landmarks = simulation.positions[fitted.landmarks]
    eyeballs = eyeballs_of(fitted, simulation)
    gaps = lid_gaps(simulation.positions, simulation.faces, landmarks, eyeballs)
    assert max(gaps.values()) < 0.8
    settled_displacement(simulation, {"AU27": 1.0})
    assert lip_gap(simulation, fitted) > 20.0


def test_the_chin_moves_stiffly_with_the_jaw(fitted, simulation):
    """An open jaw moves the tip of the chin by 90 % of the bone's motion."""
    chin = fitted.vertices[fitted.landmarks[8]]
    displacement = settled_displacement(simulation, {"jaw_open": 1.0})
    jaw = simulation.bones.transforms()["mandible"]
    way = moved_points(jaw, chin) - chin
    moved = displacement[fitted.landmarks[8]]
    assert moved @ way / (way @ way) > 0.88


def test_the_neck_of_a_fitted_head_does_not_tear(fitted, simulation):
    """With an open jaw, no edge of the neck's skin doubles its length."""
    settled_displacement(simulation, {"jaw_open": 1.0})
    edges = np.array(list(edge_faces(fitted.faces)))
    rest = fitted.vertices
    away = norm(rest[edges].mean(axis=1) - rest[fitted.landmarks[8]], axis=1)
    is_below = rest[edges, 1].max(axis=1) < rest[fitted.landmarks[8], 1] + 10.0
    edges = edges[is_below & (away < 90.0)]
    growth = side_lengths(simulation.positions, edges) / side_lengths(rest, edges)
    assert growth.max() < 2.0


def test_the_tongue_of_a_fitted_head_comes_out(fitted, simulation):
    """The tongue of a fitted head comes out and rests on the lower lip."""
    settled_displacement(simulation, {"jaw_open": 0.4, "tongue_out": 1.0})
    bent = simulation.anatomy.tongue()
    jaw = simulation.bones.transforms()["mandible"]
    assert bent is not None
    reach = moved_points(jaw, bent)[:, 2].max()
    assert 4.0 < reach - simulation.positions[fitted.landmarks[66], 2] < 20.0


@pytest.mark.parametrize("name", ["joy", "sadness", "surprise", "anger", "disgust", "fear"])
def test_expressions_keep_a_fitted_mesh_sound(fitted, simulation, name):
    """In expressions, almost none of eight thousand triangles is turned over."""
    settled_displacement(simulation, {name: 1.0})
    assert inverted_triangles(fitted.faces, fitted.vertices, simulation.positions) <= 40


@pytest.mark.slow
def test_other_pieces_and_inside_out_meshes_do_no_harm(other):
    """Eyeballs of the file are left out, and a mesh with inward triangles is reversed."""
    vertices = other.mesh.vertices
    faces = other.mesh.faces
    ball = vertices[:3] + 0.01
    mesh = Mesh(
        np.vstack([ball, vertices]), np.vstack([[[0, 1, 2]], faces[:, ::-1] + 3]).astype(np.int32)
    )
    head = fit(mesh, (other.landmarks + 3).astype(np.int32))
    assert np.array_equal(head.file_vertices, np.arange(3, len(vertices) + 3))
    assert np.array_equal(np.sort(head.faces, axis=None), np.sort(faces, axis=None))
    is_front = (head.vertices[head.faces, 2] > 60.0).all(axis=1)
    assert cross_products(head.vertices, head.faces)[is_front, 2].sum() > 0.0


def _numbers(other, **places):
    numbers = other.landmarks.tolist()
    for place, number in places.items():
        numbers[int(place[1:])] = number
    return numbers


@pytest.mark.parametrize(("off", "is_allowed"), [(0.04, True), (0.07, False)])
def test_points_lie_on_the_mesh(other, tmp_path, off, is_allowed):
    """A landmark point may be off the mesh by a twentieth of the eyes' distance.

    A point farther away is reported by number.
    """
    mesh, file = other.write(tmp_path)
    points = other.mesh.vertices[other.landmarks]
    tip = points[30]
    outward = tip - points[[1, 15]].mean(axis=0)
    outward /= norm(outward)
    points[30] = tip + off * norm(points[36] - points[45]) * outward
    file.write_text(json.dumps(points.tolist()))
    if is_allowed:
        fit_head(mesh, file)
        return
    advice = (
        r"landmark 30 lies .* units off the mesh; allowed are .* has no skin there; mark 30 anew"
    )
    with pytest.raises(MisfitError, match=advice):
        fit_head(mesh, file)


def test_points_in_another_unit_are_refused(other, tmp_path):
    """Where most points lie off the mesh, the advice is about unit and axes of the mesh."""
    mesh, file = other.write(tmp_path)
    file.write_text(json.dumps((1000.0 * other.mesh.vertices[other.landmarks]).tolist()))
    with pytest.raises(AssetError, match=r"off the mesh; .*: give unit and axes of the mesh"):
        fit_head(mesh, file)


def test_swapped_sides_are_noticed(other):
    """Landmarks with left and right swapped, the most common mistake, are refused."""
    with pytest.raises(AssetError, match="left and right are swapped in the landmarks"):
        fit(other.mesh, other.landmarks[MIRRORED_LANDMARKS])
    mirrored = Mesh(other.mesh.vertices * (-1.0, 1.0, 1.0), other.mesh.faces[:, ::-1])
    with pytest.raises(AssetError, match="or the mesh is mirrored"):
        fit(mirrored, other.landmarks)


@pytest.mark.parametrize(
    ("landmarks", "message"),
    [
        (
            (61, 62, 63, 65, 66, 67),
            r"the mouth is shut: skin joins landmarks 62 and 66 over \d+ mm",
        ),
        ((37, 38, 40, 41), r"the right eye has no opening: skin lies between landmarks 37 and 41"),
        ((43, 44, 46, 47), r"the left eye has no opening: skin lies between landmarks 43 and 47"),
    ],
)
def test_closed_openings_are_named(other, landmarks, message):
    """Joined lips or lids, which cannot part, are refused by name."""
    mesh = closed(other.mesh, other.landmarks[list(landmarks)])
    with pytest.raises(AssetError, match=message):
        fit(mesh, other.landmarks)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: np.vstack([f, f[:1]]), "not manifold: 3 triangles meet|not oriented"),
        (lambda f: np.vstack([f[:1, ::-1], f[1:]]), "not oriented: both triangles at the edge"),
        (lambda f: f[:100], "the head has 100 triangles; allowed are 300 to 250000: sub"),
        (lambda f: np.tile(f, (32, 1)), "the head has 259840 triangles; .*: reduce it"),
    ],
)
def test_meshes_that_are_no_surface_are_named(other, change, message):
    """Doubled triangles, flipped triangles, too few and too many triangles are reported."""
    faces = np.ascontiguousarray(change(other.mesh.faces))
    with pytest.raises(AssetError, match=message):
        fit(Mesh(other.mesh.vertices, faces), other.landmarks)


def test_pieces_that_are_left_out_may_be_anything(other):
    """Pieces that are left out need not be valid surfaces; the skin keeps its vertex indices."""
    mesh = with_card(other.mesh)
    head = fit(mesh, other.landmarks)
    assert np.array_equal(head.file_vertices, np.arange(len(other.mesh.vertices)))


def test_triangles_that_name_a_vertex_twice_are_left_away(other, fitted):
    """Triangles that name a vertex twice, as from decimation, are left out.

    The skin is the same without them.
    """
    vertices = other.mesh.vertices
    faces = other.mesh.faces
    alone = len(vertices)  # a vertex with no other triangle
    flat = np.array([[5, 6, 5], [7, 7, 7], [9, alone, alone]], np.int32)
    with_flat = np.vstack([faces[:9], flat, faces[9:]])
    with_alone = np.vstack([vertices, vertices[9:10]])
    head = fit(Mesh(with_alone, with_flat), other.landmarks)
    assert np.array_equal(head.faces, fitted.faces)
    assert np.array_equal(head.file_vertices, np.arange(len(vertices)))


def test_landmarks_on_two_pieces_are_named(other):
    """A landmark on another piece, such as an eyeball, is refused."""
    count = len(other.mesh.vertices)
    mesh = Mesh(
        np.vstack([other.mesh.vertices, other.mesh.vertices[:3]]),
        np.vstack([other.mesh.faces, [[count, count + 1, count + 2]]]).astype(np.int32),
    )
    numbers = np.array(_numbers(other, _45=count), dtype=np.int32)
    with pytest.raises(AssetError, match="landmark 45 lies on another piece of the mesh"):
        fit(mesh, numbers)
