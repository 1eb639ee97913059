"""The relief of ears and neck in the maps of slopes and of light."""

import numpy as np
import scipy.ndimage

EAR_PLACES = {  # height and depth on the left ear [mm]
    "stem of the antihelix": (-22.0, -15.3),
    "upper crus": (-8.0, -12.4),
    "lower crus": (-11.0, -7.0),
    "fossa between the crura": (-6.5, -8.0),
    "groove before the helix": (-17.0, -19.4),
}


def _texel(head, fine, place, size):
    """Row and column of the left ear's outer side at a height and a depth [mm]."""
    outer = np.flatnonzero((fine.vertices[:, 0] > 60.0) & (fine.normals[:, 0] > 0.2))
    off = fine.vertices[outer][:, 1:] - place
    u, v = fine.interpolate(head.uv)[outer[(off**2).sum(axis=1).argmin()]]
    return int((1.0 - v) * size), int(u * size)


def test_an_antihelix_parts_into_two_crura(head):
    """The antihelix divides into two crura; they and its stem are light.

    The fossa between them, and the groove beside them, are dark.
    """
    fine = head.finer(2)
    light = head.ambient_occlusion
    found = {
        name: int(light[_texel(head, fine, place, len(light))])
        for name, place in EAR_PLACES.items()
    }
    hollows = found.pop("fossa between the crura"), found.pop("groove before the helix")
    assert min(found.values()) > max(hollows) + 25


def test_a_muscle_stands_out_of_each_side_of_the_neck(head):
    """Across the muscle on each side of the neck, slopes rise and fall, equally on both sides."""
    slopes = head.fine_shape.slopes[..., 0].astype(int) - 128
    row = slopes[930]
    left = row[512:]
    assert left.max() > 15
    assert left.min() < -15
    np.testing.assert_allclose(row[::-1][512:], -left, atol=2)


def test_shading_crosses_the_edges_of_the_neck(head):
    """~alike on both sides of an edge, so no triangle shows on the neck.

    => equally on both sides of an edge, so no triangle is visible.
    """
    left = np.array([(193, 65), (193, 147), (193, 148), (193, 242)])
    for edge in np.vstack([left, head.mirror[left]]):
        faces = np.flatnonzero(np.isin(head.faces, edge).sum(axis=1) == 2)
        first, second = (_bends_beside(head, face, edge) for face in faces)
        apart = np.degrees(np.linalg.norm(first - second, axis=1).mean())
        assert apart < 3.0, edge


def _bends_beside(head, face, edge):
    """Bends of the normal within a triangle, 1.5 texels beside an edge, (9, 3) [rad]."""
    fine = head.fine_shape
    size = len(fine.slopes)
    corners = head.uv[head.face_uv[face]].astype(float)
    ends = corners[[list(head.faces[face]).index(vertex) for vertex in edge]]
    places = ends[0] + np.linspace(0.15, 0.85, 9)[:, None] * (ends[1] - ends[0])
    inward = corners.mean(axis=0) - places
    places += inward * 1.5 / (size * np.linalg.norm(inward, axis=1, keepdims=True))
    at = size * (places * [1, -1] + [0, 1]) - 0.5
    slopes = (fine.slopes - 128.0) * (fine.steepest / 127.0)
    sampled = [
        scipy.ndimage.map_coordinates(slopes[..., axis], at.T[::-1], order=1) for axis in (0, 1)
    ]
    sides = np.diff(head.vertices[head.faces[face]], axis=0)
    gradients = np.linalg.pinv(sides) @ np.diff(corners, axis=0)
    return np.array(sampled).T @ gradients.T
