"""Which point of the skin each texel of the left half shows, and what it is near to.

The picture is painted where its texels lie on the face, in millimetres, with the same functions
that made the face: so a line of hair or lip is as wide as it should be, however the texture
coordinates stretch, and no triangle of the mesh shows in it.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..model import Head
from ..topology import Faces
from .ear_rows import ROWS as EAR_ROWS
from .fields import Points, Values
from .mouth_rows import OUTER_ROW, SIDE
from .sections import direction_coordinates

EYE_ROWS = 5
NOSTRIL_DEPTH = 2  # edges from the rim of a nostril to its roof


@dataclass(frozen=True)
class Texels:
    """The texels of the left half that show skin, n of them.

    rows, columns: place in the picture, shape (n,); row 0 on top.
    points: place on the skin [mm], shape (n, 3).
    angle: about the head's axis [deg], shape (n,).
    height: along the head's capsule [mm], shape (n,).
    eye_row: 0 behind the lid, 1 to 2 on its margin, 4 in the crease, 5 beyond, shape (n,).
    is_upper_lid: share of the upper lid, 0 to 1, shape (n,).
    mouth_row: 0 to 2 behind the lips, 6 on the border of the red, 8 beyond, shape (n,).
    is_upper_lip: share of the upper lip, 0 to 1, shape (n,).
    nostril: 0 on the outside to 1 at the roof, shape (n,).
    ear_row: 0 outside and at the ear's root, 1 to 2 on the helix, 4 around the concha, 5 in it,
        shape (n,).
    """

    rows: npt.NDArray[np.int64]
    columns: npt.NDArray[np.int64]
    points: Points
    angle: Values
    height: Values
    eye_row: Values
    is_upper_lid: Values
    mouth_row: Values
    is_upper_lip: Values
    nostril: Values
    ear_row: Values


def corner_values(head: Head) -> npt.NDArray[np.float64]:
    """Eye row, upper lid, mouth row, upper lip, nostril and ear row of every vertex, shape (V, 6).

    The right half holds what lies beyond all rows: only the left one is painted.
    """
    values = np.zeros((len(head.vertices), 6))
    values[:, 0], values[:, 2] = EYE_ROWS, OUTER_ROW + 1
    for row in range(EYE_ROWS):
        ring = head.rings[f"eye_{row}_left"]
        values[ring, 0] = row
        column = np.arange(len(ring)) / len(ring)
        values[ring, 1] = np.where(column < 0.5, 1.0, 0.0)
        values[ring[[0, len(ring) // 2]], 1] = 0.5  # the corners
    for row in range(OUTER_ROW + 1):
        ring = head.rings[f"mouth_{row}_left"]
        values[ring, 2] = row
        values[ring, 3] = 0.5 - 0.5 * np.sign(np.arange(len(ring)) - SIDE)
    reached = np.array([head.anatomy["nostril_roof_left"]])
    for step in range(NOSTRIL_DEPTH):
        values[reached, 4] = np.maximum(values[reached, 4], 1.0 - step / NOSTRIL_DEPTH)
        reached = np.unique(head.faces[np.isin(head.faces, reached).any(axis=1)])
    for row in range(1, EAR_ROWS):
        values[np.setdiff1d(head.rings[f"ear_{row}_left"], head.rings["ear_0_left"]), 5] = row
    values[head.rings["concha_left"], 5] = EAR_ROWS
    return values


def rasterise(
    flat: npt.NDArray[np.float64], faces: Faces, size: int
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[np.float64]]:
    """Texel numbers, faces and barycentric weights of all texel centres that lie in a face.

    flat: texture coordinates in texels, row 0 on top, shape (V, 2). A texel belongs to one face.
    """
    owner = np.full((size, size), -1, dtype=np.int64)
    share = np.zeros((size, size, 3))
    for number, corner in enumerate(flat[faces]):
        low = np.maximum(np.floor(corner.min(axis=0) - 0.5).astype(int), 0)
        high = np.minimum(np.ceil(corner.max(axis=0) + 0.5).astype(int), size)
        x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
        (ax, ay), (bx, by), (cx, cy) = corner
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        second = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        third = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        weights = np.stack([1.0 - second - third, second, third], axis=-1)
        inside = weights.min(axis=-1) >= -1e-9
        window = slice(low[1], high[1]), slice(low[0], high[0])
        owner[window][inside] = number
        share[window][inside] = weights[inside]
    texel = np.flatnonzero(owner.ravel() >= 0)
    return texel, owner.ravel()[texel], share.reshape(-1, 3)[texel]


def left_texels(head: Head, size: int) -> Texels:
    """Find the texels of the left half of a picture of `size` x `size`."""
    left = head.faces[(head.vertices[head.faces, 0] >= 0.0).all(axis=1)]
    flat = head.uv.astype(np.float64) * [size, -size] + [0.0, size]
    texel, owner, share = rasterise(flat, left, size)
    columns = np.column_stack([head.vertices, corner_values(head)])
    values = np.einsum("nk,nkc->nc", share, columns[left[owner]])
    points = values[:, :3]
    angle, height, _ = direction_coordinates(points)
    return Texels(texel // size, texel % size, points, np.degrees(angle), height, *values[:, 3:].T)
