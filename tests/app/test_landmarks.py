"""Landmarks in pictures: on visible borders; those of the jaw lie on its outline."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.linalg import norm
from scipy.ndimage import distance_transform_edt

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.passes.camera import CameraLabels
from risorius.app.passes.labels import labels_of
from risorius.app.passes.landmarks import landmarks_in
from risorius.app.passes.passes import Passes
from risorius.app.scenes import FaceScene
from risorius.assets import Segment
from risorius.assets.fitting import fit_head
from risorius.assets.identities import person_called
from tests.heads import user_head

SIZE = (900, 900)
LIMIT = 1.5  # [mm]
RIGHT_JAW = slice(0, 9)
LEFT_JAW = slice(8, 17)


class Portrait:
    """A face drawn from a view, with its classes and landmarks."""

    def __init__(self, studio: Capture, yaw: float = 0.0, pitch: float = 0.0) -> None:
        scene = studio.scene
        studio.camera = render.OrbitCamera.framing(scene.framing.extent)
        studio.camera.orbit(yaw, pitch)
        studio.draw_image()
        passes = Passes(studio.pipeline, studio.viewports[-1].drawn)
        drawn = passes.draw(studio.camera, studio.options.style, ["segmentation", "depth"])
        camera = CameraLabels.from_camera(studio.camera, SIZE)
        self.classes = drawn["segmentation"]
        self.found = landmarks_in(scene.face, camera, drawn["depth"])
        self.labels = labels_of(scene, studio.camera, SIZE, drawn["depth"])
        far = camera.to_camera(self.found.points)[:, 2]
        self.millimetres = far / camera.intrinsics[0, 0]  # size of a pixel at each landmark

    def away(self, numbers, segments):
        """Distances of landmarks from the nearest pixel of some classes [mm]."""
        far = distance_transform_edt(~np.isin(self.classes, segments))
        columns, rows = np.floor(self.found.pixels[numbers]).astype(int).T
        return far[rows, columns] * self.millimetres[numbers]

    def off_border(self, numbers, segments):
        """Distances of landmarks from the border of some classes [mm]."""
        inside = np.isin(self.classes, segments)
        far = np.maximum(distance_transform_edt(inside), distance_transform_edt(~inside))
        columns, rows = np.floor(self.found.pixels[numbers]).astype(int).T
        return (far[rows, columns] - 1.0) * self.millimetres[numbers]

    def ends(self, segment):
        """The outermost pixels of a class, left and right in the picture, (2, 2)."""
        rows, columns = np.nonzero(self.classes == segment)
        places = np.column_stack([columns, rows]) + 0.5
        return places[[columns.argmin(), columns.argmax()]]


def posed_portrait(studio, controls, pitch=0.0):
    """A portrait after the face settled in a pose; the face is at rest again afterwards."""
    scene = studio.scene
    scene.pose(controls)
    scene.step(0.5)
    portrait = Portrait(studio, pitch=pitch)
    scene.reset()
    return portrait


@pytest.fixture(scope="module", params=["built-in", 3, 8])
def studio(request: pytest.FixtureRequest) -> Iterator[Capture]:
    """A capture of the built-in face, and of two persons."""
    face = FaceScene() if request.param == "built-in" else FaceScene(person_called(request.param))
    with Capture(face, CaptureOptions(size=SIZE)) as opened:
        yield opened


def test_mesh_picture_and_label_agree(studio):
    """Eye and mouth corners, brow ends and the border of the red agree within 1.5 mm.

    Mesh, picture and label are compared.
    """
    portrait = Portrait(studio)
    pixels = portrait.found.pixels
    for numbers, segment in (
        ((36, 39), Segment.RIGHT_EYE),
        ((42, 45), Segment.LEFT_EYE),
    ):
        off = norm(pixels[list(numbers)] - portrait.ends(segment), axis=1)
        assert (off * portrait.millimetres[list(numbers)] < LIMIT).all(), (segment.name, off)
    for numbers, segment in (
        (np.arange(17, 22), Segment.RIGHT_BROW),
        (np.arange(22, 27), Segment.LEFT_BROW),
    ):
        across = np.abs(pixels[numbers[[0, -1]]] - portrait.ends(segment))[:, 0]
        assert (across * portrait.millimetres[numbers[[0, -1]]] < LIMIT).all(), segment.name
        assert (portrait.off_border(numbers, segment) < LIMIT).all(), segment.name
    lips = [Segment.TOP_LIP, Segment.BOTTOM_LIP]
    border = portrait.off_border([48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59], lips)
    assert (border < LIMIT).all(), border


def test_the_jaw_lies_on_the_outline_that_is_seen(studio):
    """Jaw landmarks lie on the visible outline: on both sides in front, else on the far side.

    Points on the bone do not slide.
    """
    face = [Segment.SKIN, Segment.NOSE, Segment.TOP_LIP, Segment.BOTTOM_LIP]
    chin = range(6, 11)  # a soft edge, because the throat has the tone of the skin
    sides = [number for number in range(17) if number not in chin]
    steepest = 2.5  # [mm] beside an ear, whose root has no sharp border
    portrait = Portrait(studio)
    assert (portrait.off_border(sides, face) < steepest).all()
    # On the triangles themselves these points would lie 1.8 mm or more inside the refined outline.
    assert (portrait.off_border([3, 4, 12, 13], face) < LIMIT).all()
    for yaw, far in ((-35.0, [12, 13, 14]), (35.0, [2, 3, 4])):
        turned = Portrait(studio, yaw)
        assert (turned.off_border(far, [Segment.BACKGROUND, Segment.NECK]) < steepest).all()
        on_bone = turned.labels["landmarks"]["jaw_on_bone"]
        marked = studio.scene.face.marked[:17]
        assert np.allclose(on_bone["points"], marked)
        assert norm(turned.found.points[far] - marked[far], axis=1).min() > 4.0


def test_an_outline_without_hair_over_it_is_visible(scene):
    """Jaw landmarks on an outline without hair are visible, in front and on the far side."""
    scene.reset()
    with Capture(scene, CaptureOptions(size=SIZE)) as opened:
        assert Portrait(opened).found.visible[:17].all()
        assert Portrait(opened, -35.0).found.visible[9:16].all()


def test_points_of_the_jaw_are_spread_evenly(studio):
    """Jaw landmarks are spaced evenly, as by annotators, from the eyes' height to the chin."""
    portrait = Portrait(studio)
    pixels = portrait.found.pixels
    for side in (RIGHT_JAW, LEFT_JAW):
        steps = norm(np.diff(pixels[side], axis=0), axis=1)
        assert steps.max() < 1.2 * steps.min()
    eyes = pixels[[36, 45], 1].mean()
    assert np.abs(pixels[[0, 16], 1] - eyes).max() * portrait.millimetres[36] < 9.0


