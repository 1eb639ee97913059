"""Anatomy on the skin: landmarks, names, rows, bone data."""

import numpy as np
import pytest

from risorius.geometry.sides import side_lengths, sides_of

# Pairs of a right and a left landmark, read from the iBug figure.
PAIRS = (
    [(k, 16 - k) for k in range(8)]
    + [(17, 26), (18, 25), (19, 24), (20, 23), (21, 22), (31, 35), (32, 34)]
    + [(36, 45), (37, 44), (38, 43), (39, 42), (40, 47), (41, 46)]
    + [(48, 54), (49, 53), (50, 52), (59, 55), (58, 56), (60, 64), (61, 63), (67, 65)]
)
ON_MIDLINE = (8, 27, 28, 29, 30, 33, 51, 57, 62, 66)


def test_landmarks_are_68_different_vertices(head):
    """No landmark is missing, and no two have the same vertex."""
    assert len(set(head.landmarks.tolist())) == 68
    assert head.landmarks.min() >= 0
    assert head.landmarks.max() < len(head.vertices)


def test_landmarks_are_mirrored(head):
    """Pairs of landmarks are mirror images; right ones have x < 0, unpaired ones x = 0."""
    for right, left in PAIRS:
        assert head.mirror[head.landmarks[left]] == head.landmarks[right]
        assert head.vertices[head.landmarks[right], 0] < 0.0
    assert np.all(head.vertices[head.landmarks[list(ON_MIDLINE)], 0] == 0.0)
    assert len(PAIRS) * 2 + len(ON_MIDLINE) == 68


def test_landmarks_lie_where_the_scheme_says(head):
    """Landmarks are in order along jaw, brow and nose, and in rows around eyes and lips."""
    at = head.vertices[head.landmarks]
    assert np.all(np.diff(at[0:17, 0]) > 0)  # from the right ear to the left
    assert at[8, 1] == at[0:17, 1].min()
    assert np.all(np.diff(at[17:27, 0]) > 0)
    assert np.all(np.diff(at[27:31, 1]) < 0)
    assert at[30, 2] == at[:, 2].max()
    assert np.all(np.diff(at[31:36, 0]) > 0)
    assert at[42, 0] < at[43, 0] < at[44, 0] < at[45, 0]
    assert at[45, 0] > at[46, 0] > at[47, 0]
    assert min(at[43, 1], at[44, 1]) > max(at[46, 1], at[47, 1])
    assert at[51, 1] > at[62, 1] > at[66, 1] - 0.2 > at[57, 1]
    assert at[50, 1] > at[51, 1]  # Cupid's bow


def test_lip_landmarks_lie_on_the_lip_rows(head):
    """Outer lip landmarks lie on the border of the red, inner ones where the lips meet.

    The corners lie between both.
    """
    outer = [*range(49, 54), *range(55, 60)]
    for numbers, row in ((outer, "mouth_6"), ((48, 54), "mouth_3"), (range(60, 68), "mouth_2")):
        on_row = {*head.rings[f"{row}_left"].tolist(), *head.rings[f"{row}_right"].tolist()}
        assert {int(head.landmarks[number]) for number in numbers} <= on_row


def test_the_mouth_ends_at_the_corners_of_the_lips(head):
    """Landmarks 48 and 54 are at the mouth's anatomical corners, slightly outside 60 and 64."""
    corners = [head.anatomy[f"cheilion_{side}"] for side in ("right", "left")]
    assert head.landmarks[[48, 54]].tolist() == corners
    wide, red = (np.ptp(head.vertices[head.landmarks[pair], 0]) for pair in ([48, 54], [60, 64]))
    assert red < wide < red + 4.0


def test_lid_landmarks_lie_on_the_lid_margin(head):
    """All twelve lid landmarks are on the lid margins of their own eye."""
    for numbers, side in ((range(36, 42), "right"), (range(42, 48), "left")):
        margin = set(head.rings[f"eye_2_{side}"].tolist())
        assert {int(head.landmarks[number]) for number in numbers} <= margin


