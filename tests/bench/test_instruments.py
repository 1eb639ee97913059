"""What `bench soak` and `bench tearing` measure with sees what is there."""

import numpy as np
import pytest

from risorius import assets, sim
from risorius.app.controls import mirror
from risorius.bench import soak, tearing


def test_a_folded_triangle_is_counted() -> None:
    """One that turned over is found amid skin that turned as a whole, which is none."""
    head = assets.load("head")
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    over = turn @ np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    now = head.vertices @ over.T
    assert tearing._inverted(head.vertices, now, head.faces) == 0
    tip = head.anatomy["cheilion_left"]
    ring = np.unique(head.faces[(head.faces == tip).any(axis=1)])
    away = head.vertices[ring[ring != tip]]
    farthest = away[np.linalg.norm(away - head.vertices[tip], axis=1).argmax()]
    now[tip] = (2.0 * farthest - head.vertices[tip]) @ over.T
    assert tearing._inverted(head.vertices, now, head.faces) >= 1


def test_motion_that_is_not_mirrored_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the signs of sideways motion left as they are, the two runs differ by millimetres."""
    head = assets.load("head")
    monkeypatch.setattr(soak, "MIRRORED_FRAMES", 10)
    simulation = sim.create(head)
    assert soak._mirror_error(simulation, head.mirror) < 1e-6
    monkeypatch.setattr(mirror, "TURNED", ())
    assert soak._mirror_error(simulation, head.mirror) > 1.0


class Growing:
    """A simulation whose energy falls, but for one frame."""

    positions = np.zeros((3, 3))

    def __init__(self, energies: list[float]) -> None:
        self._energies = iter(energies)

    def reset(self) -> None:
        """Nothing to put back."""

    def kick(self, velocities: np.ndarray) -> None:
        """Hit as all others are."""
        assert velocities.shape == self.positions.shape

    def step(self, dt: float) -> None:
        """A frame."""

    def energy(self) -> float:
        """The next of the given energies."""
        return next(self._energies)


def test_growing_energy_is_seen() -> None:
    """The greatest growth of a frame, as a share of the blow's energy; rounding is none."""
    falling = np.linspace(4.0, 1.0, 121).tolist()
    assert soak._energy_growth(Growing(falling)) == 0.0  # type: ignore[arg-type]
    falling[60] = falling[59] + 1.0
    assert soak._energy_growth(Growing(falling)) == pytest.approx(0.25)  # type: ignore[arg-type]
    level = np.full(121, 2.0)
    level[7] += 1e-10
    assert soak._energy_growth(Growing(level.tolist())) == 0.0  # type: ignore[arg-type]
