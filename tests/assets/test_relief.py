"""The relief of ears and neck in the maps of slopes and of light."""

import numpy as np
import scipy.ndimage

from risorius.geometry.gradients import TextureGradients

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
    """Normals bend alike on both sides of an edge, and on the edge, so no line shows on the neck.

    On the edge the map is filtered, which mixes slopes from both sides.
    """
    left = np.array([(193, 65), (193, 147), (193, 148), (193, 242)])
    for edge in np.vstack([left, head.mirror[left]]):
        faces = np.flatnonzero(np.isin(head.faces, edge).sum(axis=1) == 2)
        first, second = (_bends_beside(head, face, edge, 1.5) for face in faces)
        assert _degrees_between(first, second) < 1.5, edge
        for face in faces:
            on_edge = _bends_beside(head, face, edge, 0.0)
            assert _degrees_between(on_edge, (first + second) / 2.0) < 1.5, edge


def _degrees_between(first, second):
    """Mean angle between small bends (9, 3) [rad]."""
    return np.degrees(np.linalg.norm(first - second, axis=1).mean())


def _bends_beside(head, face, edge, distance):
    """Bends of the normal in a triangle, `distance` [texels] beside an edge, (9, 3) [rad].

    As in pictures, gradients of texture coordinates are interpolated between vertices.
    """
    fine = head.fine_shape
    size = len(fine.slopes)
    numbers = head.face_uv[face]
    corners = head.uv[numbers].astype(float)
    ends = corners[[list(head.faces[face]).index(vertex) for vertex in edge]]
    places = ends[0] + np.linspace(0.15, 0.85, 9)[:, None] * (ends[1] - ends[0])
    inward = corners.mean(axis=0) - places
    places += inward * distance / (size * np.linalg.norm(inward, axis=1, keepdims=True))
    at = size * (places * [1, -1] + [0, 1]) - 0.5
    slopes = (fine.slopes - 128.0) * (fine.steepest / 127.0)
    sampled = [
        scipy.ndimage.map_coordinates(slopes[..., axis], at.T[::-1], order=1) for axis in (0, 1)
    ]
    # Barycentric coordinates of the places have the sum 1.
    corner_rows = np.vstack([corners.T, np.ones(3)])
    place_rows = np.vstack([places.T, np.ones(9)])
    weights = np.linalg.solve(corner_rows, place_rows)
    gradients = TextureGradients(head.faces, head.uv, head.face_uv)
    of_corners = gradients.measure(head.vertices.astype(float))[numbers].reshape(3, 2, 3)
    return np.einsum("kn,cn,cki->ni", np.array(sampled), weights, of_corners)
