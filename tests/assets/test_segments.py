"""The map of classes: every texel has a class, both sides are mirrored."""

import numpy as np
import pytest

from risorius.assets import Segment

MIRROR_SEGMENTS = {
    Segment.RIGHT_EYE: Segment.LEFT_EYE,
    Segment.RIGHT_BROW: Segment.LEFT_BROW,
    Segment.RIGHT_EAR: Segment.LEFT_EAR,
}
SEGMENT_OF_POINT = {
    "glabella": Segment.SKIN, "trichion": Segment.SKIN, "vertex": Segment.HAIR,
    "cheek_left": Segment.SKIN, "pogonion": Segment.SKIN, "gnathion": Segment.SKIN,
    "temple_right": Segment.SKIN, "zygion_left": Segment.SKIN, "sublabiale": Segment.SKIN,
    "rhinion": Segment.NOSE, "pronasale": Segment.NOSE, "alare_left": Segment.NOSE,
    "alare_right": Segment.NOSE, "nostril_roof_left": Segment.NOSE,
    "cervicale": Segment.NECK,
}  # fmt: skip


def at(head, vertices):
    """The classes at vertices."""
    size = len(head.segments)
    columns, rows = (head.uv[np.atleast_1d(vertices)] * [size, -size] + [0.0, size]).astype(int).T
    return head.segments[rows, columns].tolist()


def test_every_texel_has_a_class(head):
    """Every texel has a class of skin: none is background, ignored, or clothing."""
    assert head.segments.shape == head.albedo.shape[:2]
    assert set(np.unique(head.segments)) == set(Segment) - {
        Segment.BACKGROUND, Segment.FACIAL_HAIR, Segment.CLOTHING, Segment.GLASSES,
            Segment.FACE_WEAR, Segment.IGNORE,
    }  # fmt: skip


def test_the_right_half_is_the_left_one_mirrored(head):
    """A mirrored texel has the class of the subject's other side; left is at large u."""
    mirrored = head.segments[:, ::-1]
    expected = head.segments.copy()
    for right, left in MIRROR_SEGMENTS.items():
        expected[head.segments == right] = left
        expected[head.segments == left] = right
        assert np.nonzero(head.segments == left)[1].min() >= head.segments.shape[1] // 2
    assert np.array_equal(mirrored, expected)


@pytest.mark.parametrize("place", list(SEGMENT_OF_POINT))
def test_named_points_have_the_class_of_their_region(head, place):
    """Anatomical points well within a region have the region's class."""
    assert at(head, head.anatomy[place]) == [SEGMENT_OF_POINT[place]]


def test_lips_ears_and_lids_follow_their_rows(head):
    """The red has the class of its lip, and the mouth begins behind it; the helix is ear."""
    # Without corners and middle.
    upper = slice(1, 5)
    lower = slice(10, 14)
    for row in (3, 4):
        ring = head.rings[f"mouth_{row}_left"]
        assert set(at(head, ring[upper])) == {Segment.TOP_LIP}
        assert set(at(head, ring[lower])) == {Segment.BOTTOM_LIP}
    assert set(at(head, head.rings["mouth_1_right"])) == {Segment.MOUTH_INTERIOR}
    assert set(at(head, head.rings["mouth_7_right"])) == {Segment.SKIN}
    assert set(at(head, head.rings["ear_2_right"][1:12])) == {Segment.RIGHT_EAR}
    assert set(at(head, head.rings["eye_3_left"])) == {Segment.SKIN}
    assert set(at(head, head.rings["rim_left"])) == {Segment.NECK}
