"""The motion of the skin above the front edge of an upper lid as the eye shuts.

The lid's plate moves with the front edge, and the skin at the brow stays. Between them the fold
opens: the motion fades with the distance from the edge along the skin. It fades later above the
outer corner, where skin hangs loose, than above the inner corner, where a ligament holds it.

Source: own. The profile was fitted to the shape eyeBlink of ICT-FaceKit (then made a little softer
beside the nose, where a coarse mesh would show ridges).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64, Integers32
from ..geometry.polylines import polyline_at
from ..geometry.steps import smoothstep
from .lid_edges import LID_COLUMNS, LidAxes
from .polylines import reached_along
from .surface import SkinSurface


class SkinTurn(NamedTuple):
    """How far skin turns with the front edges of the lids [rad], shape (V,); down is negative."""

    of_edges: Floats64  # the turn of the edges there, of both lids beside a corner
    fading: Floats64  # the same, fading with the distance from the edges


def blended_turn(
    points: Floats64,
    edges: tuple[Integers32, Integers32],
    turn: Floats64,
    side: Floats64,
    weight: Floats64,
) -> SkinTurn:
    """Blend the turns of the edges' vertices over the skin beside them.

    So skin in front of an edge moves along, and no pit stays open before a corner of a shut eye.

    points: all vertices (V, 3) [mm]. edges: vertices of the upper and of the lower front edge.
    turn, side, weight: of each vertex (V,); see lids.py.
    """
    upper, lower = (_edge_turn(points, edge, turn, weight > 0.0) for edge in edges)
    of_edges = 0.5 * ((1.0 + side) * upper + (1.0 - side) * lower)
    return SkinTurn(of_edges, weight * of_edges)


def _edge_turn(points: Floats64, edge: Integers32, turn: Floats64, is_near: Flags) -> Floats64:
    """Blend the turns of the vertices of a lid's front edge at each vertex, shape (V,).

    Near the edge it is the turn of the nearest place on it; farther away it is a mean of a longer
    part of the edge. It is 0 for vertices that are not near.

    points: all vertices (V, 3) [mm]. turn: of each vertex [rad], (V,).
    """
    line = points[edge]
    length = reached_along(line)
    steps = np.linspace(0.0, length[-1], 2 * LID_COLUMNS)
    places = polyline_at(steps, length, line)
    turns = np.interp(steps, length, turn[edge])
    least_distance = 0.3  # mm
    squared = ((points[is_near, None] - places) ** 2).sum(axis=2) + least_distance**2
    share = squared**-2.0
    blended = np.zeros(len(points))
    blended[is_near] = share @ turns / share.sum(axis=1)
    return blended


def turn_above(
    surface: SkinSurface,
    axes: LidAxes,
    edge: Integers32,
    side: Floats64,
    edge_angles: tuple[Floats64, Floats64],
    turned: SkinTurn,
) -> Floats64:
    """Return how far skin above an upper lid's front edge turns [rad], shape (V,); down is < 0.

    It is NaN for vertices without a path along the skin to the edge.

    edge: vertices of the front edge. side: 1 on the upper lid .. -1 on the lower lid, (V,).
    edge_angles: by column, angles of the edge of the open and of the shut lid [rad], shape
        (LID_COLUMNS,) each. turned: turn of the skin with the edges.
    """
    distance = surface.distances_from(edge.astype(np.int64))
    column = axes.column(surface.positions)
    steepness = 4
    faded = 1.0 + (distance / np.interp(column, *_HALF_DISTANCE)) ** steepness
    fraction = np.interp(column, *_FAR_FRACTION) / faded
    on_lid = smoothstep(side)
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    height = axes.angle(surface.positions) - np.interp(column, where, edge_angles[1])
    most = np.interp(column, *_MOST_MOTION) * np.maximum(height, 0.0)
    edge_turn = np.maximum(edge_angles[0] - edge_angles[1], 0.0)
    far = -on_lid * np.minimum(fraction * edge_turn.max(), most)
    far += (1.0 - on_lid) * turned.fading
    plate = (0.8, 2.0)  # mm from the front edge where the plate ends
    corner_end = 4.0  # mm beside a corner, where lids of some meshes have a rim before their edge
    at_corner = smoothstep((np.abs(column - 0.5) - 0.38) / 0.1)
    ends = plate[1] + at_corner * (corner_end - plate[1])
    front = surface.positions[edge]
    rise = _rise_above(surface.positions, axes, front, edge_angles[0])
    rise = np.minimum(distance, rise)
    beyond = smoothstep((rise - plate[0]) / (ends - plate[0]))
    turn = turned.of_edges + beyond * (far - turned.of_edges)
    return np.where(np.isfinite(distance), turn, np.nan)


def _rise_above(points: Floats64, axes: LidAxes, edge: Floats64, edge_angles: Floats64) -> Floats64:
    """Height of points above the front edge of an upper lid [mm], shape (V,), at least 0.

    The rim of a thick lid is round. Its foremost row lies hardly above the edge, though the way
    there along the skin is long. Ways behind the edge, and beside the opening, count too.

    points: all vertices (V, 3) [mm]. edge: the front edge, (k, 3) [mm]. edge_angles: its angle by
        column [rad], shape (LID_COLUMNS,).
    """
    column = axes.column(points)
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    reach = axes.reach(points)
    high = reach * np.maximum(axes.angle(points) - np.interp(column, where, edge_angles), 0.0)
    behind = np.maximum(axes.reach_by_column(edge, column) - reach, 0.0)
    beside = np.maximum(np.abs(column - 0.5) - 0.5, 0.0) * np.linalg.norm(axes.axis)
    rise: Floats64 = np.linalg.norm([high, behind, beside], axis=0)
    return rise


_HALF_DISTANCE = ((-0.2, 0.2, 0.6, 1.0), (4.7, 3.7, 3.1, 2.9))
"""Column, and distance from the front edge at which the motion is half as large [mm]."""
_FAR_FRACTION = ((-0.2, 0.0, 0.2, 0.6, 0.8, 1.0, 1.2), (0.4, 0.7, 0.76, 0.78, 0.66, 0.35, 0.1))
"""Column, and motion of the skin near the plate as a fraction of the largest of the edge."""
_MOST_MOTION = ((0.0, 0.2, 0.8, 1.0), (0.4, 1.0, 1.0, 0.5))
"""Column, and most motion as a fraction of the height above the shut edge."""
