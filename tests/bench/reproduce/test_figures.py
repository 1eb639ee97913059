"""The paper's figures 8, 9 and 10, and the film strip: what they claim holds on the pictures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from risorius import refine
from risorius.assets.sheets import make_grid
from risorius.bench.canvas import FLAT, Canvas, Drawing
from risorius.bench.reproduce import coherence, figure_8, figure_10
from risorius.bench.reproduce.experiments import EXPERIMENTS, Experiment
from risorius.bench.reproduce.figure_9 import PHASES, VARIANTS, Waving, levels_apart, outline_apart
from risorius.bench.reproduce.figure_10 import MOUTH, Cell, Variant

DRAWN = [each for each in EXPERIMENTS if each.picture]
BLIND = Variant("blind", "kahler", {"scheme": "cubic", "criterion": "displacement"})


@pytest.mark.slow
@pytest.mark.parametrize("experiment", DRAWN, ids=lambda each: each.name)
def test_figures_are_as_the_paper_says(experiment: Experiment) -> None:
    """Every claim is met, or differs as we know; and there is a picture with ink on it."""
    result = experiment.run()
    assert result.findings and not result.missed
    assert result.outcome.picture is not None and result.outcome.picture.std() > 10.0


def rolled(cells: int, radius: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A flat sheet, its triangles, and the sheet rolled to a cylinder about y."""
    vertices, faces = make_grid(cells, cells, 10.0)
    angle = vertices[:, 0] / radius
    x, z = radius * np.sin(angle), radius * np.cos(angle)
    return vertices, faces, np.stack([x, vertices[:, 1], z], axis=1)


def test_a_rolled_sheet_folds_along_its_axis() -> None:
    """A flat sheet has no fold; rolled to a cylinder it is all fold; a ball bends both ways."""
    vertices, faces, cylinder = rolled(12, 25.0)
    assert not figure_8.find_folds(faces, vertices)[1].any()
    directions, is_fold = figure_8.find_folds(faces, cylinder)
    inside = (np.abs(vertices[faces].mean(axis=1)[:, :2]) < 50.0).all(axis=1)
    assert is_fold[inside].all()
    assert np.abs(directions[inside, 1]).min() > 0.99
    dome = vertices.copy()
    dome[:, 2] = np.sqrt(90.0**2 - (vertices**2).sum(axis=1))
    assert figure_8.find_folds(faces, dome)[1].mean() < 0.15


def test_shapes_of_known_triangles() -> None:
    """Split across its fold, a cell of a rolled sheet falls into strips along it."""
    vertices, faces, cylinder = rolled(4, 12.0)
    refiner = refine.create("kahler", faces, vertices, threshold_once=0.05, threshold_twice=0.1)
    before, after = figure_8.measure(refiner, faces, cylinder)
    assert 0 < before.count < after.count
    assert before.elongation == pytest.approx(np.sqrt(3.0), rel=0.1)
    assert after.elongation > 1.5 * before.elongation
    assert after.off_fold < 0.7 * before.off_fold


@pytest.fixture(scope="module")
def plane() -> Iterator[Waving]:
    """The plane in the figure's own size."""
    with Canvas((380, 230)) as canvas:
        yield Waving(canvas)


def test_nothing_is_off_from_itself(plane: Waving) -> None:
    """The measures are 0 for the truth, and see a shade and an outline that differ."""
    truth = plane.true_image(0.0)
    assert levels_apart(truth, truth) == outline_apart(truth, truth) == 0.0
    shows = truth.mean(axis=2) < 250
    lighter = np.where(shows[..., None], truth + 8, truth).astype(np.uint8)
    assert levels_apart(lighter, truth) == pytest.approx(8.0, abs=0.5)
    assert 0.01 < outline_apart(np.roll(truth, 3, axis=1), truth) < 0.1


def test_the_truth_is_dense_enough(plane: Waving) -> None:
    """All shadings of the true sine look alike: no triangle of it shows, and no underside."""
    coarse = plane.image(VARIANTS[0], FLAT, 0.0)[0]
    assert 90 < coarse.min() < 200  # an underside has no light
    vertices, faces = plane._dense
    positions, normals = plane._wave(0.0).waved(vertices)
    flat = plane._canvas.draw_surface(positions, normals, faces, Drawing(plane._camera, FLAT))
    truth = plane.true_image(0.0)
    assert levels_apart(flat, truth) < 1.0 < levels_apart(coarse, truth)


@pytest.mark.slow
def test_curves_are_nearer_in_shade_and_outline(plane: Waving) -> None:
    """What interpolates the plane is nearer to the sine than the plane is, in both."""
    static, cubic = (
        [
            (levels_apart(image, truth), outline_apart(image, truth))
            for phase in PHASES
            for image, truth in [(plane.image(each, FLAT, phase)[0], plane.true_image(phase))]
        ]
        for each in (VARIANTS[0], VARIANTS[3])
    )
    assert (np.mean(cubic, axis=0) < np.multiply((0.8, 0.6), np.mean(static, axis=0))).all()


def test_wrong_pixels_by_hand() -> None:
    """Only the opening of the mouth counts: one pixel too many and one too few are two."""
    image = np.zeros((2, 3, 3), np.uint8)
    truth = Cell("", 0, image, image, np.array([[0, 1, 1], [0, 0, 2]], np.uint8))
    drawn = Cell("", 0, image, image, np.array([[1, 1, 0], [0, 2, 0]], np.uint8))
    assert drawn.wrong(truth).sum() == 2 and truth.wrong(truth).sum() == 0


@pytest.mark.slow
def test_mouths() -> None:
    """All are open; refined ones are nearer to the dense one, and outlines owe it to `border`."""
    for _, cells in figure_10.drawn((280, 210), [*figure_10.VARIANTS, BLIND]):
        static, _, cubic, detail, blind, truth = cells
        for cell in cells:
            assert 0.05 < (cell.kinds == MOUTH).mean() < 0.5
            assert np.abs(cell.smooth.astype(int) - cell.flat).max() > 20
        before = np.square(static.off(truth)).mean()
        for refined in (cubic, detail):
            assert static.triangles < refined.triangles < truth.triangles / 2
            assert np.square(refined.off(truth)).mean() < 0.81 * before
            assert refined.wrong(truth).sum() < 0.87 * static.wrong(truth).sum()
        assert cubic.wrong(truth).sum() < 0.85 * blind.wrong(truth).sum()


def test_film_strip() -> None:
    """Red lines are in the row without memory, and none in the row with it."""
    outcome = coherence.outcome((120, 96))
    assert outcome.picture is not None
    drawn = outcome.picture.astype(int)
    assert drawn.shape[1] == len(coherence.AMPLITUDES) * 120
    is_red = (drawn[..., 0] > 150) & (drawn[..., 1:].max(axis=2) < 90)
    half = len(drawn) // 2
    assert is_red[:half].sum() > 200
    assert is_red[half:].sum() == 0
