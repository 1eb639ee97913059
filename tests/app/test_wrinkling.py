"""Wrinkles that follow the simulated skin: when, where, in which direction, on which heads."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.refining.wrinkling import Compression
from risorius.app.scenes import FaceScene
from risorius.assets.identities import person_called
from risorius.assets.loading import load

SETTLING_TIME = 1.2  # [s]


@pytest.fixture(scope="module")
def wrinkling(scene: FaceScene) -> Compression:
    """The measure of wrinkles."""
    return Compression(scene)


def amounts(scene, wrinkling, **pose):
    """Amounts of wrinkles in a settled pose."""
    scene.reset()
    scene.pose(pose)
    scene.step(SETTLING_TIME)
    return wrinkling.amounts(scene.positions).astype(np.float64)


def region(scene, low, high):
    """The vertices in a box at rest [mm]."""
    rest = scene.rest_positions
    return ((rest > low) & (rest < high)).all(axis=1)


def forehead(scene):
    return region(scene, (-30, 36, 60), (30, 62, 120))


def test_nothing_wrinkles_at_rest(scene, wrinkling):
    """At rest amounts are exactly 0, so that the picture without wrinkles is drawn."""
    found = amounts(scene, wrinkling)
    assert not found.any()


def test_fine_shape_has_gradients_at_rest(scene, wrinkling):
    """Without wrinkles, fine shape still gets gradients; a skin without fine shape gets none."""
    found = wrinkling.measure(scene.rest_positions, 0.0)
    assert np.linalg.norm(found.gradients, axis=1).min() > 0.0
    assert not found.amounts.any()
    plain = Compression(
        SimpleNamespace(
            faces=scene.faces,
            rest_positions=scene.rest_positions,
            skin=replace(scene.skin, fine_shape=None),
        )
    )
    assert plain.measure(scene.rest_positions, 0.0) is None


@pytest.mark.parametrize(
    "name",
    ["AU4", *(pytest.param(f"AU{unit}", marks=pytest.mark.slow) for unit in (1, 6, 17, 18))],
)
def test_amounts_grow_with_the_muscle_and_never_jump(scene, wrinkling, name):
    """In twenty steps of a muscle, no amount changes by over a quarter; the sum only grows."""
    steps = [amounts(scene, wrinkling, **{name: share}) for share in np.linspace(0.0, 1.0, 41)]
    coarse, fine = (np.abs(np.diff(steps[::skip], axis=0)) for skip in (2, 1))
    assert fine.max() < 0.65 * coarse.max() < 0.25  # half a step gives half the change: no jump
    assert coarse[0].max() < 0.06  # starting from 0
    sums = [step.sum() for step in steps]
    assert sums[-1] > 1.0
    assert (np.diff(sums) > -0.01 * sums[-1]).all()


@pytest.mark.parametrize(
    ("name", "low", "high", "slot"),
    [
        ("AU1", (-30, 36, 60), (30, 62, 120), 0),  # across the forehead
        ("AU4", (-12, 12, 60), (12, 34, 120), 1),  # upright between the brows
        ("AU6", (50, -12, 30), (66, 10, 80), 0),  # crow's feet
        ("AU9", (-12, -22, 60), (12, 8, 120), 0),  # the root of the nose
        ("AU17", (14, -76, 60), (34, -58, 120), 1),  # from the corners of the mouth down
        ("AU18", (-6, -84, 60), (6, -78, 120), 0),  # dimples of the chin
        ("AU18", (-14, -58, 60), (14, -50, 120), 1),  # lines around the lips
        ("joy", (50, -12, 30), (66, 10, 80), 0),
    ],
)
def test_each_wrinkles_where_it_does_in_people(scene, wrinkling, name, low, high, slot):
    """A unit has clear amounts at its place, and almost none on a still forehead."""
    found = amounts(scene, wrinkling, **{name: 1.0})
    assert found[region(scene, low, high), slot].max() > 0.3
    if name in ("AU6", "AU17", "AU18"):
        assert found[forehead(scene)].max() < 0.05


def test_a_mouth_moved_sideways_makes_no_bumps_on_the_chin(scene, wrinkling):
    """In `mouthLeft` the dimples of the chin are shallow; their amount once was 0.95."""
    found = amounts(scene, wrinkling, mouthLeft=1.0)
    assert found[region(scene, (0, -102, 90), (14, -90, 120)), 0].max() < 0.4


def test_furrows_of_age_are_pulled_flat():
    """A kiss stretches the fold beside the nose flat; the wrinkled lips keep their furrows."""
    person = person_called("maria")
    aged = FaceScene(person)
    measure = Compression(aged)
    before, after = (amounts(aged, measure, **pose) for pose in ({}, {"kiss": 1.0}))
    x, y, _ = (aged.rest_positions - person.vertices[person.landmarks[54]]).T
    fold = (x > -2.0) & (x < 22.0) & (y > 13.0) & (y < 26.0)
    fold &= before[:, 0] > 0.0
    lip = (np.abs(aged.rest_positions[:, 0]) < 10.0) & (y > 8.0) & (y < 14.0)
    assert fold.sum() >= 4
    assert after[fold, 0].mean() < 0.48 * before[fold, 0].mean()
    assert (after[fold, 0] < 0.75 * before[fold, 0]).all()
    assert after[lip].max() > 1.5 * before[lip].max() > 0.0


def test_folds_of_lids_flatten_when_the_eyes_shut():
    """The crease of an open eye flattens when the lids shut.

    Before, it crossed the shut lid as a dark band above a step.
    """
    person = person_called("maria")
    faces = FaceScene(person)
    measure = Compression(faces)
    open_eyed, shut = (amounts(faces, measure, **pose) for pose in ({}, {"blink": 1.0}))
    head = load("head")
    for side in ("left", "right"):
        creased = head.rings[f"eye_3_{side}"][3:8]
        assert (open_eyed[creased] > 0.99).all()
        assert shut[creased].max() < 0.3


def test_a_shut_lid_loses_the_shade_of_its_fold(scene, wrinkling):
    """The lids of a blink on the built-in head are brighter and redder than in their fold.

    They were grey and flat, since they kept the shade that they have while the eye is open.
    """
    lids = np.concatenate([load("head").rings[f"eye_3_{side}"][3:8] for side in ("left", "right")])
    assert amounts(scene, wrinkling, blink=1.0)[lids].max() < -0.8
    with Capture(scene, CaptureOptions((480, 480), camera="0,0,2")) as capture:
        view = capture.camera.view_matrix()
        projection = capture.camera.projection_matrix(1.0)
        matrix = np.array(view) @ np.array(projection)
        places = scene.positions[lids] @ matrix[:3] + matrix[3]
        on_screen = places[:, :2] / places[:, 3:] * (1.0, -1.0)  # -1 to 1, y downward
        across, down = (240.0 * (1.0 + on_screen)).astype(int).T

        def mean_around(image):
            """Return the mean colour of 3 x 3 pixels around each vertex."""
            means = scipy.ndimage.uniform_filter(image.astype(np.float64), (3, 3, 0))
            return means[down, across]

        shut = mean_around(capture.draw_image())
        capture.pipeline._compression._lids[:] = 0.0
        folded = mean_around(capture.draw_image())
    assert (shut > folded).all()
    assert (shut[:, 0] > 1.05 * folded[:, 0]).all()
    redness_of_shut = shut[:, 0] / shut[:, 2]
    redder = redness_of_shut - folded[:, 0] / folded[:, 2]
    assert redder.min() > -0.01  # at inner corners, which are red in any case
    assert redder.mean() > 0.01


def test_folds_of_lids_stay_without_wrinkles():
    """Folds of lids stay when wrinkles of motion and age have strength 0."""
    person = person_called("maria")
    faces = FaceScene(person)
    measure = Compression(faces)
    whole, half, none = (
        measure.amounts(faces.rest_positions, strength) for strength in (1.0, 0.5, 0.0)
    )
    head = load("head")
    creased = np.concatenate([head.rings[f"eye_3_{side}"][3:8] for side in ("left", "right")])
    for each in (whole, half, none):
        assert (each[creased] > 0.99).all()
    is_fold = person.wrinkles.folds > 0.0
    assert whole[~is_fold].max() > 0.2
    np.testing.assert_allclose(half[~is_fold], 0.5 * whole[~is_fold], atol=1e-6)
    assert not none[~is_fold].any()


def test_a_young_person_looks_alike_without_wrinkles():
    """With and without wrinkles, the picture of a young person at rest is the same.

    Person 8 has folds but no furrows. The built-in head has neither.
    """
    scene = FaceScene(person_called(8))
    pictures = []
    for strength in (1.0, 0.0):
        options = CaptureOptions((160, 160), camera="0,0,3", style=render.Style(bumps=strength))
        with Capture(scene, options) as capture:
            pictures.append(capture.draw_image())
            assert capture.viewports[0].drawn.wrinkles
    np.testing.assert_array_equal(*pictures)
    plain = FaceScene()
    assert not Compression(plain).measure(1.2 * plain.rest_positions, 0.0).amounts.any()
