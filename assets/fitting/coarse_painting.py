"""Paint a coarse skin by the places of small triangles, because its own hide details of a face.

Texture coordinates are linear over a triangle. If a triangle is longer than details of the texture,
such as the red of lips or a brow, they slide and smear in it. So a coarse triangle is cut into
small ones. Each of these takes its part of the built-in texture from its own place on the skin, and
is drawn over the place that the coarse triangle has in the texture.

A landmark on a vertex of a coarse skin may lie half an edge beside its true place. A warp that
passes through all landmarks would give zigzag brows and lips. So the warp is smoothed, and more
where the vertices are farther apart. Landmarks that are points are exact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64, Integers32
from ...geometry.directions import unit_vectors
from ...geometry.normals import cross_products, vertex_normals
from ...geometry.sides import edges_of, side_lengths
from ..data_files import Image
from ..model import Head, Wrinkles
from ..topology import quarter
from .mesh_validation import SkinPiece
from .own_lip import nearest_own
from .painting import TextureLayout, drawn_over, maps_over, spread_uv
from .warp import landmark_warp

FIRST_OF_FACE = 17
"""The landmarks before are those of the jaw line, where nothing is painted."""


class TexturePlaces(NamedTuple):
    """Places of a skin's triangles in the built-in texture.

    own: layout of the triangles. cuts: how often they are cut into four. small: layout of the small
    triangles, which is more exact, if a skin is coarse.
    """

    own: TextureLayout
    cuts: int
    small: TextureLayout


def texture_places(
    known: Head, skin: SkinPiece, target: Floats64, are_exact: bool, uv: Floats32
) -> TexturePlaces:
    """Find the places of a skin [mm] in the built-in texture.

    target: landmarks [mm], (68, 3). are_exact: whether they are points, and not vertices. uv:
    texture coordinates of the skin's vertices in the built-in texture, (V, 2); a coarse skin gets
    others.
    """
    cuts = cuts_needed(skin)
    if not cuts:
        own = TextureLayout(uv, skin.faces)
        return TexturePlaces(own, 0, own)
    give = np.zeros(len(target)) if are_exact else smoothing_of(skin)
    warp = landmark_warp(known.vertices[known.landmarks], target, give)
    return _places_of_coarse(known, skin, warp.points(known.vertices), cuts)


def repainted(
    known: Head, skin: SkinPiece, places: TexturePlaces, picture: Image
) -> tuple[Image, tuple[Wrinkles, Image, Image]]:
    """Draw a coarse skin over its texture, and over the built-in maps (see `maps_over`).

    Triangles that have the right place in `places.own` are not drawn again. Nor is folded skin, as
    behind lips, which would hide visible skin.
    """
    drawn = small_triangles(places.own, places.cuts)
    first, second = np.diff(drawn.corners, axis=1).transpose(1, 0, 2)
    is_upright = first[:, 0] * second[:, 1] > first[:, 1] * second[:, 0]
    is_moved = (drawn.corners != places.small.corners).any(axis=(1, 2))
    normals = cross_products(skin.vertices, skin.faces)
    small_per_triangle = 4**places.cuts
    faces_forward = np.repeat(normals[:, 2] > 0.0, small_per_triangle)
    kept = is_upright & is_moved & faces_forward
    drawn = TextureLayout(drawn.uv, drawn.face_uv[kept])
    taken = TextureLayout(places.small.uv, places.small.face_uv[kept])
    return drawn_over(picture, drawn, (picture, taken)), maps_over(known, taken, drawn)


def edge_lengths_at_landmarks(skin: SkinPiece) -> Floats64:
    """Return the mean length of the edges at each landmark [mm], (68,)."""
    links = edges_of(skin.faces)
    lengths = side_lengths(skin.vertices, links)
    sums = np.bincount(links.ravel(), np.repeat(lengths, 2), len(skin.vertices))
    counts = np.bincount(links.ravel(), minlength=len(skin.vertices))
    means: Floats64 = sums[skin.landmarks] / np.maximum(counts[skin.landmarks], 1)
    return means


def cuts_needed(skin: SkinPiece) -> int:
    """Return how often to cut the triangles of a skin [mm] into four; 0 if they are small enough.

    After the cuts, edges at the landmarks of brows, nose, eyes and mouth are shorter than details.
    """
    detail = 4.0  # [mm]; about half the height of a lip's red or of a brow
    length = float(edge_lengths_at_landmarks(skin)[FIRST_OF_FACE:].mean())
    return max(int(np.ceil(np.log2(length / detail))), 0)


def smoothing_of(skin: SkinPiece) -> Floats64:
    """Return how closely a warp passes at landmarks on vertices of a skin [mm], (68,)."""
    # [1/mm]; found by comparing textures of ten simplified heads with those of their whole heads,
    # for 0 to 0.64.
    smoothing = 0.16
    return smoothing * edge_lengths_at_landmarks(skin) ** 2


def _places_of_coarse(known: Head, skin: SkinPiece, warped: Floats64, cuts: int) -> TexturePlaces:
    """Find the places of a coarse skin [mm] in the built-in texture.

    warped: vertices of the built-in head after a warp to the skin [mm], (n, 3). cuts: how often to
    cut triangles into four. Far away from brows, nose, eyes and mouth, small triangles lie linearly
    within those of the skin, because there folds of skin have the same place in the texture.
    """
    normals = vertex_normals(skin.vertices, skin.faces)
    small, small_normals = _small_skin(skin, normals, cuts)
    nearness = _nearness_to_face(skin, small.vertices)
    # Near the face, small triangles give the colours; loose vertices leave the layout fewer folds.
    loosest = 0.25
    holds = 1.0 - (1.0 - loosest) * nearness[: len(skin.vertices)]
    nearest = nearest_own(known, warped, skin, normals)
    uv = spread_uv(known, warped, nearest, (skin.vertices, normals, skin.faces), holds)
    own = TextureLayout(uv, skin.faces)
    nearest = nearest_own(known, warped, small, small_normals)
    exact = spread_uv(known, warped, nearest, (small.vertices, small_normals, small.faces))
    linear = small_triangles(own, cuts)
    blended = linear.uv + nearness[:, None].astype(np.float32) * (exact - linear.uv)
    return TexturePlaces(own, cuts, TextureLayout(blended, small.faces))


def small_triangles(layout: TextureLayout, cuts: int) -> TextureLayout:
    """Return a layout whose triangles are cut into four `cuts` times."""
    uv = layout.uv
    faces = layout.face_uv
    for _ in range(cuts):
        finer = quarter(faces, len(uv))
        uv = np.vstack([uv, uv[finer.edges].mean(axis=1)])
        faces = finer.faces
    return TextureLayout(uv, faces)


def _small_skin(skin: SkinPiece, normals: Floats64, cuts: int) -> tuple[SkinPiece, Floats64]:
    """Cut a skin's triangles into four `cuts` times; also return the normals of all vertices."""
    vertices = skin.vertices
    faces: Integers32 = skin.faces
    for _ in range(cuts):
        finer = quarter(faces, len(vertices))
        vertices = np.vstack([vertices, vertices[finer.edges].mean(axis=1)])
        normals = np.vstack([normals, unit_vectors(normals[finer.edges].mean(axis=1))])
        faces = finer.faces
    return replace(skin, vertices=vertices, faces=faces), normals


def _nearness_to_face(skin: SkinPiece, vertices: Floats64) -> Floats64:
    """Return 1 for vertices [mm] near brows, nose, eyes and mouth, 0 far away, (V,)."""
    near = 15.0  # [mm] from landmarks
    far = 35.0  # [mm]
    landmarks = skin.vertices[skin.landmarks[FIRST_OF_FACE:]]
    distance = scipy.spatial.cKDTree(landmarks).query(vertices)[0]
    nearness: Floats64 = ((far - distance) / (far - near)).clip(0.0, 1.0)
    return nearness
