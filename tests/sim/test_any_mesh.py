"""Simulations can be built from any triangle mesh, with any of its optional attributes."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from risorius import sim
from tests.meshes import open_grid
from tests.sim.poses import (
    FRAME_TIME,
    advance,
    both_sides,
    moved_landmarks,
    settled_displacement,
    without,
)


def _grid():
    """A flat open grid."""
    grid = open_grid(7, 5)
    return SimpleNamespace(vertices=grid.vertices, faces=grid.faces)


def _with_flaws():
    """A mesh with a degenerate triangle, an unused vertex, two pieces, and doubled vertices."""
    vertices = [
        [0, 0, 0],
        [1, 0, 0],
        [0, 1, 0],
        [9, 9, 9],
        [5, 5, 0],
        [6, 5, 0],
        [5, 6, 0],
        [5, 6, 0],
    ]
    faces = [[0, 1, 2], [0, 1, 1], [4, 5, 6], [4, 5, 7]]
    return SimpleNamespace(vertices=np.array(vertices, dtype=float), faces=np.array(faces))


@pytest.mark.parametrize(
    "mesh",
    [
        _grid(),
        _with_flaws(),
        trimesh.creation.icosphere(subdivisions=2, radius=0.03),
        trimesh.creation.icosphere(subdivisions=2, radius=4000.0),
        SimpleNamespace(vertices=np.eye(3), faces=np.array([[0, 1, 2]])),
    ],
    ids=["grid", "flaws", "small trimesh", "big trimesh", "one triangle"],
)
def test_any_mesh_is_stable_and_comes_back(mesh, generator):
    """After a hard kick, a mesh of any size swings and returns to rest, without controls."""
    simulation = sim.create(mesh)
    assert simulation.controls.lowest == ()
    size = float(np.ptp(simulation.rest_positions, axis=0).max())
    simulation.touch.kick(generator.normal(scale=2.0 * size, size=simulation.positions.shape))
    simulation.step(1 / 20)
    assert 1e-4 * size < np.abs(simulation.positions - simulation.rest_positions).max() < 2.0 * size
    advance(simulation, 120)
    assert np.abs(simulation.positions - simulation.rest_positions).max() < 1e-4 * size


def test_input_arrays_are_copied(head):
    """The simulation neither writes into the caller's arrays nor sees later changes of them."""
    mesh = _grid()
    before = mesh.vertices.copy()
    simulation = sim.create(mesh)
    simulation.touch.kick(np.ones_like(before))
    simulation.step(FRAME_TIME)
    assert np.array_equal(mesh.vertices, before)
    mesh.vertices[:] = 7.0
    assert np.array_equal(simulation.rest_positions, before)


def test_mesh_with_landmarks_but_no_rig_has_no_muscles(head):
    """Landmarks alone give gaze and head pose; weights add jaw and lips, a rig adds muscles."""
    simulation = sim.create(without(head, "rig"))
    assert set(simulation.controls.groups) == {"Lips", "Jaw", "Gaze", "Head", "Both sides"}
    assert moved_landmarks(head, settled_displacement(simulation, {"jaw_open": 1.0}), 8)[1] < -15.0


def test_mesh_with_rig_but_no_landmarks_has_no_muscles(head):
    """Without landmarks a rig has no muscles, but its tissue still holds the skin."""
    simulation = sim.create(without(head, "landmarks", "eyes", "jaw_axis"))
    assert simulation.controls.lowest == ()
    simulation.step(FRAME_TIME)


def test_everything_can_be_guessed_from_landmarks(head):
    """A head whose eyes, jaw axis and mandible weight are guessed smiles and blinks."""
    simulation = sim.create(without(head, "eyes", "jaw_axis", "mandible_weight"))
    moved = settled_displacement(simulation, {"jaw_open": 1.0})
    assert moved_landmarks(head, moved, 66)[1] - moved_landmarks(head, moved, 62)[1] < -20.0
    blink = both_sides(simulation, {"orbicularis_oculi_palpebral_upper": 1.0})
    assert moved_landmarks(head, settled_displacement(simulation, blink), 37, 38, 43, 44)[1] < -5.0
    smile = settled_displacement(simulation, both_sides(simulation, {"zygomaticus_major": 1.0}))
    assert moved_landmarks(head, smile, 54)[1] > 4.0


def test_a_guessed_jaw_opens_back_rather_than_down(head):
    """With guessed condyles near the ears, the chin moves as far back as down when it opens.

    Scans and sculptures do the same.
    """
    simulation = sim.create(without(head, "jaw_axis", "mandible_weight"))
    moved = settled_displacement(simulation, {"jaw_open": 1.0})
    _, up, forward = moved_landmarks(head, moved, 8)
    assert -33.0 < up < -25.0
    assert abs(up / forward) < 1.1
    assert moved_landmarks(head, moved, 66)[1] > -41.0