def test_an_outline_ends_at_one_height_of_the_head(studio):
    """Jaw landmarks begin at the height of the outer eye corners, for any height of the camera."""
    for pitch in (-20.0, 0.0, 20.0):
        points = Portrait(studio, pitch=pitch).found.points
        above = points[[0, 16], 1] - points[[36, 45], 1]
        assert np.abs(above).max() < 0.5, pitch


@pytest.mark.parametrize(
    "controls", [{}, {"AU12": 0.5}, {"AU15": 0.8}, {"AU24": 0.6}, {"AU28": 0.7}, {"AU26": 0.8}]
)
@pytest.mark.parametrize("pitch", [-15.0, 0.0, 15.0])
def test_inner_lips_meet_where_the_picture_shows_it(studio, controls, pitch):
    """The points of the inner lips lie on the line between the lips, or at the mouth's inside.

    Points at fixed places of the skin were up to 5 mm behind the other lip, and counted as hidden.
    """
    portrait = posed_portrait(studio, controls, pitch)
    upper = [61, 62, 63]
    lower = [67, 66, 65]
    above = portrait.found.pixels[lower, 1] - portrait.found.pixels[upper, 1]
    pixel_width = 0.31  # [mm]
    assert (above * portrait.millimetres[upper] > -pixel_width).all()
    if "AU28" not in controls:  # lips that are rolled in have no red
        inside = [Segment.MOUTH_INTERIOR]
        assert (portrait.away(upper, [Segment.BOTTOM_LIP, *inside]) < LIMIT).all()
        assert (portrait.away(lower, [Segment.TOP_LIP, *inside]) < LIMIT).all()
    assert portrait.found.visible[[*upper, *lower]].all()


def test_shut_lids_have_their_points_on_one_line(studio):
    """The points of both lids of a shut eye are visible, and differ by a millimetre in height.

    Those of the lower lid were above those of the upper one, and all of them counted as hidden.
    """
    portrait = posed_portrait(studio, {"AU43": 1.0})
    upper = [37, 38, 43, 44]
    lower = [41, 40, 47, 46]
    above = portrait.found.pixels[lower, 1] - portrait.found.pixels[upper, 1]
    assert (np.abs(above) * portrait.millimetres[upper] < 1.0).all()
    assert portrait.found.visible[[*upper, *lower]].all()


def test_a_head_of_ones_own_keeps_its_marks(tmp_path):
    """On a user's head, landmarks stay where they were placed, if nothing covers them.

    Those of the jaw slide.
    """
    scene = FaceScene(fit_head(*user_head().write(tmp_path)))
    with Capture(scene, CaptureOptions(size=SIZE)) as opened:
        portrait = Portrait(opened)
    marked = scene.face.marked
    fixed = [*range(17, 61), 64]
    assert np.allclose(portrait.found.points[fixed], marked[fixed])
    lips = [61, 62, 63, 65, 66, 67]  # of which some are covered
    assert norm(portrait.found.points[lips] - marked[lips], axis=1).max() < 1.0
    assert norm(portrait.found.points[:17] - marked[:17], axis=1).max() < 25.0
