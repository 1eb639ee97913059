"""The seam of shut eyelids: the line where they meet, and how the upper lies on the lower there.

Source: own. How far corners move down was measured on the shape eyeBlink of ICT-FaceKit.
"""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats64, Integers32
from ..geometry.steps import smoothstep
from .lid_edges import LID_COLUMNS, LidAxes
from .lid_motion import LidVertices, shut_state
from .surface import SkinSurface

CORNER_PART = 0.1  # of the width of the opening, beside each corner


def from_corner(column: Floats64) -> Floats64:
    """Return the way from the nearer corner of the eye by column; negative beyond a corner."""
    return 0.5 - np.abs(column - 0.5)


def pressed_turn(opening: Floats64, least_opening: float) -> Floats64:
    """Return how far closed lids overlap [rad], from the opening of the eye there."""
    wide_opening = 0.3  # rad: lids of a wider opening are pressed fully
    most_turn = 0.11  # rad (1.4 mm)
    width = (opening - least_opening) / (wide_opening - least_opening)
    return most_turn * smoothstep(width)


def raised_at_corners(seam: Floats64, upper: Floats64) -> Floats64:
    """Return the seam [rad] by column, raised beside a corner that lies above the lower lid's edge.

    Lids that meet below such a corner leave a notch beside it. upper: front edge of the upper lid.
    """
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    corner_slope = 0.5  # [rad] over the width of the opening
    raised = np.maximum(seam[0] - corner_slope * where, seam[-1] - corner_slope * (1.0 - where))
    joined: Floats64 = np.maximum(seam, np.minimum(raised, upper))
    return joined


def lowered_corners(seam: Floats64, pressed: Floats64) -> Floats64:
    """Return the seam [rad] by column, lowered at a corner that lies above the shut lid's edge.

    The edge of a shut upper lid lies below the seam by `pressed` [rad]. A corner moves down to the
    line on which the edge arrives, as far as its ligament allows.
    """
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    fitted = (0.1, 0.3)  # part of the opening beside the corner that decides on the line
    most_lowered = (0.13, 0.06)  # rad: outer and inner corner of the shape eyeBlink of ICT-FaceKit
    lowered = seam.copy()
    for away, most in zip((where, 1.0 - where), most_lowered, strict=True):
        is_fitted = (away > fitted[0]) & (away < fitted[1])
        edge = np.polyfit(away[is_fitted], (seam - pressed)[is_fitted], 1)[1]
        corner = seam[np.argmin(away)]
        down = min(max(corner - float(edge), 0.0), most)
        lowered -= down * smoothstep(1.0 - away / CORNER_PART)
    return lowered


def margin_sink(
    lids: LidVertices,
    weight: Floats64,
    surface: SkinSurface,
    axes: LidAxes,
    edges: tuple[Integers32, Integers32],
) -> Floats64:
    """Return how far the margin of a closed upper lid sinks to meet the lower lid [mm], (L,).

    The lids slide as they close, so places where they arrive are compared.

    weight: share of each lid vertex in the turn of the margin, (L,). edges: vertices of the front
        edges of both lids.
    """
    proud_height = 0.5  # mm that the closed upper lid lies in front of the lower; 0 at corners
    fade = 0.12  # of the width of the opening, beside each corner
    x = surface.positions
    shut = shut_state(lids, surface).carried
    edge = edges[0][np.argsort(axes.column(x[edges[0]]), kind="stable")]
    column = axes.column(x[edge])
    arrives = axes.column(shut[edge])
    places = np.linspace(0.0, 1.0, 4 * LID_COLUMNS)
    proud = proud_height * smoothstep(from_corner(places) / fade)
    upper, lower = (axes.reach_by_column(shut[each], places) for each in edges)
    between = upper - lower - proud
    # Edges of triangles are straight, so a vertex counts with its way to the next vertices.
    ends = np.concatenate([arrives[:1], arrives, arrives[-1:]])
    sunk = np.array(
        [
            between[(places >= min(low, here)) & (places <= max(high, here))].min(initial=np.inf)
            for low, here, high in zip(ends, arrives, ends[2:], strict=False)
        ]
    )
    sunk = np.minimum(sunk, np.interp(arrives, places, between))
    nearest = np.interp(axes.column(x[lids.vertex]), column, sunk)
    lifted = np.minimum(nearest, 0.0) * weight**2  # the fold above it stays on the ball
    margin: Floats64 = lids.upper * (lifted + np.maximum(nearest, 0.0) * weight)
    return margin
