"""The oil on a face, which makes skin shine: much in the middle of the face, little on the neck.

Sebum is measured at sites, and a map interpolates between them. It is highest on forehead, nose and
chin, and lower on the cheeks (Youn and others 2005, "Regional and seasonal variations in facial
sebum secretions", Skin Research and Technology 11:189-195); it falls from the middle to the sides
(Pagnoni and others 1994, "Determination of density of follicles on various regions of the face",
J. Society of Cosmetic Chemists). The order of the sites comes from these measurements. How much
they differ is chosen by eye.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ..geometry.arrays import Floats32, Floats64, Integers32
from ..geometry.read_only import read_only
from .data_files import Image

MAP_SIZE = 40  # [texels]; oil changes slowly
# Oil relative to the forehead's.
FOREHEAD = 1.0
NOSE = 1.0
CHIN = 0.8
CHEEK = 0.55
SIDE = 0.4  # temple, and the cheek in front of the ear
EAR = 0.3
NECK = 0.15
CROWN = 0.3


class Marked(Protocol):
    """A head with landmarks and texture coordinates; see `Head`."""

    @property
    def vertices(self) -> Floats64: ...
    @property
    def landmarks(self) -> Integers32: ...
    @property
    def uv(self) -> Floats32: ...
    @property
    def faces(self) -> Integers32: ...
    @property
    def face_uv(self) -> Integers32: ...


def oil_of(head: Marked, stubble: Floats32 | None = None) -> Image:
    """Return the oil on a head in the layout of its texture, 255 on the forehead, (H, W), uint8.

    stubble: its density in the layout of the texture, 0 to 1, (MAP_SIZE, MAP_SIZE). Hairs scatter
    the highlight, or dark stubble on a chin would have a white patch.
    """
    from scipy.spatial import cKDTree  # slow to import, and a head loads without it

    marks = head.vertices[head.landmarks]
    places, amounts = _sites(marks)
    vertices = np.zeros(len(head.uv), np.int64)  # of each row of `uv`
    vertices[head.face_uv] = head.faces
    nose = float(np.linalg.norm(marks[27] - marks[33]))
    oil = _mixed(head.vertices, places, amounts, 0.2 * nose)[vertices]
    # Each texel mixes the nearest vertices in the texture; this is faster than drawing triangles.
    row, column = np.mgrid[:MAP_SIZE, :MAP_SIZE].reshape(2, -1)
    texels = np.column_stack([column + 0.5, MAP_SIZE - row - 0.5]) / MAP_SIZE
    away, beside = cKDTree(head.uv).query(texels, k=min(4, len(oil)))
    weights = 1.0 / np.square(away * MAP_SIZE + 0.3)
    mixed = (weights * oil[beside]).sum(axis=1) / weights.sum(axis=1)
    if stubble is not None:
        scattered_share = 0.7  # of the highlight, in dense stubble; chosen by eye
        mixed *= 1.0 - scattered_share * stubble.ravel()
    return read_only(np.rint(255.0 * mixed).astype(np.uint8).reshape(MAP_SIZE, MAP_SIZE))


def _mixed(points: Floats64, places: Floats64, amounts: Floats64, blur: float) -> Floats64:
    """Interpolate amounts (k,) at places (k, 3) [mm] at points (n, 3), shape (n,).

    The weights fall with the fourth power of the distance (Shepard 1968, "A two-dimensional
    interpolation function for irregularly-spaced data"), but hardly within `blur` [mm].
    """
    # |p - q|^2 = |p|^2 + |q|^2 - 2 p q
    point_squares = np.square(points).sum(axis=1)
    place_squares = np.square(places).sum(axis=1)
    squares = point_squares[:, None] + place_squares
    squared_distances = np.maximum(squares - 2.0 * points @ places.T, 0.0)
    weights = 1.0 / np.square(squared_distances + blur**2)
    return np.asarray(weights @ amounts / weights.sum(axis=1))


def _sites(marks: Floats64) -> tuple[Floats64, Floats64]:
    """Return the places of sites, (n, 3) [mm], and their oil, (n,); marks: landmarks, (68, 3)."""
    nasion = marks[27]
    base = marks[33]
    up = nasion - base
    brows = marks[[19, 24]].mean(axis=0)
    ears = marks[[0, 16]]
    middle = ears.mean(axis=0)
    found = [
        (brows + 0.7 * up - 0.1 * (nasion - middle), FOREHEAD),
        (brows, FOREHEAD),
        (marks[30], NOSE),
        (marks[28], NOSE),
        (marks[[8, 57]].mean(axis=0), CHIN),
        (middle + 3.0 * up, CROWN),
        (middle - 2.0 * up, NECK),
        (marks[8] - 0.8 * up + 0.5 * (middle - nasion), NECK),
    ]
    # Landmarks of the right and of the left half, and the neighbours of `brow` and `jaw` on it.
    for eye, lid, wing, side, corner, jaw, upper_jaw, brow, inner_brow in (
        (36, 40, 31, 0, 48, 4, 3, 17, 18),
        (45, 47, 35, 16, 54, 12, 13, 26, 25),
    ):
        outward = marks[side] - middle
        found += [
            (marks[inner_brow] + 0.5 * up, FOREHEAD),
            (marks[[eye, lid, wing]].mean(axis=0), CHEEK),
            (marks[[eye, corner, upper_jaw]].mean(axis=0), CHEEK),
            (marks[[jaw, corner]].mean(axis=0), CHEEK),
            (marks[jaw], SIDE),
            (marks[side] + 0.2 * (marks[30] - middle), SIDE),
            (marks[brow] + 0.4 * up + 0.3 * (middle - nasion), SIDE),
            (marks[side] + 0.15 * outward - 0.2 * (nasion - middle), EAR),
            (marks[jaw] - 0.8 * up + 0.5 * (middle - nasion), NECK),
        ]
    places, amounts = zip(*found, strict=True)
    return np.array(places), np.array(amounts)
