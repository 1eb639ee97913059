"""The measure of quality: subjects, errors and targets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from risorius import assets
from risorius.bench import quality, subjects
from risorius.bench.quality_report import error_curves, text
from risorius.bench.subjects import PosePair, Subject

Points = npt.NDArray[np.float64]


def bent(points: Points, angle: float) -> Points:
    """A plane rolled up to an arc of `angle` [radians] per unit of length."""
    x = points[:, 0] * angle
    return np.stack([np.sin(x), points[:, 1] * angle, np.cos(x) - 1.0], axis=1) / angle


def rolled_plane() -> Subject:
    """A flat plane, coarse and dense, and both rolled up: the truth is a cylinder."""
    meshes = []
    for cells in (6, 48):
        x, y = np.meshgrid(np.linspace(0.0, 3.0, cells + 1), np.linspace(0.0, 2.0, cells + 1))
        points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
        a = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
        lower = np.stack([a, a + 1, a + cells + 2], axis=1)
        upper = np.stack([a, a + cells + 2, a + cells + 1], axis=1)
        meshes.append((points, np.concatenate([lower, upper]).astype(np.int32)))
    (coarse, coarse_faces), (dense, dense_faces) = meshes
    poses = {
        f"roll {angle:g}": PosePair(bent(dense, angle), bent(coarse, angle)) for angle in (0.5, 1)
    }
    return Subject("plane", dense_faces, coarse_faces, PosePair(dense, coarse), poses)


def test_scores_of_a_cylinder() -> None:
    """Cubic edges follow a cylinder, Loop shrinks it; what splits more is never coarser."""
    subject = rolled_plane()
    scores = quality.measure(subject, budgets=(1.6, 2.0))
    average = quality.means(scores)
    coarse = average[quality.COARSE, "", 1.0]
    assert coarse.triangles == 72
    for scheme in quality.SCHEMES:
        for rule in quality.RULES[:2] if scheme == "loop" else quality.RULES:
            assert average[scheme, rule, 1.6].triangles <= 1.6 * 72
            assert average[scheme, rule, 2.0].triangles <= 2.0 * 72
        assert average[scheme, "", quality.EVERYWHERE].triangles >= 10 * 72
    assert average["cubic", "", quality.EVERYWHERE].distance < 0.5 * coarse.distance
    assert average["loop", "", quality.EVERYWHERE].distance > coarse.distance
    assert average["uniform PN", "", 2].distance < 0.5 * coarse.distance
    assert average["uniform Loop", "", 2].triangles == 16 * 72

    printed = text(subject, scores)
    for part in ("plane: 72 tri", "roll 0.5", f"{coarse.distance:.3f}", "cubic, height"):
        assert part in printed
    assert "cubic: never worse than coarse" in printed
    assert error_curves(subject, scores, "drop", (300, 200)).shape == (200, 300, 3)


def test_error_of_the_truth_is_zero() -> None:
    """A coarse mesh that is the dense one has no error, by any way of splitting nothing."""
    subject = rolled_plane()
    pose = subject.poses["roll 1"]
    same = Subject(
        "same",
        subject.dense_faces,
        subject.dense_faces,
        PosePair(subject.rest.dense, subject.rest.dense),
        {"roll": PosePair(pose.dense, pose.dense)},
    )
    (coarse, *_) = quality.measure(same, schemes=(), budgets=())
    assert coarse.method == quality.COARSE
    assert coarse.distance < 1e-9
    assert coarse.angle < 1e-3


def test_scans_are_read(tmp_path: Path) -> None:
    """A folder of scans: halves are joined, centimetres become millimetres, unknown names count."""
    head = assets.load("head")
    fine = head.finer(1)
    lift = 0.1 * np.ones_like(fine.vertices)
    count = len(head.vertices)
    np.savez(
        tmp_path / subjects.DENSE,
        vertices=fine.vertices / 10.0,
        triangles=fine.faces,
        landmarks68=head.landmarks,
        sneer_L=lift,
        sneer_R=lift,
        nobody_knows=lift,
    )
    first = np.zeros(count, dtype=np.int32)
    corner = np.zeros((count, 3), dtype=np.float32)
    for vertex in range(count):
        face, place = np.argwhere(fine.faces == vertex)[0] if vertex < 50 else (0, 0)
        first[vertex], corner[vertex, place] = face, 1.0
    np.savez(
        tmp_path / subjects.COARSE,
        triangles=head.faces,
        fine_triangle=first,
        barycentric=corner,
    )
    subject = subjects.scanned(tmp_path)
    assert set(subject.poses) == {"sneer", "nobody_knows"}
    assert np.allclose(subject.rest.coarse[:50], head.vertices[:50], atol=1e-5)
    assert np.allclose(subject.poses["sneer"].coarse - subject.rest.coarse, 2.0)
    assert np.allclose(subject.poses["nobody_knows"].dense - subject.rest.dense, 1.0)
    assert set(subjects.scanned(tmp_path, apart=True).poses) == {
        "sneer_L",
        "sneer_R",
        "nobody_knows",
    }


@pytest.mark.slow
def test_built_in_head() -> None:
    """The finer head moves by its own muscles, and the coarse one is its first vertices."""
    subject = subjects.built_in(1)
    head = assets.load("head")
    assert set(subject.poses) == set(head.expressions)
    assert len(subject.dense_faces) == 4 * len(subject.coarse_faces)
    assert (subject.rest.coarse == head.vertices).all()
    joy = subject.poses["joy"]
    assert (joy.coarse == joy.dense[: len(joy.coarse)]).all()
    assert np.abs(joy.coarse - head.vertices).max() > 5.0


@pytest.mark.slow
def test_targets_on_the_built_in_head() -> None:
    """Schemes that interpolate come nearer in every expression, by as much as was aimed at."""
    scores = quality.measure(
        subjects.built_in(1),
        schemes=("cubic", "detail"),
        budgets=quality.BUDGETS,
        expressions=("joy", "blink"),
    )
    coarse = {s.expression: s.distance for s in scores if s.method == quality.COARSE}
    for score in scores:
        if score.method in ("cubic", "detail"):
            assert score.distance < coarse[score.expression], score
    average = quality.means(scores)
    before = average[quality.COARSE, "", 1.0]
    assert average["cubic", "bulge", 1.6].distance < 0.9 * before.distance
    assert average["cubic", "", quality.EVERYWHERE].distance < 0.65 * before.distance
    assert average["detail", "bulge", 2.0].distance < 0.6 * before.distance
    assert average["detail", "bulge, grown", 2.0].distance < 0.6 * before.distance
    assert average["detail", "", quality.EVERYWHERE].distance < 0.25 * before.distance
    assert average["detail", "bulge", 2.0].median_angle < 0.7 * before.median_angle
    assert average["detail", "", quality.EVERYWHERE].angle < 0.7 * before.angle


@pytest.mark.parametrize("missing", ["folder", "array", "motion"])
def test_no_reference(tmp_path: Path, missing: str) -> None:
    """What is missing in a folder of scans is named."""
    text = "face.npz: is not there"
    if missing != "folder":
        arrays = {"vertices": np.eye(3), "triangles": np.array([[0, 1, 2]])}
        if missing == "array":
            del arrays["triangles"]
            text = "has no array 'triangles'"
        else:
            text = "no displacement field of shape"
        np.savez(tmp_path / subjects.DENSE, **arrays)
        np.savez(
            tmp_path / subjects.COARSE,
            triangles=[[0, 1, 2]],
            fine_triangle=[0, 0, 0],
            barycentric=np.eye(3),
        )
    with pytest.raises(ValueError, match=text):
        subjects.scanned(tmp_path)
