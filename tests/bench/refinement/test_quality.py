"""The measure of quality: subjects and errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from risorius import assets
from risorius.bench import subjects
from risorius.bench.refinement import methods, quality
from risorius.bench.refinement.quality_report import STATIC_KEY, text
from risorius.bench.subjects import PosePair, Subject

Points = npt.NDArray[np.float64]

BLENDED = "displacement, blended"


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
    return Subject("plane", "plane", dense_faces, coarse_faces, PosePair(dense, coarse), poses)


@pytest.mark.slow
def test_scores_of_a_cylinder() -> None:
    """Cubic edges follow a cylinder, Loop shrinks it; what splits more is never coarser."""
    subject = rolled_plane()
    scores = quality.measure(subject)
    average = quality.means(scores)
    static = average[STATIC_KEY]
    assert static.triangles == 72
    for scheme, rules in methods.SCHEMES.items():
        for rule in rules:
            assert average[scheme, rule, 2.0].triangles <= 2.0 * 72
        assert average[scheme, "", methods.EVERYWHERE].triangles >= 10 * 72
    cubic, loop = (average[scheme, "", methods.EVERYWHERE] for scheme in ("cubic", "loop"))
    assert cubic.distance < 0.5 * static.distance < 0.5 * loop.distance
    assert cubic.picture < static.picture < loop.picture
    pn = average["PN", "", 16.0]
    assert pn.outline < 0.5 * static.outline < 0.5 * loop.outline
    assert pn.distance < 0.5 * static.distance
    assert average["uniform Loop", "", 16.0].triangles == 16 * 72
    assert static.jump == pytest.approx(1.0, abs=1e-4)
    assert average["cubic", "displacement", 2.0].jump > 2.0 * average["cubic", BLENDED, 2.0].jump

    printed = text(subject, scores)
    for part in ("plane: 72 tri", f"{static.distance:.3f}", "cubic curvature 2x"):
        assert part in printed


def test_error_of_the_truth_is_zero() -> None:
    """A coarse mesh that is the dense one has no error, by any way of splitting nothing."""
    subject = rolled_plane()
    pose = subject.poses["roll 1"]
    same = Subject(
        "same",
        "same",
        subject.coarse_faces,
        subject.coarse_faces,
        PosePair(subject.rest.coarse, subject.rest.coarse),
        {"roll": PosePair(pose.coarse, pose.coarse)},
    )
    (static, *_) = quality.measure(same, schemes=(), budgets=())
    assert static.key == STATIC_KEY
    assert static.distance < 1e-6
    assert static.angle < 0.1
    assert static.picture < 0.1
    assert static.outline == 0.0


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
    (subject,) = subjects.scanned(tmp_path)
    assert set(subject.poses) == {"sneer", "nobody_knows"}
    assert np.allclose(subject.rest.coarse[:50], head.vertices[:50], atol=1e-5)
    assert np.allclose(subject.poses["sneer"].coarse - subject.rest.coarse, 2.0)
    assert np.allclose(subject.poses["nobody_knows"].dense - subject.rest.dense, 1.0)
    frames = subject.frames("sneer")
    assert (frames[0] == subject.rest.coarse).all()
    assert np.allclose(frames[-1], subject.poses["sneer"].coarse)

    np.savez(tmp_path / subjects.PERSONS, person_1=fine.vertices / 5.0)
    first, second = subjects.scanned(tmp_path)
    assert (first.name, first.group) == ("scan", "scan")
    assert (second.name, second.group) == ("person 1", "other persons")
    assert np.allclose(second.rest.dense, 2.0 * first.rest.dense)
    assert np.allclose(second.poses["sneer"].coarse - second.rest.coarse, 2.0)
    np.savez(tmp_path / subjects.PERSONS, person_1=fine.vertices[1:])
    with pytest.raises(ValueError, match=r"identities.npz: 'person 1' has not the \d+ vertices"):
        subjects.scanned(tmp_path)


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
    frames = subject.frames("joy")
    assert np.abs(frames[-1] - head.vertices).max() < 1.0 < np.abs(frames[45] - frames[0]).max()


@pytest.mark.slow
def test_gains_on_the_built_in_head() -> None:
    """Schemes that interpolate come nearer in every expression, by as much as was aimed at."""
    scores = quality.measure(
        subjects.built_in(1),
        schemes=("cubic", "detail"),
        budgets=(1.6, 2.0),
        expressions=("joy", "blink"),
    )
    for what in ("distance", "picture"):
        static = {s.expression: getattr(s, what) for s in scores if s.key == STATIC_KEY}
        for score in scores:
            if score.key[0] in ("cubic", "detail") and score.key[1] != "normal":
                assert getattr(score, what) < static[score.expression], score
    average = quality.means(scores)
    before = average[STATIC_KEY]
    assert average["cubic", "displacement", 1.6].distance < 0.9 * before.distance
    assert average["cubic", "", methods.EVERYWHERE].distance < 0.65 * before.distance
    assert average["detail", "displacement", 2.0].distance < 0.6 * before.distance
    assert average["detail", BLENDED, 2.0].distance < 0.6 * before.distance
    assert average["detail", BLENDED, 2.0].picture < 0.65 * before.picture
    assert average["detail", BLENDED, 2.0].jump < 1.2
    assert average["detail", "", methods.EVERYWHERE].distance < 0.25 * before.distance
    assert average["detail", "displacement", 2.0].angle < 0.7 * before.angle


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
