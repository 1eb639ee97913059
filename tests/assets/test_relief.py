"""The relief of ears and neck in the maps of slopes and of light."""

import numpy as np

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
