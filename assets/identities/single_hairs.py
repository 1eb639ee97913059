"""Make thin locks and single hairs that follow the strands of falling hair.

Layers (render/shaders/shells.glsl) have a smooth surface and straight edges. These locks lie on the
layers, cross the edge beside the face, and end at different lengths below the hem. All shares and
lengths are chosen by eye.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...geometry.arrays import Floats32, Floats64
from ...geometry.directions import unit_vectors
from ..model import Part
from .locks import FINEST_RADIUS, LEAST_TAPER, Ribbons, ribbon_part

LOCK_COUNT = 1200
STATION_COUNT = 5  # points along a lock
WIDEST = 0.16  # [mm]; half the width of the widest lock
EDGE_SHARE, EDGE_WIDTH = 0.16, 7.0  # share of locks beside the face; width of this edge [mm]
HEM_SHARE = 0.34  # share of locks that end at the hem


def locks_along(hair: Part, across: Floats64, along: Floats64) -> Part:
    """Make the locks on layers of n strands with m points each.

    across: rising positions of the strands across the hair [mm], (n,). along: lengths from the
    roots [mm], (n, m).
    """
    assert hair.striation is not None
    chances = _chances()
    side, inward, is_edge, is_hem, place, length, lean, bow, off, wide, tone, straight = chances.T[
        ..., None
    ]
    half_width = across[-1]
    at = half_width * (2.0 * side - 1.0)
    beside = np.sign(at) * (half_width - EDGE_WIDTH * inward)
    at = np.where(is_edge < EDGE_SHARE, beside, at)
    strand = np.interp(at, across, np.arange(len(across)))
    whole = np.interp(strand, np.arange(len(across)), along[:, -1])
    long = 24.0 + 26.0 * length  # [mm]
    start = 0.04 * whole + (0.96 * whole - long) * place
    below_hem = 12.0 * place**2 - 7.0  # [mm]
    is_hem = is_hem < HEM_SHARE
    start = np.where(is_hem, whole + below_hem - long, start)
    t = np.linspace(0.0, 1.0, STATION_COUNT)
    columns = np.hstack([hair.vertices, hair.striation[:, 2:5], hair.normals, hair.colours])
    rows = _on_strands(columns, (start + long * t) / whole, strand, along)
    places, ways, normals, colours = np.split(rows, 4, axis=2)
    normals = unit_vectors(normals.mean(axis=1))
    # Some locks of the hem are straighter than the layers, which curve inward there.
    ahead = unit_vectors(places[:, 1:2] - places[:, :1])
    ahead_only = places[:, :1] + (long * t)[..., None] * ahead
    places = places + np.where(is_hem, 0.45 * straight**2, 0.0)[..., None] * (ahead_only - places)
    drift = 9.0 * (lean - 0.5) * t**2 + 14.0 * (bow - 0.5) * t * (1.0 - t)  # [mm] to the side
    most = 2.5 + 5.5 * place  # [mm] that locks stand off; most locks lie close
    rise = most * off**4 * np.sin(0.7 * np.pi * t)
    height = 0.05 + 0.3 * inward  # of roots over the middle of the layers, as a share of them
    places += height[..., None] * ways + rise[..., None] * normals[:, None]
    places += drift[..., None] * unit_vectors(np.cross(normals[:, None], ahead))
    half = FINEST_RADIUS + (WIDEST - FINEST_RADIUS) * wide**2
    tapering = np.maximum(np.minimum(1.0 - t**4, 0.25 + 3.0 * t), LEAST_TAPER)
    ribbons = Ribbons(
        midpoints=places,
        along=unit_vectors(np.gradient(places, axis=1)),
        normals=normals,
        halves=(half * tapering)[..., None],
        colours=(0.7 + 0.6 * tone)[..., None] * colours,
        opacity=np.broadcast_to(np.clip(t / 0.25, 0.05, 1.0)[:, None], (*rows.shape[:2], 1)),
    )
    return ribbon_part(hair, ribbons, WIDEST)


def _on_strands(rows: Floats32, share: Floats64, strand: Floats64, along: Floats64) -> Floats64:
    """Interpolate values of strands, (k, s, c); beyond the tips they continue linearly.

    rows: values at n strands with m points each, (n * m, c). share: lengths from the roots as
    fractions of a strand's length, (k, s). strand: numbers of strands, also between two, (k, 1).
    along: lengths of strands from the roots [mm], (n, m).
    """
    strand_count, point_count = along.shape
    grid = rows.reshape(strand_count, point_count, -1).astype(np.float64)
    shares = along / along[:, -1:]
    apart = 2.0  # more than all shares of a strand, so that those of all strands rise in one row
    rising = (shares + apart * np.arange(strand_count)[:, None]).ravel()
    first = np.minimum(strand.astype(np.int64), strand_count - 2)
    found = np.zeros((*share.shape, grid.shape[2]))
    for number, weight in ((first, 1.0 - strand + first), (first + 1, strand - first)):
        above = np.searchsorted(rising, share + apart * number) - point_count * number
        above = np.clip(above, 1, point_count - 1)
        low, high = shares[number, above - 1], shares[number, above]
        part = ((share - low) / (high - low))[..., None]
        value = (1.0 - part) * grid[number, above - 1] + part * grid[number, above]
        found += weight[..., None] * value
    return found


@lru_cache(maxsize=1)
def _chances() -> Floats64:
    """Draw random numbers of locks, 0 to 1, (LOCK_COUNT, 12)."""
    found = np.random.default_rng(1).random((LOCK_COUNT, 12))
    found.flags.writeable = False
    return found
