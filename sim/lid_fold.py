"""The motion of the skin above the front edge of an upper lid as the eye shuts.

The lid's plate moves with the front edge, and the skin at the brow stays. Between them the fold
opens: the motion fades with the distance from the edge along the skin. It fades later above the
outer corner, where skin hangs loose, than above the inner corner, where a ligament holds it.

Source: own. The profile was fitted to the shape eyeBlink of ICT-FaceKit (then made a little softer
beside the nose, where a coarse mesh would show ridges).
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats64, Integers32
from .landmarks import smoothstep
from .lid_edges import LID_COLUMNS, LidAxes
from .surface import SkinSurface


def turn_above(
    surface: SkinSurface,
    axes: LidAxes,
    edge: Integers32,
    side: Floats64,
    edge_angles: tuple[Floats64, Floats64],
) -> Floats64:
    """Return how far skin above an upper lid's front edge turns down [rad], shape (V,).

    It is NaN for vertices without a path along the skin to the edge.

    edge: vertices of the front edge. side: 1 on the upper lid .. -1 on the lower lid, (V,).
    edge_angles: by column, angles of the edge of the open and of the shut lid [rad], shape
        (COLUMN_COUNT,) each.
    """
    distance = surface.distances_from(edge.astype(np.int64))
    column = axes.column(surface.positions)
    steepness = 4
    faded = 1.0 + (distance / np.interp(column, *_HALF_DISTANCE)) ** steepness
    fraction = np.interp(column, *_FAR_FRACTION) / faded
    fraction *= smoothstep(side)  # skin beside the corners is held
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    height = axes.angle(surface.positions) - np.interp(column, where, edge_angles[1])
    most = np.interp(column, *_MOST_MOTION) * np.maximum(height, 0.0)
    edge_turn = np.maximum(edge_angles[0] - edge_angles[1], 0.0)
    near = np.interp(column, where, edge_turn)
    far = np.minimum(fraction * edge_turn.max(), most)
    plate = (0.8, 2.0)  # mm from the front edge where the plate ends
    beyond = smoothstep((distance - plate[0]) / (plate[1] - plate[0]))
    return np.where(np.isfinite(distance), near + beyond * (far - near), np.nan)


_HALF_DISTANCE = ((-0.2, 0.2, 0.6, 1.0), (4.7, 3.7, 3.1, 2.9))
"""Column, and distance from the front edge at which the motion is half as large [mm]."""
_FAR_FRACTION = ((-0.2, 0.0, 0.2, 0.6, 0.8, 1.0, 1.2), (0.4, 0.7, 0.76, 0.78, 0.66, 0.35, 0.1))
"""Column, and motion of the skin near the plate as a fraction of the largest of the edge."""
_MOST_MOTION = ((0.0, 0.2, 0.8, 1.0), (0.4, 1.0, 1.0, 0.5))
"""Column, and most motion as a fraction of the height above the shut edge."""
