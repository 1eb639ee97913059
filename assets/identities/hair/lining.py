"""What is under locks: a cap over the scalp, and the inside of hair that hangs.

Between locks one sees hair, not skin; and what lies under it need not be drawn.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...around import HAIRLINE, TOP, line_height, rays
from ...smooth import Points, Values, smooth_step, unit
from ...solids import grid_faces
from .combing import PARTED_TO, UNPARTED, curl, near_parting, way_of
from .cuts import Cut
from .envelope import Envelope

HANGING = 55.0  # [mm] height of the upper edge of what hangs
ROWS, COLUMNS = 10, 48  # of either grid
ENDED, RAGGED = 6.0, 1.5  # [mm] over the hem, where it ends, and how far up and down from there
OPENED = 2.0  # [deg] behind the edges of the locks beside the face
IN_FRONT = 4.0  # [mm] behind the hairline, where the cap begins
# Of the locks' volume, that lies within them; short ones do not come up to it.
CAP, CURTAIN, SHORT = 0.65, 0.85, 0.3
LEAST = -0.2  # [mm] over the envelope, where no hair lies over the cap
SUNK = 3.0  # [mm] below that at the parting, where the skin is seen
WIDE = 85.0  # [mm] the radius by which its strands are as wide everywhere
SHADES = 0.97, 0.6  # of its colour, outside and inside


def lining_of(cut: Cut, envelope: Envelope, colour: Points, receded: float) -> dict[str, Any]:
    """The arrays of a `Part`, as of `locks_along`."""
    pieces = [_cap(cut, envelope, receded)]
    if cut.hangs:
        pieces.append(_curtain(cut, envelope))
        points, out, strands, faces = pieces[1]
        pieces.append((points, -out, strands, faces[:, ::-1]))
    counts = [len(points) for points, *_ in pieces]
    starts = np.cumsum([0, *counts[:-1]])
    shades = np.repeat(np.array([SHADES[0], *SHADES])[: len(pieces)], counts)
    return {
        "vertices": np.vstack([points for points, *_ in pieces]).astype(np.float32),
        "normals": np.vstack([out for _, out, *_ in pieces]).astype(np.float32),
        "faces": np.vstack(
            [piece[3] + start for piece, start in zip(pieces, starts, strict=True)]
        ).astype(np.int32),
        "colours": (shades[:, None] * colour).astype(np.float32),
        "striation": np.vstack([strands for *_, strands, _ in pieces]).astype(np.float32),
    }


Piece = tuple[Points, Points, Points, Any]  # points, normals, strands, faces


def _cap(cut: Cut, envelope: Envelope, receded: float) -> Piece:
    """From the crown to the hairline, or to what hangs."""
    angle, share = _grid(-180.0, 180.0)
    hairline = line_height(HAIRLINE, np.degrees(np.abs(angle))) + receded
    low = np.maximum(hairline + IN_FRONT, HANGING - 5.0 if cut.hangs else cut.end(angle) + ENDED)
    height = TOP - 0.5 + (low - TOP + 0.5) * share
    origin, out = rays(angle, height)
    on_head = envelope.radius(angle, height)
    on_scalp = origin + on_head[:, None] * out
    covered = smooth_step(0.0, 40.0, height - hairline) * (1.0 - near_parting(cut, on_scalp, 42.0))
    volume = (CAP if cut.hangs else SHORT) * cut.volume
    off = LEAST + (volume - LEAST) * covered
    off -= SUNK * near_parting(cut, on_scalp, 15.0) * smooth_step(PARTED_TO, 0.0, on_scalp[:, 2])
    points = origin + (on_head + off)[:, None] * out
    # Where the side changed from one vertex to the next, a coarse grid would show as a zigzag.
    side = np.clip((points[:, 0] - cut.parting) / UNPARTED, -1.0, 1.0)
    along = way_of(cut, points, side, np.zeros(len(points)), 0.0)
    across = (points * np.cross(along, out)).sum(axis=1)
    # All that comes to the same place around it.
    strands = np.column_stack([across, np.linalg.norm(points, axis=1), along])
    return points, out, strands, grid_faces(ROWS, COLUMNS)[:, ::-1]


def _curtain(cut: Cut, envelope: Envelope) -> Piece:
    """Behind the locks that hang, open toward the face."""
    first = cut.opening[0] + OPENED
    around, share = _grid(first, 360.0 - first)
    angle = np.where(around > np.pi, around - 2.0 * np.pi, around)
    hem = cut.end(angle) + ENDED + RAGGED * np.sin(37.0 * around)
    height = HANGING + (hem - HANGING) * share
    origin, out = rays(angle, height)
    volume = (CAP + (CURTAIN - CAP) * smooth_step(0.0, 0.5, share)) * cut.volume
    radius = envelope.radius(angle, height) + volume - curl(height - hem, height)
    points = origin + radius[:, None] * out
    down = np.asarray(np.gradient(points.reshape(ROWS, COLUMNS, 3), axis=0)).reshape(-1, 3)
    strands = np.column_stack([WIDE * around, -height, unit(down)])
    return points, out, strands, grid_faces(ROWS, COLUMNS)[:, ::-1]


def _grid(first: float, last: float) -> tuple[Values, Values]:
    """Angles [rad] from one to another, and shares of the way down, of a grid's vertices."""
    angles = np.radians(np.linspace(first, last, COLUMNS))
    return np.tile(angles, ROWS), np.repeat(np.linspace(0.0, 1.0, ROWS), COLUMNS)
