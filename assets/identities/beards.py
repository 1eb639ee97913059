"""Make the hairs of stubble and short beards, which stand on the skin and move with it.

The texture shows the roots of all hairs (brows.py). Some hairs are modelled, so that the outline of
a chin is not smooth and hair is lit as hair. All numbers are chosen by eye.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.arrays import Floats32, Floats64, Integers32
from ...geometry.directions import unit_vectors
from ..model import Part
from .hair import HAIR_NAME, scalp_of
from .locks import MEAN_PLACE, VERTEX_COUNT, Growth, locks_on

# The heaviest stubble.
BEARD = Growth(
    count=2000, root=0.0, tip=1.0, least=0.4, longest=6.0, spread=0.4, half=0.05, fringe=0.0
)
BEARD_NAME = HAIR_NAME + "_beard_locks"  # name of the part
BACKMOST = 0.0  # [mm]; beards end near the ears, which have z of about 8
FARTHEST = 100.0  # [mm]; a distance from whorls, which beards lack


def beard_of(
    skin: tuple[Floats64, Integers32, Floats64],
    density: Floats32,
    colours: Floats64,
    grey: float,
) -> Part:
    """Make the hairs of a beard.

    skin: vertices [mm], (V, 3), triangles, (F, 3), and texture coordinates, (V, 2). density: of
    hairs in the texture, 0 to 1, (H, W). colours: sRGB of hairs with and without pigment, (2, 3).
    grey: share of hairs without pigment.
    """
    full = float(density.max())
    vertices, faces, uv = skin
    points, normals, faces, dense, _ = scalp_of(vertices, faces, uv, density)
    # At the nape, vertices on the texture's seam have coordinates of the front.
    dense = np.where(points[:, 2] > BACKMOST, dense, 0.0)
    # Hairs grow down, on the lip also outward, and below the chin forward.
    down = np.array([0.0, -1.0, 0.35]) + [0.4, 0.0, 0.0] * np.sign(points) * (points[:, 2:] > 60.0)
    down = unit_vectors(down - (down * normals).sum(axis=1, keepdims=True) * normals)
    lift = 0.45  # sine of the angle between hairs and skin
    long = 0.7 + 3.0 * full**2  # [mm]
    way = long * (lift * normals + np.sqrt(1.0 - lift**2) * down)
    # These values let locks grow in proportion to the density (locks.py).
    growing = 0.2 * dense / full - 0.04
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
    hairs = locks_on(layers, replace(BEARD, count=round(BEARD.count * full)))
    count = len(hairs.vertices) // VERTEX_COUNT
    is_grey = np.random.default_rng(2).random(count) < grey
    bleached = np.where(is_grey[:, None], colours[1] / colours[0], 1.0)
    firsts = VERTEX_COUNT * np.arange(count, dtype=np.int32)
    return replace(
        hairs,
        colours=np.clip(hairs.colours * np.repeat(bleached, VERTEX_COUNT, axis=0), 0.0, 1.0).astype(
            np.float32
        ),
        roots=np.repeat(firsts, VERTEX_COUNT),
    )
