"""The benchmark `bench quality`: its meshes, and its measures of error."""

import numpy as np
import pytest

from risorius import assets
from risorius.bench import quality, subjects
from risorius.bench.quality import BEST_METHOD, STATIC_METHOD
from risorius.bench.subjects import PosePair, Subject
from risorius.geometry.closest import closest_points
from tests.meshes import open_grid


def bent(points, angle):
    """A plane rolled up to an arc of `angle` [radians] per unit of length."""
    x = points[:, 0] * angle
    return np.stack([np.sin(x), points[:, 1] * angle, np.cos(x) - 1.0], axis=1) / angle


def rolled_plane():
    """A flat plane, coarse and dense, and both rolled up; the exact surface is a cylinder."""
    meshes = []
    for cells in (6, 48):
        grid = open_grid(cells, cells)
        meshes.append((grid.vertices * [3.0 / cells, 2.0 / cells, 1.0], grid.faces))
    (coarse, coarse_faces), (dense, dense_faces) = meshes
    poses = {
        f"roll {angle:g}": PosePair(bent(dense, angle), bent(coarse, angle)) for angle in (0.5, 1)
    }
    return Subject(dense_faces, coarse_faces, PosePair(dense, coarse), poses)


@pytest.mark.slow
def test_scores_of_a_cylinder():
    """Cubic edges follow a cylinder, Loop's surface shrinks; no budget of triangles is exceeded."""
    average = quality.means(scores := quality.measure(rolled_plane()))
    static = average[STATIC_METHOD]
    loop = average["uniform Loop 16x"]
    assert (static.triangles, loop.triangles) == (1.0, 16.0)
    assert all(score.triangles <= 2.0 for name, score in average.items() if name.endswith(" 2x"))
    cubic = average["cubic twice"]
    assert cubic.triangles >= 10.0
    assert cubic.distance < 0.5 * static.distance < 0.5 * loop.distance
    assert cubic.picture < static.picture < loop.picture
    assert cubic.outline < 0.5 * static.outline < 0.5 * loop.outline
    for part in (f"{static.distance:.3f}", BEST_METHOD):
        assert part in quality.report(scores)


def test_error_of_the_truth_is_zero():
    """A coarse mesh equal to the dense mesh has no error; a turned one has an error."""
    subject = rolled_plane()
    rest = subject.rest.coarse
    pose = subject.poses["roll 1"].coarse
    faces = subject.coarse_faces
    poses = {"same": PosePair(pose, pose), "wider": PosePair(pose * [1.1, 1.0, 1.0], pose)}
    found = Subject(faces, faces, PosePair(rest, rest), poses)
    same, wider = quality.measure(found, methods=[STATIC_METHOD])
    assert same.method == STATIC_METHOD
    assert same.distance < 1e-6
    assert same.picture < 0.1
    assert same.outline == 0.0
    assert wider.distance > 0.01
    assert wider.picture > 1.0
    assert wider.outline > 1000.0


def test_scans_are_read(tmp_path):
    """In a folder of scans, left and right halves are joined and centimetres become millimetres.

    A shape of unknown name counts, too.
    """
    fine = assets.load("head").finer(1)
    lift = 0.1 * np.ones_like(fine.vertices)
    np.savez(
        tmp_path / subjects.DENSE_FILE,
        vertices=fine.vertices / 10.0,
        triangles=fine.faces,
        landmarks68=assets.load("head").landmarks,
        sneer_L=lift,
        sneer_R=lift,
        wink_L=lift,
        nobody_knows=lift,
    )
    subject = subjects.scanned(subjects.Scans.read(tmp_path))
    assert set(subject.poses) == {"sneer", "winkLeft", "nobody_knows"}
    assert abs(len(subject.coarse_faces) - subjects.COARSE_TRIANGLES) < 10
    lifted = subject.poses["sneer"]
    assert np.allclose(lifted.coarse - subject.rest.coarse, 2.0)
    assert np.allclose(lifted.dense - subject.rest.dense, 2.0)
    assert np.allclose(subject.poses["nobody_knows"].dense - subject.rest.dense, 1.0)
    assert closest_points(subject.rest.coarse, fine.vertices, fine.faces).distances.max() < 1e-6


@pytest.mark.slow
def test_built_in_head(head):
    """The finer head is moved by its own muscles; its first vertices are the coarse head."""
    subject = subjects.built_in(1)
    assert set(subject.poses) == set(head.expressions)
    assert len(subject.dense_faces) == 4 * len(subject.coarse_faces)
    assert (subject.rest.coarse == head.vertices).all()
    joy = subject.poses["joy"]
    assert (joy.coarse == joy.dense[: len(joy.coarse)]).all()
    assert np.abs(joy.coarse - head.vertices).max() > 5.0


@pytest.mark.slow
def test_gains_on_the_built_in_head():
    """In every expression interpolating schemes reduce the error by the intended share."""
    calm = "detail displacement, blended 2x"
    methods = (STATIC_METHOD, BEST_METHOD, calm, "cubic twice", "detail twice")
    scores = quality.measure(subjects.built_in(1), ("joy", "blink"), methods=methods)
    for what in ("distance", "picture"):
        static = {s.expression: getattr(s, what) for s in scores if s.method == STATIC_METHOD}
        for score in scores:
            if score.method != STATIC_METHOD:
                assert getattr(score, what) < static[score.expression], score
    average = quality.means(scores)
    before = average[STATIC_METHOD]
    assert average[BEST_METHOD].distance < 0.9 * before.distance
    assert average["cubic twice"].distance < 0.65 * before.distance
    assert average["detail twice"].distance < 0.25 * before.distance
    assert average[calm].distance < 0.6 * before.distance
    assert average[calm].picture < 0.65 * before.picture
