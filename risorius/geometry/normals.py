"""Cross products of triangles, points on them, normals and areas of vertices, in double precision.

Refiners compute the normals of every frame by another kernel, in single precision
(refine/mesh/normals.py).
"""

import numpy as np
import numpy.typing as npt

from .arrays import Floats64
from .directions import unit_vectors


def cross_products(vertices: npt.NDArray[np.floating], faces: npt.NDArray[np.integer]) -> Floats64:
    """Face normals times twice the area, shape (F, 3)."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


def vertex_normals(vertices: Floats64, faces: npt.NDArray[np.integer]) -> Floats64:
    """Area-weighted unit normals of vertices, shape (V, 3); zero at vertices without faces."""
    cross = cross_products(vertices, faces)
    corners = faces.T.ravel()
    total = np.stack(
        [np.bincount(corners, np.tile(each, 3), len(vertices)) for each in cross.T], axis=1
    )
    return unit_vectors(total)


def vertex_areas(vertices: Floats64, faces: npt.NDArray[np.integer]) -> Floats64:
    """Return a third of the area of the triangles around each vertex, shape (V,)."""
    face_areas = np.linalg.norm(cross_products(vertices, faces), axis=1) / 2.0
    thirds = np.tile(face_areas / 3.0, 3)
    return np.asarray(np.bincount(faces.T.ravel(), thirds, len(vertices)), np.float64)


def points_on_triangles(points: Floats64, faces: npt.NDArray[np.integer]) -> Floats64:
    """Return 28 points all over each triangle (F, 3), on its corners and edges too, (28 F, 3)."""
    sixths = [(i, j, 6 - i - j) for i in range(7) for j in range(7 - i)]  # barycentric coordinates
    corners = points[faces]
    spread = [np.einsum("fcx,c->fx", corners, np.array(place) / 6.0) for place in sixths]
    return np.concatenate(spread)
