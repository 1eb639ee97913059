"""Light in the nostrils."""

import numpy as np

from risorius.assets.data_files import read_arrays


def test_nostrils_are_not_black(head):
    """The walls of nostrils get a quarter of the light, so that they are not black.

    Elsewhere the map is unchanged.
    """
    lit = head.ambient_occlusion.astype(int)
    given = read_arrays(head.file_beside("_ambient_occlusion.npz"))["ambient_occlusion"].astype(int)
    size = len(lit)
    for side in ("left", "right"):
        u, v = head.uv[head.anatomy[f"nostril_roof_{side}"]]
        inside = lit[int((1.0 - v) * size), int(u * size)]
        assert 45 < inside < 90
        rim = head.uv[head.rings[f"nostril_{side}"]]
        rows = ((1.0 - rim[:, 1]) * size).astype(int)
        columns = (rim[:, 0] * size).astype(int)
        assert (lit - given)[rows, columns].mean() > 15
    assert (lit >= given).all()
    changed = np.argwhere(lit != given) / size
    assert len(changed) < 0.006 * lit.size
    assert (np.abs(changed[:, 1] - 0.5) < 0.06).all()
    assert not head.ambient_occlusion.flags.writeable
