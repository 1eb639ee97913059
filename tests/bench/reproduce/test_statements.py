"""The statements of sections 3 and 4 hold, and what counts breaches of them sees them."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from risorius import refine
from risorius.app.refining.presets import PAPERS_PRESET, PRESETS
from risorius.app.scenes import PlaneScene, Scene
from risorius.bench.reproduce import statements
from risorius.bench.reproduce.experiments import EXPERIMENTS


def test_statements_are_met() -> None:
    """As the paper says, on face and plane."""
    (experiment,) = (each for each in EXPERIMENTS if each.name == "statements")
    result = experiment.run()
    assert result.findings and not result.missed


@pytest.fixture
def waving(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """The plane in two moments of its wave is all that is looked at."""

    def moments(scene: Scene) -> Iterator[npt.NDArray[np.float64]]:
        for amplitude in (1.0, 0.3):
            scene.pose({"amplitude": amplitude})
            scene.step(0.1)
            yield scene.positions.copy()

    monkeypatch.setattr(statements, "_moments", moments)
    monkeypatch.setattr(statements, "FaceScene", PlaneScene)
    return monkeypatch


def measured(waving: pytest.MonkeyPatch, **options: Any) -> dict[str, Any]:
    """What is measured of a refiner with these options, over the plane's own."""

    def refiner(scene: Scene) -> refine.Refiner:
        merged = {**PRESETS[PAPERS_PRESET][scene.name].told("kahler"), **options}
        if "criterion" in options:
            del merged["threshold_once"], merged["threshold_twice"]
        return refine.create("kahler", scene.faces, scene.rest_positions, **merged)

    waving.setattr(statements, "papers_refiner", refiner)
    return dict(statements.outcome().values)


def test_points_inside_and_memory_are_seen(waving: pytest.MonkeyPatch) -> None:
    """Blending puts points into triangles, coherent splitting remembers; the paper's does not."""
    names = "points inside triangles", "frames that remember others"
    inside, remember = names
    assert [measured(waving)[name] for name in names] == [0, 0]
    assert measured(waving, blend=True)[inside] > 0
    assert measured(waving, coherent=True)[remember] > 0


class AllOfThem(refine.Criterion):
    """A criterion that splits every edge as often as it is told."""

    def __init__(self, times: int) -> None:
        self.times = times

    def mark(self, positions: object, normals: object, splits: npt.NDArray[np.uint8]) -> None:
        """Split all."""
        splits[:] = self.times


def test_splits_without_bending_are_seen(waving: pytest.MonkeyPatch) -> None:
    """All edges of both meshes are counted."""

    def refiner(scene: Scene) -> refine.Refiner:
        return refine.create("kahler", scene.faces, scene.rest_positions, criterion=AllOfThem(1))

    waving.setattr(statements, "papers_refiner", refiner)
    values = statements.outcome().values
    edges = len(refiner(PlaneScene()).edges)
    assert values["edges split at rest"] == values["edges split turned and shifted"] == 2 * edges


def test_cracks_are_seen(waving: pytest.MonkeyPatch) -> None:
    """A frame that `refine.check` finds broken is counted."""

    def broken(*_: object) -> None:
        raise refine.BrokenMeshError("torn")

    assert measured(waving)["frames with cracks"] == 0
    waving.setattr(refine, "check", broken)
    assert measured(waving)["frames with cracks"] == 4
