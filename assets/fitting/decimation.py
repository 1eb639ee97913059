"""Fewer triangles for the same form, by quadric error metrics, in a well-kept library.

Source: Garland and Heckbert 1997, "Surface simplification using quadric error metrics".
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..model import FloatArray, IndexArray

UNEVEN = 5e-5  # of the mesh's size: 0.01 mm on a head


def decimated(
    vertices: FloatArray, faces: npt.NDArray[np.int32], count: int, attempt: int = 0
) -> tuple[FloatArray, IndexArray]:
    """Other vertices and about `count` triangles; the edges of openings stay where they are.

    It may pinch the surface, so that three triangles meet at an edge: then another `attempt`
    comes out otherwise.
    """
    import fast_simplification  # dense meshes alone need it

    # On a plane, as subdivided polygons are, any place would do: it would take one for many.
    uneven = np.random.default_rng(attempt).uniform(-UNEVEN, UNEVEN, vertices.shape)
    points, triangles = fast_simplification.simplify(
        np.ascontiguousarray(vertices + uneven * np.ptp(vertices, axis=0).max()),
        np.array(faces, np.int32),  # one that it may write into
        target_count=count,
        preserve_border=True,
    )
    return np.asarray(points, np.float64), np.asarray(triangles, np.int32)
