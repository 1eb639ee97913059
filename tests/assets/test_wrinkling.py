"""The map of wrinkles: furrows where skin wrinkles, and none elsewhere."""

import numpy as np
import pytest

STEEPEST_FURROW = 0.7  # slope: about 35 degrees


def texels(head, vertices):
    """The map's texels at vertices, shape (n, 4)."""
    size = len(head.wrinkles.map)
    columns, rows = (head.uv[vertices] * [size, -size] + [0.0, size]).astype(int).T
    return np.asarray(head.wrinkles.map[rows, columns])


def is_plain(found):
    """Whether none of the texels has a furrow; faint ends of furrows are tolerated."""
    slopes = np.abs(found[:, :2].astype(int) - 128)
    return bool(slopes.max() < 4 and found[:, 2].max() < 4)


def test_arrays_fit_the_head(head):
    """Arrays have the shapes and types of `Wrinkles`; directions have plausible lengths.

    All arrays are read-only.
    """
    wrinkles = head.wrinkles
    assert wrinkles.map.ndim == 3
    assert wrinkles.map.shape[2] == 4
    assert wrinkles.map.dtype == np.uint8
    assert not wrinkles.map.flags.writeable
    assert wrinkles.across.shape == (len(head.vertices), 2, 3)
    length = np.linalg.norm(wrinkles.across, axis=2)
    assert ((length == 0.0) | ((length > 0.5) & (length < 2.0))).all()
    assert 100 < (length > 0.0).any(axis=1).sum() < 0.6 * len(head.vertices)


@pytest.mark.parametrize(
    "rings",
    [
        [f"eye_{row}" for row in range(4)],
        [f"mouth_{row}" for row in range(7)],
        [f"ear_{row}" for row in range(1, 5)],
        ["nostril", "rim", "concha"],
    ],
)
def test_no_furrows_where_skin_does_not_wrinkle(head, rings):
    """Lid margins, red of the lips, ears, nostrils and the foot of the neck have no furrows."""
    for ring in rings:
        for side in ("left", "right"):
            assert is_plain(texels(head, head.rings[f"{ring}_{side}"])), ring


@pytest.mark.parametrize(("place", "slot"), [("glabella", 255), ("metopion", 0), ("nasion", 0)])
def test_furrows_follow_the_amount_of_their_own_region(head, place, slot):
    """Furrows depend on the wrinkling amount of their own region only."""
    size = len(head.wrinkles.map)
    column, row = (head.uv[head.anatomy[place]] * [size, -size] + [0.0, size]).astype(int)
    around = head.wrinkles.map[row - 12 : row + 13, column - 25 : column + 26].reshape(-1, 4)
    furrows = around[around[:, 2] > 20]
    assert len(furrows) > 20
    assert (furrows[:, 3] == slot).mean() > 0.95


def test_none_behind_the_face(head):
    """Scalp, nape and throat have no furrows."""
    _, y, z = head.vertices.T
    assert is_plain(texels(head, np.flatnonzero((z < 10.0) | (y > 78.0) | (y < -125.0))))


def test_furrows_are_no_cliffs(head):
    """Very few slopes are cut off at the limits of a byte, and few are steep."""
    slopes = np.abs(head.wrinkles.map[..., :2].astype(int) - 128)
    assert (slopes > 126).sum() < 10
    assert (slopes > 127 * STEEPEST_FURROW).mean() < 1e-4


def test_left_and_right_are_not_alike(head):
    """Left and right furrows differ, but are in the same regions; their directions are mirrored."""
    across = head.wrinkles.across
    mirrored = across[head.mirror] * [-1.0, 1.0, 1.0]
    same_way = np.sign((mirrored * across).sum(axis=2, keepdims=True))  # an axis has no sign
    np.testing.assert_allclose(same_way * mirrored, across, atol=1e-4)
    depth = head.wrinkles.map[..., 2].astype(float)
    half = depth.shape[1] // 2
    left = depth[:, half:]
    right = depth[:, :half][:, ::-1]
    assert 0.5 < left.sum() / right.sum() < 2.0
    assert np.abs(left - right).sum() > 0.3 * (left + right).sum()


def test_the_fold_of_the_cheek_runs_whole(head):
    """In the fold of the cheek, slopes change little from texel to texel.

    A jump would be visible on other heads, whose triangle edges are elsewhere.
    """
    wrinkles = head.wrinkles
    size = len(wrinkles.map)
    slopes = (wrinkles.map[..., :2].astype(float) - 128.0) * (wrinkles.steepest / 127.0)
    for landmark, outward in ((48, -1), (54, 1)):
        column, row = (head.uv[head.landmarks[landmark]] * [size, -size] + [0.0, size]).astype(int)
        left, right = sorted((column + 10 * outward, column + 60 * outward))
        fold = slopes[row - 60 : row + 20, left:right]
        steps = [np.abs(np.diff(fold, axis=axis)).max() for axis in (0, 1)]
        assert max(steps) < 0.3 * np.abs(fold).max()
