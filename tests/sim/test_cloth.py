"""The cloth: it falls, loses energy, stays out of the ball, and keeps the symmetry it has."""

from types import SimpleNamespace

import numpy as np
import numpy.typing as npt
import pytest

from risorius import assets, sim
from risorius.assets.model import Cloth

FRAME = 1.0 / 60.0
FALL = 240  # frames until it hangs still
FREELY = 0.0


@pytest.fixture(scope="module")
def mesh() -> Cloth:
    """The built-in cloth."""
    return assets.load("cloth")


def _over_ball(mesh: Cloth, faces: npt.NDArray[np.int32] | None = None) -> sim.Cloth:
    """The built-in sheet, with triangles of its own where they are given."""
    sheet = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces if faces is None else faces)
    return sim.Cloth(sheet, np.zeros(3), mesh.radius)


def _mirrored_faces(mesh: Cloth) -> npt.NDArray[np.int32]:
    """The same cells; left, right, front and back quarters are halved as mirror images."""
    cells = round(np.sqrt(len(mesh.faces) / 2))
    faces = mesh.faces.reshape(cells, cells, 2, 3).copy()
    row, column = np.indices((cells, cells)) < cells // 2
    turned = row ^ column
    (a, b, c), (_, _, d) = faces[turned].transpose(1, 2, 0)
    faces[turned] = np.stack([np.stack([a, b, d], -1), np.stack([b, c, d], -1)], axis=1)
    return faces.reshape(-1, 3)


def _strains(cloth: sim.Cloth) -> npt.NDArray[np.float64]:
    """How much longer each edge is than at rest, in parts."""
    sides = np.vstack([cloth.faces[:, [0, 1]], cloth.faces[:, [1, 2]], cloth.faces[:, [2, 0]]])
    now, rest = (
        np.linalg.norm(x[sides[:, 1]] - x[sides[:, 0]], axis=1)
        for x in (cloth.positions, cloth.rest_positions)
    )
    return np.asarray(now / rest - 1.0)


def test_held_cloth_lies_still(mesh: Cloth) -> None:
    """Hands bear its weight: two seconds move nothing."""
    cloth = _over_ball(mesh)
    for _ in range(120):
        cloth.step(FRAME)
    assert np.abs(cloth.positions - cloth.rest_positions).max() < 1e-9


def test_a_falling_cloth_loses_energy_and_stays_out_of_the_ball(mesh: Cloth) -> None:
    """In every frame; in the end it hangs nearly still, and is hardly longer than at rest."""
    cloth = _over_ball(mesh)
    cloth.held = FREELY
    cloth.step(FRAME)
    energies, nearest = [cloth.energy()], []
    for _ in range(FALL):
        before = cloth.positions.copy()
        cloth.step(FRAME)
        energies.append(cloth.energy())
        nearest.append(np.linalg.norm(cloth.positions, axis=1).min())
    assert (np.diff(energies) <= 0.0).all()
    assert min(nearest) > mesh.radius
    assert np.abs(cloth.positions - before).max() < 1.0
    assert cloth.positions[:, 1].min() < -mesh.radius
    assert np.quantile(_strains(cloth), 0.95) < 0.08


@pytest.mark.parametrize("is_mirrored", [False, True], ids=["turned", "mirrored"])
def test_symmetric_in_symmetric_out(mesh: Cloth, is_mirrored: bool) -> None:
    """Cells halved alike look the same after half a turn; mirrored ones in both mirrors, too."""
    cloth = _over_ball(mesh, _mirrored_faces(mesh) if is_mirrored else None)
    cloth.held = FREELY
    for _ in range(FALL):
        cloth.step(FRAME)
    side = round(np.sqrt(len(mesh.vertices)))
    x = cloth.positions.reshape(side, side, 3)
    assert np.abs(x - x[::-1, ::-1] * [-1, 1, -1]).max() < 1e-2
    apart = [np.abs(x - x[::-1] * [-1, 1, 1]).max(), np.abs(x - x[:, ::-1] * [1, 1, -1]).max()]
    assert (max(apart) < 1e-2) == is_mirrored


def test_a_turning_ball_draws_the_cloth_along(mesh: Cloth) -> None:
    """The middle of the sheet goes round with the ball, and stops with it."""
    cloth = _over_ball(mesh)
    cloth.held = FREELY
    for _ in range(60):
        cloth.step(FRAME)
    cloth.turning = 3.0
    for _ in range(60):
        cloth.step(FRAME)
    assert cloth.turned == pytest.approx(3.0)
    middle = len(mesh.vertices) // 2
    ways = cloth.positions[middle + 1] - cloth.positions[middle]
    angle = np.arctan2(ways[0], ways[2])
    assert 1.5 < angle < 3.1
    assert np.linalg.norm(cloth.positions, axis=1).min() > mesh.radius


def test_taken_up_again_it_is_flat(mesh: Cloth) -> None:
    """Hands pull what has fallen back to where it was; `reset` does so at once."""
    cloth = _over_ball(mesh)
    cloth.held = FREELY
    for _ in range(60):
        cloth.step(FRAME)
    fallen = cloth.positions.copy()
    cloth.held = 1.0
    for _ in range(240):
        cloth.step(FRAME)
    assert np.abs(cloth.positions - cloth.rest_positions).max() < 1.0
    cloth.reset()
    assert np.array_equal(cloth.positions, cloth.rest_positions)
    cloth.held = FREELY
    for _ in range(60):
        cloth.step(FRAME)
    assert np.array_equal(cloth.positions, fallen)


def test_frames_of_any_length_fall_alike(mesh: Cloth) -> None:
    """Ten a second or sixty: the same substeps."""
    quick, slow = _over_ball(mesh), _over_ball(mesh)
    quick.held = slow.held = FREELY
    for _ in range(60):
        quick.step(FRAME)
    for _ in range(10):
        slow.step(0.1)
    assert np.abs(quick.positions - slow.positions).max() < 1e-2


def test_what_is_no_mesh_is_refused() -> None:
    """The text says what was wrong."""
    with pytest.raises(ValueError, match="mesh: list has no attribute 'vertices'"):
        sim.Cloth([], np.zeros(3), 1.0)
    with pytest.raises(ValueError, match="radius: was nan"):
        sim.Cloth(assets.load("plane"), np.zeros(3), float("nan"))
