"""Make the hairs of stubble and of full beards, which stand on the skin and move with it.

The texture shows the roots of all hairs (brows.py). Some hairs are modelled, so that the outline of
a chin is not smooth and hair is lit as hair. Those of full beards are locks, as on the head. All
numbers are chosen by eye.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64
from ...geometry.directions import unit_vectors
from ...geometry.steps import smoothstep
from ..model import Part
from .brows import front_of_neck, trimmed_area
from .features import Features
from .hair import HAIR_NAME, scalp_of
from .locks import MEAN_PLACE, VERTEX_COUNT, Growth, locks_on

# The heaviest stubble.
BEARD = Growth(
    count=2000, root=0.0, tip=1.0, least=0.4, longest=6.0, spread=0.4, half=0.05, fringe=0.0
)
FULL_BEARD = Growth(
    count=3600,
    root=0.0,
    tip=1.0,
    least=1.0,
    longest=22.0,
    spread=0.3,
    half=0.3,
    radius=40.0,
    fringe=0.0,
)
BEARD_NAME = HAIR_NAME + "_beard_locks"  # name of the part
BACKMOST = 0.0  # [mm]; beards end near the ears, which have z of about 8
FARTHEST = 100.0  # [mm]; a distance from whorls, which beards lack


def beard_of(head: Any, area: Floats32, colours: Floats64, features: Features) -> Part:
    """Make the hairs of stubble, whose length grows with its density, or of a full beard.

    head: has vertices (V, 3) [mm], faces (F, 3), uv (V, 2) and anatomy (names -> vertex indices).
    area: where beards grow in the texture, 0 to 1, (H, W). colours: sRGB of hairs with and without
    pigment, (2, 3).
    """
    length = features.beard_length
    if length:
        density = area * trimmed_area(len(area))
    else:
        density = features.stubble * area * front_of_neck(len(area))
    full = float(density.max())
    uv = head.uv.astype(np.float64)
    points, normals, faces, dense, _ = scalp_of(head.vertices, head.faces, uv, density)
    # At the nape, vertices on the texture's seam have coordinates of the front.
    dense = np.where(points[:, 2] > BACKMOST, dense, 0.0)
    # Hairs grow down, on the lip also outward, and below the chin forward.
    down = np.array([0.0, -1.0, 0.35]) + [0.4, 0.0, 0.0] * np.sign(points) * (points[:, 2:] > 60.0)
    down = unit_vectors(down - (down * normals).sum(axis=1, keepdims=True) * normals)
    # `lift` is the sine of the angle between hairs and skin. With `growing`, stubble grows in
    # proportion to the density, and locks of a full beard are wide where it is dense (locks.py).
    if length:
        growth = FULL_BEARD
        share = _length_shares(head, points)[:, None]
        long = length * share
        lift = 0.3 + 0.35 * share
        growing = np.minimum(3.0 * dense / full - 0.3, 1.2)
    else:
        growth = replace(BEARD, count=round(BEARD.count * full))
        long = np.full((len(points), 1), 0.7 + 3.0 * full**2)  # [mm]
        lift = np.full((len(points), 1), 0.45)
        growing = 0.2 * dense / full - 0.04
    way = long * (lift * normals + np.sqrt(1.0 - lift**2) * down)
    far = np.full_like(growing, FARTHEST)
    striation = np.column_stack([far, far, way, growing, np.zeros_like(growing)])
    layers = Part(
        name=BEARD_NAME.removesuffix("_locks"),
        vertices=(points + MEAN_PLACE * way).astype(np.float32),
        normals=normals.astype(np.float32),
        faces=faces,
        colours=np.broadcast_to(colours[0], points.shape).astype(np.float32),
        bone="cranium",
        shine=0.12,
        striation=striation.astype(np.float32),
    )
    return _greyed(locks_on(layers, growth), colours[1] / colours[0], features)


def _greyed(hairs: Part, bleaching: Floats64, features: Features) -> Part:
    """Return hairs that stand on the skin, some of them white.

    bleaching: factors on sRGB that make hairs white, (3,).
    """
    count = len(hairs.vertices) // VERTEX_COUNT
    chance = np.random.default_rng(2).random((count, 1))
    if features.beard_length and features.grey:  # locks of many hairs
        white = np.clip(features.grey + 0.6 * (chance - 0.5), 0.0, 1.0)
    else:
        white = np.where(chance < features.grey, 1.0, 0.0)
    bleached = np.repeat(1.0 + white * (bleaching - 1.0), VERTEX_COUNT, axis=0)
    firsts = VERTEX_COUNT * np.arange(count, dtype=np.int32)
    return replace(
        hairs,
        colours=np.clip(hairs.colours * bleached, 0.0, 1.0).astype(np.float32),
        roots=np.repeat(firsts, VERTEX_COUNT),
    )


def _length_shares(head: Any, points: Floats64) -> Floats64:
    """Return lengths of a full beard as shares of its length at the chin, (n,).

    Hairs are short on cheeks, lip and neck, and long at the chin and along the jaw. head: as in
    `beard_of`. points: on the skin [mm], (n, 3).
    """
    chin, mouth = (head.vertices[head.anatomy[name]] for name in ("menton", "stomion"))
    below = (mouth[1] - points[:, 1]) / (mouth[1] - chin[1])  # 0 at the mouth, 1 at the chin
    behind = chin[2] - points[:, 2]
    half_width = 32.0  # [mm] of the long hairs at the chin
    beside = 0.45 + 0.55 * np.exp(-((points[:, 0] / half_width) ** 2))
    face = 0.42 + 0.58 * beside * smoothstep(below, 0.25, 0.95)
    neck = smoothstep(below, 1.05, 1.35) * smoothstep(behind, 12.0, 40.0)
    return np.asarray(face * (1.0 - 0.75 * neck))


def pressed_flat(beard: Part, cover: Floats32) -> Part:
    """Return a beard whose hairs lie flat under a mask; cover: points of the mask [mm], (n, 3)."""
    near, longest = 12.0, 3.0  # [mm]; around the cover; of pressed hairs
    roots = beard.vertices[beard.roots]
    grown = beard.vertices - roots
    long = np.linalg.norm(grown, axis=1)
    distance = scipy.spatial.cKDTree(cover).query(roots)[0]
    allowed = np.minimum(0.5 * distance, longest)
    factor = np.where(distance < near, allowed / np.maximum(long, allowed), 1.0)[:, None]
    return replace(beard, vertices=(roots + factor * grown).astype(np.float32))
