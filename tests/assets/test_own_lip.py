"""Full lips, where one covers the other: each keeps its own colour and bone."""

import numpy as np

from risorius.assets.fitting import fit
from risorius.assets.meshes import Mesh
from risorius.geometry.mesh_graph import path_lengths


def test_overlapping_lips_keep_bone_and_colour(head):
    """A lower lip 3 mm higher and 4 mm in front moves with the jaw.

    Its texture is that of the lip, red and not dark.
    """
    upper, lower = (
        path_lengths(head.vertices, head.faces, head.landmarks[lip]).min(axis=0)
        for lip in (slice(61, 64), slice(65, 68))
    )
    is_lower = lower < upper
    reach = 12.0  # [mm], size of the lip
    share = np.where(is_lower, np.clip(1.0 - lower / reach, 0.0, 1.0), 0.0)
    full = head.vertices + share[:, None] * [0.0, 3.0, 4.0]
    fitted = fit(Mesh(full, head.faces), head.landmarks)
    lip = np.flatnonzero((share > 0.2)[fitted.file_vertices])
    own = fitted.file_vertices[lip]
    assert np.abs(fitted.mandible_weight[lip] - head.mandible_weight[own]).max() < 0.2
    assert np.abs(fitted.uv[lip] - head.uv[own]).max() < 0.01
