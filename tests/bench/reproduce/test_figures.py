"""The claims of the paper's figures 8, 9 and 10 hold on the reproduced pictures."""

from collections.abc import Iterator

import numpy as np
import pytest

from risorius.assets.sheets import make_grid
from risorius.bench.canvas import Canvas
from risorius.bench.reproduce import figure_8
from risorius.bench.reproduce.experiments import EXPERIMENTS
from risorius.bench.reproduce.figure_9 import Waving, grey_level_difference, outline_difference

DRAWN_EXPERIMENTS = [each for each in EXPERIMENTS if each.picture]


@pytest.mark.slow
@pytest.mark.parametrize("experiment", DRAWN_EXPERIMENTS, ids=lambda each: each.name)
def test_figures_are_as_the_paper_says(experiment):
    """Every claim is met, or differs as documented, and the picture of each figure is not empty."""
    result = experiment.run()
    assert result.findings
    assert not result.missed
    assert result.outcome.picture.std() > 10.0


def rolled(cells, radius):
    """A flat sheet, its triangles, and the sheet rolled to a cylinder about y."""
    vertices, faces = make_grid(cells, cells, 10.0)
    angle = vertices[:, 0] / radius
    x = radius * np.sin(angle)
    z = radius * np.cos(angle)
    return vertices, faces, np.stack([x, vertices[:, 1], z], axis=1)


def test_a_rolled_sheet_folds_along_its_axis():
    """A flat sheet has no fold, a sheet rolled to a cylinder has one; a ball bends both ways."""
    vertices, faces, cylinder = rolled(12, 25.0)
    assert not figure_8.find_folds(faces, vertices)[1].any()
    directions, is_fold = figure_8.find_folds(faces, cylinder)
    inside = (np.abs(vertices[faces].mean(axis=1)[:, :2]) < 50.0).all(axis=1)
    assert is_fold[inside].all()
    assert np.abs(directions[inside, 1]).min() > 0.99
    dome = vertices.copy()
    dome[:, 2] = np.sqrt(90.0**2 - (vertices**2).sum(axis=1))
    assert figure_8.find_folds(faces, dome)[1].mean() < 0.15


@pytest.fixture(scope="module")
def plane() -> Iterator[Waving]:
    """The plane at the size used in the figure."""
    with Canvas((380, 230)) as canvas:
        yield Waving(canvas)


def test_nothing_is_off_from_itself(plane):
    """The measures are 0 for the reference itself, and detect another shade and another outline."""
    truth = plane.true_image(0.0)
    assert grey_level_difference(truth, truth) == outline_difference(truth, truth) == 0.0
    shows = truth.mean(axis=2) < 250
    lighter = np.where(shows[..., None], truth + 8, truth).astype(np.uint8)
    assert grey_level_difference(lighter, truth) == pytest.approx(8.0, abs=0.5)
    assert 0.01 < outline_difference(np.roll(truth, 3, axis=1), truth) < 0.1
