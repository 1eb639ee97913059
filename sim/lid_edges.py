"""Find the front edges of the eyelids, and measure each lid by the distance from its edge.

Source: own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64, Integers32
from ..geometry.steps import smoothstep
from .polylines import polyline_distance
from .rig import Eyes
from .surface import SkinSurface

LID_COLUMNS = 41  # places along the opening where its height is known


class LidAxes(NamedTuple):
    """Coordinates of points relative to the line from the outer to the inner corner of an eye."""

    centre: Floats64  # of the eyeball
    up: Floats64
    forward: Floats64
    corner: Floats64  # the outer one
    axis: Floats64  # from there to the inner one [mm]

    def angle(self, points: Floats64) -> Floats64:
        """Angle [rad] about the axis of the lids, 0 straight forward."""
        away = points - self.centre
        return np.arctan2(away @ self.up, away @ self.forward)

    def reach(self, points: Floats64) -> Floats64:
        """Distance of points (n, 3) from the axis through the eyeball's centre [mm], (n,)."""
        away = points - self.centre
        return np.hypot(away @ self.up, away @ self.forward)

    def reach_by_column(self, line: Floats64, places: Floats64) -> Floats64:
        """Distance of a line (k, 3) from the axis through the eyeball's centre [mm], by column.

        places: columns, shape (n,).
        """
        line = line[np.argsort(self.column(line), kind="stable")]
        by_column: Floats64 = np.interp(places, self.column(line), self.reach(line))
        return by_column

    def column(self, points: Floats64) -> Floats64:
        """Fraction of the way from the outer corner of the eye (0) to the inner corner (1)."""
        column: Floats64 = ((points - self.corner) @ self.axis) / (self.axis @ self.axis)
        return column


def front_edges(
    surface: SkinSurface, axes: LidAxes, outline: Floats64
) -> tuple[Integers32, Integers32]:
    """Find the vertices of the front edges of the upper and the lower lid, from corner to corner.

    outline: an eye's landmarks from the outer corner, (6, 3).
    """
    upper = _front_edge(surface, outline[[0, 1, 2, 3]], axes)
    lower = _front_edge(surface, outline[[0, 5, 4, 3]], axes)
    return upper, lower


def _front_edge(surface: SkinSurface, line: Floats64, axes: LidAxes) -> Integers32:
    """Vertices of the path along the mesh near a lid's line of landmarks (4, 3)."""
    x = surface.positions
    reaches = np.linalg.norm(line - axes.centre, axis=1)
    order = np.argsort(axes.column(line))
    expected = np.interp(axes.column(x), axes.column(line)[order], reaches[order])
    edge_cost = 0.3  # cost per mm off the landmarks' distance from the eyeball, where no edge is
    behind = edge_cost * np.abs(np.linalg.norm(x - axes.centre, axis=1) - expected)
    edge: Integers32 = surface.path_through(surface.nearest(line), behind)
    return edge


def side_with_edges(side: Floats64, upper: Integers32, lower: Integers32) -> Floats64:
    """Correct the side of each vertex, (V,): 1 on the upper lid's front edge, -1 on the lower's.

    Beside a corner of the eye, a coarse mesh may have a vertex of the upper edge that lies nearer
    to the lower landmarks.
    """
    found = side.copy()
    found[np.setdiff1d(upper, lower)] = 1.0
    found[np.setdiff1d(lower, upper)] = -1.0
    return found


class OneLid(NamedTuple):
    """Values of one lid by vertex, shape (V,), or by column of the opening, (LID_COLUMNS,)."""

    weight: Floats64  # (V,) share of the margin's turn
    fold: Floats64  # (V,) share of the turn of the open lid
    slide: Floats64  # (V,) share of the slide
    near: Flags  # (V,) near the margin
    front: Floats64  # (LID_COLUMNS,) rad, angle to the front edge
    sag: Floats64  # (LID_COLUMNS,) rad from the edge, of straight pieces, to the arc it stands for


def one_lid(
    eyes: Eyes,
    surface: SkinSurface,
    axes: LidAxes,
    edge_vertices: Integers32,
    on_lid: Flags,
    fold_ends: tuple[float, float],
) -> OneLid:
    """Measure one lid along its front edge; fold_ends: as in `_fading_weight` [mm]."""
    edge = surface.positions[edge_vertices]
    distance = polyline_distance(surface.positions, edge)
    column = axes.column(surface.positions)
    edge = edge[np.argsort(axes.column(edge), kind="stable")]
    columns = axes.column(edge)
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    margin_reach = 3.5  # mm from a lid's front edge that belong to its margin
    slide_reach = 1.9  # factor of the turn's reach: skin around the lid slides with it
    return OneLid(
        weight=on_lid * _fading_weight(distance, eyes.lid_plateau, eyes.lid_reach),
        fold=on_lid * _fading_weight(distance, *fold_ends),
        slide=on_lid * _fading_weight(distance, 0.0, slide_reach * eyes.lid_reach),
        near=on_lid & (distance < margin_reach) & (column > -0.02) & (column < 1.02),
        front=np.interp(where, columns, axes.angle(edge)),
        sag=_sag_by_column(edge, columns, where) / axes.reach_by_column(edge, where),
    )


def _sag_by_column(edge: Floats64, columns: Floats64, where: Floats64) -> Floats64:
    """Return the sag of the straight pieces of a front edge below an arc around the eye [mm].

    edge: vertices (k, 3) by column. columns: their columns (k,). where: columns of the result.
    """
    curvature_radius = 14.0  # mm: an eyeball with the skin before it
    length = np.linalg.norm(np.diff(edge, axis=0), axis=1)
    piece = np.clip(np.searchsorted(columns, where) - 1, 0, len(length) - 1)
    width = np.maximum(np.diff(columns)[piece], 1e-6)
    place = np.clip((where - columns[piece]) / width, 0.0, 1.0)
    sag: Floats64 = length[piece] ** 2 / (2.0 * curvature_radius) * place * (1.0 - place)
    return sag


def margin_of(lid: OneLid, sign: float, column: Floats64, angle: Floats64) -> Flags:
    """Return the margin of a lid itself, up to the arc of its front edge, shape (V,).

    The front edge of a lid of few vertices runs below that arc; skin between them is margin, too.

    sign: 1 for the upper lid, -1 for the lower one. column, angle: of each vertex (V,).
    """
    edge_turn = 1e-3  # rad
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    above = sign * (angle - np.interp(column, where, lid.front))
    within: Flags = lid.near & (above < np.interp(column, where, lid.sag) + edge_turn)
    return within


def _fading_weight(distance: Floats64, plateau: float, reach: float) -> Floats64:
    """Return 1 up to `plateau` mm from the margin, fading to 0 at `reach`."""
    return smoothstep(1.0 - (distance - plateau) / max(reach - plateau, 0.1))
