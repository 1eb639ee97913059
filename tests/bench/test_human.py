"""The measure of human form: heads of its model space have no error, other heads have one."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from risorius import assets
from risorius.app.errors import UserError
from risorius.bench.human import (
    MOST_DISTANCES,
    HeadMesh,
    IdentitySpace,
    Remainder,
    report,
    targets,
    unexplained,
)
from risorius.geometry.normals import vertex_normals

WEIGHTS = np.array([1.5, -0.8])
HEAD_TURN = 0.03  # [radians]


@pytest.fixture(scope="module")
def space() -> IdentitySpace:
    """A model space around the built-in head, with two smooth modes, one of them asymmetric."""
    head = assets.load("head")
    x, y, z = head.vertices.T
    modes = np.zeros((2, len(x), 3))
    wide, long = modes
    wide[:, 0] = 4.0 * np.sin(x / 40.0)
    wide[:, 2] = 2.0 * np.cos(y / 35.0)
    long[:, 1] = 4.0 * np.sin(y / 50.0)
    long[:, 2] = 2.0 * np.sin(x / 30.0 + z / 60.0)
    return IdentitySpace(head.vertices, head.faces, head.landmarks, modes)


def rest_of(space, vertices):
    """The residual outside the model space for a head that is turned and moved."""
    turn = Rotation.from_euler("y", HEAD_TURN)
    moved = turn.apply(vertices) + np.array([3.0, -2.0, 4.0])
    normals = vertex_normals(moved, space.triangles)
    surface = HeadMesh(moved, space.triangles, normals, moved[space.landmarks])
    return unexplained(space, space.regions(), surface)


def test_a_person_of_the_space_is_explained(space):
    """For a turned and moved head of the space, the weights are recovered and the residual is 0."""
    rest = rest_of(space, space.person(WEIGHTS))
    assert rest.weights == pytest.approx(WEIGHTS, abs=0.06)
    assert rest.distances["all"] < 0.05
    assert rest.angles["all"] < 0.5
    assert all(target.is_met for target in targets({"coarse": rest, "finer": rest}))


def test_a_bump_that_nobody_has_is_reported_where_it_is(space):
    """A bump of 4 mm on the chin stays in the residual of the chin, and is printed.

    Other regions have hardly any residual.
    """
    vertices = space.person(WEIGHTS)
    chin = vertices[space.landmarks[8]]
    away = np.linalg.norm(vertices - chin, axis=1)
    height = 4.0 * np.exp(-((away / 15.0) ** 2))
    vertices = vertices + height[:, None] * vertex_normals(vertices, space.triangles)
    rest = rest_of(space, vertices)
    others = [value for name, value in rest.distances.items() if name not in ("chin", "all")]
    assert rest.distances["chin"] > 1.0
    assert rest.distances["chin"] > 3.0 * max(others)
    text = report({"coarse": rest, "finer": rest})
    assert f"{rest.distances['chin']:.2f}" in text.split("chin")[1].splitlines()[0]


def test_what_is_left_is_held_to_targets():
    """A residual above its target and a missing number both miss the target."""
    names = ("all", "nose", "mouth")
    good = Remainder(np.ones(2), dict.fromkeys(names, 0.3), {"all": 3.0})
    bad = Remainder(np.ones(2), {**good.distances, "nose": float("nan")}, {"all": 6.0})
    missed = [each.text for each in targets({"coarse": good, "finer": bad}) if not each.is_met]
    assert len(missed) == 2
    assert "nose" in missed[0]
    assert "angle" in missed[1]
    assert len(targets({"coarse": good, "finer": good})) == len(MOST_DISTANCES) + 2


def test_inner_sides_of_lips_are_no_region(space):
    """The inner sides of lips are left out; the skin of cheeks and forehead is included."""
    regions = space.regions()
    marks = space.landmarks
    assert (regions[marks[[62, 66]]] == "").all()
    assert (regions[marks[[31, 8, 19, 24]]] != "").all()


def test_a_folder_without_modes_is_reported(head, tmp_path):
    """The error names a file that is missing, or has another number of vertices."""
    np.savez(
        tmp_path / "face.npz",
        vertices=head.vertices,
        triangles=head.faces,
        landmarks68=head.landmarks,
    )
    with pytest.raises(UserError, match=r"identity_modes\.npz: is not there"):
        IdentitySpace.read(tmp_path)
    np.savez(tmp_path / "identity_modes.npz", modes=np.zeros((2, 5, 3)))
    with pytest.raises(UserError, match=r"'modes' must move each vertex of face\.npz"):
        IdentitySpace.read(tmp_path)
