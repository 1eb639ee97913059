"""Texture coordinates: one flat piece, not folded, little stretched, mirror-symmetric."""

import numpy as np
from numpy.linalg import norm

from tests.meshes import flat_cross

TUCKED_ROWS = ("mouth_0", "mouth_1", "eye_0")  # behind lips and lids, hidden at rest


def signed_areas(flat, faces):
    """Twice the area of flat triangles, positive for counter-clockwise ones."""
    first, second = (flat[faces[:, k]] - flat[faces[:, 0]] for k in (1, 2))
    return flat_cross(first, second)


def stretches(head):
    """Largest and smallest scale of each face in the picture [1/m], shape (F, 2)."""
    corner = head.vertices[head.faces]
    flat = head.uv.astype(np.float64)[head.face_uv]
    along = corner[:, 1] - corner[:, 0]
    length = norm(along, axis=1)
    second = corner[:, 2] - corner[:, 0]
    edges = np.zeros((len(corner), 2, 2))
    edges[:, 0, 0] = length
    edges[:, 0, 1] = (along * second).sum(axis=1) / length
    edges[:, 1, 1] = norm(np.cross(along, second), axis=1) / length
    pictured = np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
    jacobian = 1000.0 * pictured @ np.linalg.inv(edges)
    return np.asarray(np.linalg.svd(jacobian, compute_uv=False))


def seen_in_front(head):
    """Flags of visible faces in the face, shape (F,); tucked-in faces are left out."""
    tucked = [head.rings[f"{row}_{side}"] for row in TUCKED_ROWS for side in ("left", "right")]
    _, y, z = head.vertices[head.faces].mean(axis=1).T
    in_front = (z > 62.0) & (y < 62.0) & (y > -112.0)
    return in_front & ~np.isin(head.faces, np.concatenate(tucked)).any(axis=1)


def test_coordinates_are_one_piece_within_the_picture(head):
    """Every vertex has one pair of texture coordinates, with a margin for filters at the edge."""
    assert head.uv.dtype == np.float32
    assert head.uv.shape == (len(head.vertices), 2)
    assert head.face_uv.dtype == np.int32
    assert np.array_equal(head.face_uv, head.faces)
    assert head.uv.min() > 0.005
    assert head.uv.max() < 0.995


def test_no_triangle_is_turned_over(head):
    """No triangle is turned over in the picture, also not behind lips and lids."""
    assert signed_areas(head.uv.astype(np.float64), head.face_uv).min() > 0.0


def test_no_two_triangles_share_a_texel(head):
    """No two triangles share a texel: every sample is in at most one face."""
    side = 300
    covered = np.zeros((side, side), dtype=np.int64)
    for a, b, c in head.uv.astype(np.float64)[head.face_uv] * side:
        low = np.floor(np.min([a, b, c], axis=0))
        high = np.ceil(np.max([a, b, c], axis=0))
        x, y = np.meshgrid(*(np.arange(s, e) for s, e in zip(low, high, strict=True)))
        place = np.stack([x + 0.503, y + 0.507], axis=-1)  # off the lines of symmetry
        is_inside = np.ones(x.shape, bool)
        for start, end in ((a, b), (b, c), (c, a)):
            along_x, along_y = end - start
            off_x, off_y = np.moveaxis(place - start, 2, 0)
            is_inside &= along_x * off_y - along_y * off_x > 0.0
        covered[y.astype(int), x.astype(int)] += is_inside
    assert covered.max() == 1
    assert covered.mean() > 0.5


def test_face_is_hardly_stretched(head):
    """In the face a freckle's length is at most 1.5 times its width; detail is spread evenly."""
    largest, smallest = stretches(head)[seen_in_front(head)].T
    ratio = largest / smallest
    assert np.median(ratio) < 1.55
    assert np.percentile(ratio, 95) < 3.4
    assert ratio.max() < 7.8
    scale = np.sqrt(largest * smallest)
    assert np.percentile(scale, 95) < 2.35 * np.percentile(scale, 5)


def test_face_gets_more_of_the_picture_than_the_rest(head):
    """The face gets more texels than the back of the head, for details such as brow hairs."""
    scale = np.sqrt(stretches(head).prod(axis=1))
    behind = head.vertices[head.faces].mean(axis=1)[:, 2] < 10.0
    assert np.median(scale[seen_in_front(head)]) > 1.3 * np.median(scale[behind])


def test_coordinates_are_their_own_mirror_image(head):
    """u -> 1 - u maps each vertex to its mirror image."""
    assert np.abs(head.uv[head.mirror] * [-1.0, 1.0] + [1.0, 0.0] - head.uv).max() < 1e-6


def test_coordinates_are_upright(head):
    """v grows upward, u toward the subject's left."""
    at = {name: head.uv[vertex] for name, vertex in head.anatomy.items()}
    assert at["glabella"][1] > at["pronasale"][1] > at["pogonion"][1]
    assert at["cheek_left"][0] > 0.5 > at["cheek_right"][0]
