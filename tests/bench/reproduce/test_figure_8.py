"""The paper's Fig. 8: subtriangles are long and thin, and lie along folds."""

from __future__ import annotations

import numpy as np
import pytest

from risorius import refine
from risorius.assets.sheets import make_grid
from risorius.bench.reproduce import figure_8, folds
from risorius.bench.reproduce.figure_8 import POSES, Pose


def test_a_rolled_sheet_folds_along_its_axis() -> None:
    """A flat sheet has no fold; rolled to a cylinder it is all fold, along the axis."""
    vertices, faces = make_grid(12, 8, 10.0)
    assert not folds.find_folds(faces, vertices)[1].any()
    angle = vertices[:, 0] / 25.0
    rolled = np.stack([25.0 * np.sin(angle), vertices[:, 1], 25.0 * np.cos(angle)], axis=1)
    directions, is_fold = folds.find_folds(faces, rolled)
    inside = (np.abs(vertices[faces].mean(axis=1)[:, :2]) < [50.0, 30.0]).all(axis=1)
    assert is_fold[inside].all()
    assert np.abs(directions[inside, 1]).min() > 0.99


def test_a_ball_has_no_folds() -> None:
    """It bends both ways alike."""
    vertices, faces = make_grid(8, 8, 10.0)
    dome = (
        vertices
        + np.array([0.0, 0.0, 1.0]) * (np.sqrt(80.0**2 - (vertices**2).sum(axis=1))[:, None])
    )
    assert folds.find_folds(faces, dome)[1].mean() < 0.15


def test_shapes_of_known_triangles() -> None:
    """Split across its fold, a cell of a rolled sheet falls into strips along it."""
    vertices, faces = make_grid(4, 4, 10.0)
    angle = vertices[:, 0] / 12.0
    rolled = np.stack([12.0 * np.sin(angle), vertices[:, 1], 12.0 * np.cos(angle)], axis=1)
    refiner = refine.create("kahler", faces, vertices, threshold_once=0.05, threshold_twice=0.1)
    before, after = folds.measure(refiner, faces, rolled)
    assert 0 < before.count < after.count
    assert before.elongation == pytest.approx(np.sqrt(3.0), rel=0.1)
    assert after.elongation > 1.5 * before.elongation
    assert after.off_fold < 0.7 * before.off_fold


@pytest.mark.parametrize("pose", POSES, ids=[pose.scene for pose in POSES])
def test_long_triangles_lie_along_folds(pose: Pose) -> None:
    """As the caption says: thinner by a third, twice as long, and nearer to the fold."""
    scene = figure_8.posed(pose)
    refiner = refine.create("kahler", scene.faces, scene.rest_positions)
    before, after = folds.measure(refiner, scene.faces, scene.positions)
    assert before.count > 150 and after.count > 3 * before.count
    assert 38.0 < before.smallest_angle < 47.0 and 24.0 < after.smallest_angle < 31.0
    assert after.elongation > 1.5 * before.elongation
    assert after.off_fold < min(23.0, 0.8 * before.off_fold)


def test_layout() -> None:
    """A row for each pose, three pictures in it; the refined one has more lines."""
    drawn = figure_8.draw((120, 100)).astype(int)
    assert drawn.shape[1] == 3 * 120
    row = drawn[: len(drawn) // len(POSES)]
    static, refined, folded = (row[34:130, k * 120 : (k + 1) * 120] for k in range(3))
    assert refined.mean() < static.mean()
    is_red = (folded[..., 0] > 150) & (folded[..., 1:].max(axis=2) < 100)
    assert is_red.sum() > 50
