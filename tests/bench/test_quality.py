"""The measure of quality: subjects, errors, and how far a surface goes in a frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from risorius import assets, refine
from risorius.bench import quality, subjects
from risorius.bench.flicker import largest_jump
from risorius.bench.quality import BEST, CALM, STATIC
from risorius.bench.subjects import PosePair, Subject
from tests import meshes

Points = npt.NDArray[np.float64]

VIEW = refine.View((0.0, 0.0, 10.0))


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
    """Cubic edges follow a cylinder, Loop shrinks it; budgets are kept, and blending is calm."""
    average = quality.means(scores := quality.measure([rolled_plane()]))
    static, loop = average[STATIC], average["uniform Loop 16x"]
    assert (static.triangles, loop.triangles) == (1.0, 16.0)
    assert all(score.triangles <= 2.0 for name, score in average.items() if name.endswith(" 2x"))
    cubic = average["cubic twice"]
    assert cubic.triangles >= 10.0
    assert cubic.distance < 0.5 * static.distance < 0.5 * loop.distance
    assert cubic.picture < static.picture < loop.picture
    assert cubic.outline < 0.5 * static.outline < 0.5 * loop.outline
    assert static.jump == pytest.approx(1.0, abs=1e-4)
    assert average[BEST].jump > 2.0 * average[CALM].jump
    for part in ("plane\n", f"{static.distance:.3f}", BEST):
        assert part in quality.report({"plane": scores})


def test_error_of_the_truth_is_zero() -> None:
    """A coarse mesh that is the dense one has no error; one turned aside has one of its own."""
    subject = rolled_plane()
    rest, pose = subject.rest.coarse, subject.poses["roll 1"].coarse
    faces = subject.coarse_faces
    poses = {"same": PosePair(pose, pose), "wider": PosePair(pose * [1.1, 1.0, 1.0], pose)}
    found = Subject("same", "same", faces, faces, PosePair(rest, rest), poses)
    same, wider = quality.measure([found], methods=[STATIC])
    assert same.method == STATIC
    assert same.distance < 1e-6 and same.picture < 0.1 and same.outline == 0.0
    assert wider.distance > 0.01 and wider.picture > 1.0 and wider.outline > 1000.0


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
    methods = (STATIC, BEST, CALM, "cubic twice", "detail displacement, blended 2x", "detail twice")
    scores = quality.measure([subjects.built_in(1)], ("joy", "blink"), methods=methods)
    for what in ("distance", "picture"):
        static = {s.expression: getattr(s, what) for s in scores if s.method == STATIC}
        for score in scores:
            if score.method != STATIC:
                assert getattr(score, what) < static[score.expression], score
    average = quality.means(scores)
    before, calm = average[STATIC], average["detail displacement, blended 2x"]
    assert average[BEST].distance < 0.9 * before.distance
    assert average["cubic twice"].distance < 0.65 * before.distance
    assert average["detail twice"].distance < 0.25 * before.distance
    assert calm.distance < 0.6 * before.distance
    assert calm.picture < 0.65 * before.picture
    assert calm.jump < 1.2


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


def shifted(points: Points, by: float) -> Points:
    """Moved to the right."""
    return points + np.array([by, 0.0, 0.0])


class Switching(refine.Criterion):
    """A criterion that splits every edge twice in every other frame."""

    def __init__(self) -> None:
        self.is_on = False

    def mark(self, positions: object, normals: object, splits: npt.NDArray[np.uint8]) -> None:
        """Write 2 or 0 for every edge."""
        splits[:] = 2 * self.is_on
        self.is_on = not self.is_on


def test_a_rigid_motion_does_not_jump() -> None:
    """The surface goes as far as its input."""
    mesh = meshes.octahedron()
    refiner = refine.create("loop", mesh.faces, mesh.vertices)
    frames = [shifted(mesh.vertices, 0.1 * k) for k in range(5)]
    jump = largest_jump(refiner, mesh.faces, frames, VIEW)
    assert jump == pytest.approx(1.0, abs=1e-5)


def test_a_pop_is_found() -> None:
    """Vertices of an octahedron that are drawn inward and let go jump farther than the input."""
    mesh = meshes.octahedron()
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, criterion=Switching())
    frames = [shifted(mesh.vertices, 0.01 * k) for k in range(5)]
    jump = largest_jump(refiner, mesh.faces, frames, VIEW)
    split = refine.create("loop", mesh.faces, mesh.vertices)
    inward = 1.0 - np.linalg.norm(split.refine(mesh.vertices).positions[: len(mesh.vertices)][0])
    assert jump == pytest.approx(inward / 0.01, rel=0.1)
