"""Fig. 10 shows what it claims: refined mouths are nearer to the dense one, and outlines, too."""

from __future__ import annotations

import numpy as np
import pytest

from risorius.bench.reproduce import figure_10
from risorius.bench.reproduce.figure_10 import Cell, Shot, difference
from risorius.bench.reproduce.mouths import MOUTH, Variant, wrong_pixels

pytestmark = pytest.mark.slow  # every test looks at the same pictures

SIZE = (280, 210)
BLIND = Variant("blind", "kahler", {"scheme": "cubic", "criterion": "displacement"})
SEEN = 8.0  # levels of 255: a change that is seen


def wrong_outline(cell: Cell, truth: Cell) -> int:
    """Pixels around the opening of the mouth that are not as in the truth."""
    return wrong_pixels(cell.kinds, truth.kinds)


@pytest.fixture(scope="module")
def drawn() -> list[tuple[Shot, dict[str, Cell]]]:
    """Every shot in every variant, and in one more, small."""
    found = figure_10.drawn(SIZE, [*figure_10.VARIANTS, BLIND], figure_10.SHOTS)
    return [(shot, {cell.title: cell for cell in cells}) for shot, cells in found]


def rms(cell: Cell, truth: Cell) -> float:
    """Root mean square of the difference."""
    return float(np.sqrt((difference(cell, truth) ** 2).mean()))


@pytest.mark.parametrize(
    ("variant", "left_over", "outline_left", "changed", "nearer"),
    [
        ("refined: cubic", 0.9, 0.85, 0.045, 0.8),
        ("refined: detail", 0.9, 0.87, 0.15, 0.8),
    ],
)
def test_refined_is_nearer(
    drawn: list[tuple[Shot, dict[str, Cell]]],
    variant: str,
    left_over: float,
    outline_left: float,
    changed: float,
    nearer: float,
) -> None:
    """Less of the error is left, of outlines too; pixels change, and most toward the dense mesh.

    `changed` is a share of the pixels that the dense mesh changes.
    """
    for _, cells in drawn:
        static, refined, truth = cells["static"], cells[variant], cells["dense mesh"]
        assert static.triangles < refined.triangles < truth.triangles / 2
        assert rms(refined, truth) < left_over * rms(static, truth)
        assert wrong_outline(refined, truth) < outline_left * wrong_outline(static, truth)
        is_changed = difference(refined, static) > SEEN
        assert is_changed.mean() > changed * (difference(truth, static) > SEEN).mean()
        is_nearer = difference(refined, truth) < difference(static, truth)
        assert is_nearer[is_changed].mean() > nearer


def test_borders_are_seen(drawn: list[tuple[Shot, dict[str, Cell]]]) -> None:
    """Outlines owe it to the criterion `border` that they are nearer."""
    for _, cells in drawn:
        truth = cells["dense mesh"]
        assert wrong_outline(cells["refined: cubic"], truth) < 0.85 * wrong_outline(
            cells["blind"], truth
        )


def test_truth_and_measures(drawn: list[tuple[Shot, dict[str, Cell]]]) -> None:
    """The dense mesh is no way from itself; every mouth is open, in the frame and near by."""
    for _, cells in drawn:
        truth = cells["dense mesh"]
        assert rms(truth, truth) == 0.0
        assert wrong_outline(truth, truth) == 0
        for cell in cells.values():
            assert 0.05 < (cell.kinds == MOUTH).mean() < 0.5
            assert 0.1 < (cell.opening == MOUTH).mean() < 0.9
            assert cell.smooth.shape == cell.flat.shape == (SIZE[1], SIZE[0], 3)
            assert np.abs(cell.smooth.astype(int) - cell.flat).max() > 20


def test_page() -> None:
    """A block for each shot, a column for each variant and the dense mesh, and colours on them."""
    shots, variants = figure_10.SHOTS[1:], figure_10.VARIANTS[:1]
    blocks = figure_10.drawn((80, 60), variants, shots)
    page = figure_10.page(blocks).astype(int)
    assert 160 < page.shape[1] < 200
    assert 210 < page.shape[0] < 270
    is_wrong = (np.abs(page - figure_10.WRONG) < 30).all(axis=2)
    assert is_wrong[:, :100].any()  # red where the static outline is off
    twice = figure_10.page(blocks * 2)
    assert len(twice) == 2 * len(page)