def test_anatomy_has_both_sides(head):
    """Every point _left has its mirror image _right; all other points lie in the mid-plane."""
    assert {"glabella", "nasion", "pronasale", "subnasale", "pogonion"} <= set(head.anatomy)
    for name, vertex in head.anatomy.items():
        if name.endswith("_left"):
            opposite = head.anatomy[f"{name.removesuffix('_left')}_right"]
            assert head.mirror[vertex] == opposite
            assert head.vertices[vertex, 0] > 0.0
        elif not name.endswith("_right"):
            assert head.vertices[vertex, 0] == 0.0, name


def test_rows_exist_on_both_sides(head):
    """The columns of all rows around an opening correspond."""
    for name, row in head.rings.items():
        if name.endswith("_left"):
            assert np.array_equal(
                head.mirror[row], head.rings[f"{name.removesuffix('_left')}_right"]
            )
    assert {len(head.rings[f"eye_{row}_left"]) for row in range(5)} == {20}
    assert {len(head.rings[f"ear_{row}_left"]) for row in range(5)} == {16}
    assert {len(head.rings[f"mouth_{row}_left"]) for row in range(8)} == {15}


def test_bone_depth_has_the_chosen_values(head):
    """Bone is near the surface at nose bridge and forehead, deep in the cheek; sides are equal."""
    depth = head.bone_depth
    anatomy = head.anatomy
    assert depth.min() > 2.0
    assert depth.max() < 30.0
    assert np.allclose(depth, depth[head.mirror])
    chosen = {
        "glabella": 5.5, "nasion": 6.5, "rhinion": 3.0, "subnasale": 13.0, "sublabiale": 11.0,
        "pogonion": 11.5, "gnathion": 8.5, "menton": 7.0, "orbitale_left": 7.0,
        "zygion_left": 8.0, "gonion_left": 13.0,
    }  # fmt: skip
    for name, expected in chosen.items():
        assert depth[anatomy[name]] == pytest.approx(expected, abs=1.5), name
    assert depth[anatomy["cheek_left"]] > 2.0 * depth[anatomy["glabella"]]


def test_mandible_carries_lower_lip_and_chin_only(head):
    """The mandible's weight is 1 at lower lip and chin, and 0 from the upper lip upward.

    At the corners of the mouth it is between 0 and 1.
    """
    weight = head.mandible_weight
    rings = head.rings
    assert weight.min() == 0.0
    assert weight.max() <= 1.0
    assert np.allclose(weight, weight[head.mirror])
    for name in ("pogonion", "gnathion", "menton", "sublabiale", "labiale_inferius"):
        assert weight[head.anatomy[name]] > 0.95, name
    for name in ("subnasale", "labiale_superius", "alar_base_left", "zygion_left", "vertex"):
        assert weight[head.anatomy[name]] < 0.05, name
    for row in range(2, 7):
        along = weight[rings[f"mouth_{row}_left"]]
        assert np.all(np.diff(along) > -0.02)
        assert 0.2 < along[7] < 0.6
    assert weight[head.vertices[:, 1] > -20.0].max() == 0.0


def test_mandible_weight_is_smooth(head):
    """The mandible's weight changes by at most 0.07 per millimetre between neighbours."""
    edges = sides_of(head.faces)
    step = np.abs(np.diff(head.mandible_weight[edges], axis=1)[:, 0])
    length = side_lengths(head.vertices, edges)
    assert step.max() < 0.6
    assert (step / length)[length > 3.0].max() < 0.07


def test_jaw_axis_runs_through_both_condyles(head):
    """The right condyle comes first; both lie in front of the ear, below the skin."""
    right, left = head.jaw_axis
    assert np.array_equal(right * [-1.0, 1.0, 1.0], left)
    assert left[0] > 0.0
    tragion = head.vertices[head.anatomy["tragion_left"]]
    assert 5.0 < left[2] - tragion[2] < 25.0
    assert abs(left[1] - tragion[1]) < 10.0
    assert 10.0 < tragion[0] - left[0] < 25.0
