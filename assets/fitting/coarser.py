"""Fewer triangles for the same form, by quadric error metrics, in a well-kept library.

Source: Garland and Heckbert 1997, "Surface simplification using quadric error metrics".
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..model import FloatArray, IndexArray


def coarser(
    vertices: FloatArray, faces: npt.NDArray[np.int32], count: int
) -> tuple[FloatArray, IndexArray]:
    """Other vertices and about `count` triangles; the edges of openings stay where they are."""
    import fast_simplification  # dense meshes alone need it

    points, triangles = fast_simplification.simplify(
        np.array(vertices, np.float64),  # arrays that it may write into
        np.array(faces, np.int32),
        target_count=count,
        preserve_border=True,
    )
    return np.asarray(points, np.float64), np.asarray(triangles, np.int32)
