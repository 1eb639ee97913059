"""How much of the light from all around hair takes away from the skin.

After Zhukov, Iones, Kronin 1998, "An ambient light illumination model": what lies near shades by
the angle that it fills, and less the farther it is. `app/scenes/ambient_occlusion.py` casts rays at
the skin alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from ...data_files import Image
from ...model import IndexArray, Part
from ...smooth import Points, Values, unit
from ...topology import places_in_triangle

REACH = 35.0  # [mm] beyond which hair does not shade
LAYERS = 2.5  # of hair over one place, on average, which shade as one
LEAST = 0.25  # of the light, that gets to skin under hair
SIZE = 192  # of the picture that is painted: what is shaded is soft
SAMPLES = 12  # places along an edge of a triangle


def shaded(
    ambient_occlusion: Image,
    hair: Sequence[Part],
    vertices: Points,
    normals: Points,
    faces: IndexArray,
    places: Points,
) -> Image:
    """A picture of how open skin is to light (H, W), 255 = all, darker near hair.

    vertices, normals, faces: of the skin. places: texture coordinates of corners, (F, 3, 2).
    """
    from PIL import Image as Pictures

    values = _open(hair, vertices, normals)[faces]
    weights = places_in_triangle(SAMPLES)
    column, row = np.einsum("kc,fcx->xfk", weights, places).reshape(2, -1) * SIZE
    texel = np.clip(SIZE - 1 - row.astype(int), 0, SIZE - 1) * SIZE
    texel += np.clip(column.astype(int), 0, SIZE - 1)
    count = np.bincount(texel, minlength=SIZE * SIZE)
    total = np.bincount(texel, (values @ weights.T).ravel(), SIZE * SIZE)
    # Between the patches of the texture, what is nearest.
    nearest = scipy.ndimage.distance_transform_edt(
        (count == 0).reshape(SIZE, SIZE), return_distances=False, return_indices=True
    )
    painted = (total / np.maximum(count, 1)).reshape(SIZE, SIZE)[tuple(nearest)]
    height, width = ambient_occlusion.shape
    finer = Pictures.fromarray(painted.astype(np.float32)).resize(
        (width, height), Pictures.Resampling.BICUBIC
    )
    shade = np.clip(np.asarray(finer, dtype=np.float32), 0.0, 1.0)
    return np.asarray(np.round(ambient_occlusion * shade), dtype=np.uint8)


def _open(hair: Sequence[Part], vertices: Points, normals: Points) -> Values:
    """How much light from all around hair lets through to vertices, 0 to 1, shape (V,)."""
    corners = np.vstack([part.vertices[part.faces] for part in hair]).astype(np.float64)
    middles = corners.mean(axis=1)
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    tree = scipy.spatial.cKDTree(middles)
    taken = np.zeros(len(vertices))
    for vertex, near in enumerate(tree.query_ball_point(vertices, REACH)):
        if not near:
            continue
        away = middles[near] - vertices[vertex]
        far = np.linalg.norm(away, axis=1)
        cosine = np.maximum(unit(away) @ normals[vertex], 0.0)
        size = 0.5 * area[near]
        filled = cosine * size / (np.pi * (far**2 + size))
        taken[vertex] = (filled * (1.0 - far / REACH)).sum() / LAYERS
    return np.asarray(np.maximum(1.0 - taken, LEAST))
